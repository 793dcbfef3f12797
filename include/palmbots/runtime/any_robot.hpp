// SPDX-License-Identifier: Apache-2.0
// A robot whose controller is chosen when its program starts.
#pragma once

#include <cstdint>
#include <span>

#include "palmbots/runtime/robot_runtime.hpp"

namespace palmbots::runtime {

// A robot with any controller: a board and a process choose the controller when they start.
class Robot {
 public:
  // Writes the hello with which a carry in lockstep begins, if the controller needs a session.
  virtual bool greet(wire::Bytes& bytes) = 0;
  virtual void begin(std::uint16_t elapsed) = 0;
  virtual wire::Decoded receive(std::span<const std::uint8_t> bytes) = 0;
  virtual void operate(wire::Operation wish) = 0;
  virtual void step(const Reading& reading, Outputs& out) = 0;
  virtual const wire::Endpoint& endpoint() const = 0;
  virtual const ReceivedCounts& received() const = 0;
  virtual const ReceivedCounts& received_phases() const = 0;
  // Of a job on the floor: the state of the table, and its name; empty: there is no such job.
  virtual int phase() const = 0;
  virtual const char* phase_name() const = 0;
  // What it moves counts as a part of the distance.
  virtual bool counts() const = 0;
  // How many halves of the distance it has to travel until it is far enough.
  virtual unsigned halves_of_way() const = 0;
  virtual char name() const = 0;
  virtual bool waits() const = 0;
  virtual MessageKind awaits() const = 0;
  virtual bool greets() const = 0;
  virtual bool greets_station() const = 0;

 protected:
  ~Robot() = default;
};

template <class Program, class Phases = PhaseProgram<Lifting>>
class RobotWith final : public Robot {
 public:
  template <class... Arguments>
  explicit RobotWith(const Arguments&... arguments) : runtime_(arguments...) {}

  bool greet(wire::Bytes& bytes) override { return runtime_.greet(bytes); }
  void begin(std::uint16_t elapsed) override { runtime_.begin(elapsed); }
  wire::Decoded receive(std::span<const std::uint8_t> bytes) override {
    return runtime_.receive(bytes);
  }
  void operate(wire::Operation wish) override { runtime_.operate(wish); }
  void step(const Reading& reading, Outputs& out) override { out = runtime_.step(reading); }
  const wire::Endpoint& endpoint() const override { return runtime_.endpoint(); }
  const ReceivedCounts& received() const override { return runtime_.received(); }
  const ReceivedCounts& received_phases() const override { return runtime_.received_phases(); }
  int phase() const override { return static_cast<int>(runtime_.phases().state()); }
  const char* phase_name() const override {
    return runtime_.phases().lifts() ? name_of(runtime_.phases().state()) : "";
  }
  bool counts() const override {
    return !runtime_.phases().lifts() || runtime_.phases().is_carrying();
  }
  unsigned halves_of_way() const override {
    return runtime_.phases().lifts() ? runtime_.phases().halves_of_way() : 2;
  }
  char name() const override { return runtime_.name(); }
  bool waits() const override { return runtime_.waits(); }
  MessageKind awaits() const override { return runtime_.program().awaits(); }
  bool greets() const override { return Program::greets; }
  bool greets_station() const override { return Program::with_station; }

 private:
  RobotRuntime<Program, Phases> runtime_;
};

}  // namespace palmbots::runtime

// SPDX-License-Identifier: Apache-2.0
// The station of the centralized algorithm as a program: reports in, commands out, without I/O.
//
// In every tick it takes in the robots' reports and commands both robots, once it has heard both.
// Before that it answers with a hello.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "palmbots/control/centralized.hpp"
#include "palmbots/runtime/robot_runtime.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots::runtime {

class StationRuntime {
 public:
  // `identity` has the role of the station; `epoch` is the number of its boots.
  StationRuntime(const wire::Identity& identity, std::uint32_t epoch)
      : endpoint_(identity, epoch) {}

  // Writes a hello to a robot, to establish a session before a carry in lockstep.
  bool greet(wire::Role robot, wire::Bytes& bytes) {
    return endpoint_.send(robot, wire::PacketKind::hello, wire::payload_of(wire::Hello{}), bytes);
  }

  void begin() { unanswered_ = {}; }

  // A packet has arrived.
  wire::Verdict receive(std::span<const std::uint8_t> bytes) {
    const wire::Decoded got = endpoint_.receive(bytes);
    const auto from = static_cast<std::size_t>(got.packet.sender);
    if (got.verdict == wire::Verdict::no_session) unanswered_[from] = true;
    if (got.verdict == wire::Verdict::accepted && got.packet.kind == wire::PacketKind::report) {
      reports_[from] = wire::report_of(got.packet.payload);
      heard_[from] = true;
    }
    return got.verdict;
  }

  // One tick: the packets to send.
  struct Outputs {
    std::array<Outgoing, 2> packets{};
    std::size_t packet_count = 0;
  };

  Outputs step() {
    Outputs out;
    const bool decides = heard_[0] && heard_[1];
    Centralized::Output decision{};
    if (decides) decision = program_.step(reports_);
    for (const std::size_t robot : {std::size_t{0}, std::size_t{1}}) {
      if (!decides && !unanswered_[robot]) continue;
      Outgoing& packet = out.packets[out.packet_count];
      packet.receiver = static_cast<wire::Role>(robot);
      const wire::PacketKind kind = decides ? wire::PacketKind::command : wire::PacketKind::hello;
      const wire::Payload payload =
          decides ? wire::payload_of(decision.command[robot]) : wire::payload_of(wire::Hello{});
      if (endpoint_.send(packet.receiver, kind, payload, packet.bytes)) ++out.packet_count;
    }
    return out;
  }

  // The number of the case in Table 1; 0: none.
  int current() const { return program_.current(); }
  const wire::Endpoint& endpoint() const { return endpoint_; }

 private:
  wire::Endpoint endpoint_;
  Centralized program_;
  Centralized::Report reports_[2]{};  // the newest of each robot
  bool heard_[2]{};
  std::array<bool, wire::role_count> unanswered_{};
};

}  // namespace palmbots::runtime

// SPDX-License-Identifier: Apache-2.0
// Everything that a robot decides, as one object without I/O: packets in, packets and a drive out.
//
// The caller moves bytes. Once per control tick it passes what the sensors read and the packets that
// have arrived, and carries out what comes back. The node of a robot, a simulated robot, a browser
// and a microcontroller call the same step.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "palmbots/runtime/robot_program.hpp"
#include "palmbots/wire/endpoint.hpp"

namespace palmbots::runtime {

// A packet to send.
struct Outgoing {
  wire::Role receiver;
  wire::Bytes bytes;
};

// What one tick brings out.
struct Outputs {
  Decision decision;
  std::array<Outgoing, wire::role_count> packets{};
  std::size_t packet_count = 0;
};

// Counts of packets from the partner, for the report of a run.
struct ReceivedCounts {
  std::uint32_t rejected = 0;  // copies, overtaken packets, packets without a session
  std::uint32_t late = 0;      // older than the lease
};

// One robot.
template <class Program>
class RobotRuntime {
 public:
  RobotRuntime(const wire::Identity& identity, std::uint32_t epoch, Program program)
      : endpoint_(identity, epoch), program_(std::move(program)) {}

  // Writes a hello to the partner, to establish a session before the carry. Returns false if the
  // program sends its partner nothing but what its controller says.
  bool greet(wire::Bytes& bytes) {
    if constexpr (Program::answers_with_hello) {
      return endpoint_.send(partner(), wire::PacketKind::hello, wire::payload_of(wire::Hello{}),
                            bytes);
    }
    return false;
  }

  // Begins a tick: `elapsed` ticks of this robot's clock have passed since the last one.
  void begin(std::uint16_t elapsed) {
    program_.pass(elapsed);
    unanswered_ = {};
  }

  // A packet has arrived.
  wire::Verdict receive(std::span<const std::uint8_t> bytes) {
    const wire::Decoded got = endpoint_.receive(bytes);
    if (got.verdict == wire::Verdict::no_session) {
      unanswered_[static_cast<std::size_t>(got.packet.sender)] = true;
    }
    const Taken taken = program_.hear(got);
    received_.rejected += taken == Taken::rejected ? 1U : 0U;
    received_.late += taken == Taken::late ? 1U : 0U;
    return got.verdict;
  }

  // Decides, and writes the packets of this tick.
  Outputs step(const Observation& seen) {
    Outputs out{program_.step(seen)};
    const Decision& decision = out.decision;
    if (decision.speaks) {
      const bool to_station = decision.kind == wire::PacketKind::report;
      const wire::Role receiver = to_station ? wire::Role::station : partner();
      wire::State state = decision.state;
      state.mode = wire::RobotMode::carrying;
      if (const std::uint32_t sequence = program_.sequence(); sequence > 0) {
        endpoint_.skip_to(receiver, sequence);
      }
      send(out, receiver, decision.kind,
           to_station ? wire::payload_of(decision.report) : wire::payload_of(state));
    }
    if constexpr (Program::answers_with_hello) {
      if (unanswered_[static_cast<std::size_t>(partner())] && out.packet_count == 0) {
        send(out, partner(), wire::PacketKind::hello, wire::payload_of(wire::Hello{}));
      }
    }
    return out;
  }

  const wire::Endpoint& endpoint() const { return endpoint_; }
  const Program& program() const { return program_; }
  const ReceivedCounts& received() const { return received_; }

 private:
  wire::Role partner() const {
    return endpoint_.identity().role == wire::Role::left ? wire::Role::right : wire::Role::left;
  }

  void send(Outputs& out, wire::Role receiver, wire::PacketKind kind,
            const wire::Payload& payload) {
    Outgoing& packet = out.packets[out.packet_count];
    if (!endpoint_.send(receiver, kind, payload, packet.bytes)) return;
    packet.receiver = receiver;
    ++out.packet_count;
  }

  wire::Endpoint endpoint_;
  Program program_;
  ReceivedCounts received_;
  std::array<bool, wire::role_count> unanswered_{};  // senders of packets without a session
};

}  // namespace palmbots::runtime

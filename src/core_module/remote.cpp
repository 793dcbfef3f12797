// SPDX-License-Identifier: Apache-2.0
// The team of a carry whose programs run elsewhere, and the station's program.
#include "remote.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <optional>

#include "palmbots/runtime/station_runtime.hpp"

namespace palmbots::bindings {

namespace {

// The program of the station that decides for both robots.
class StationHandle {
 public:
  StationHandle(const wire::Identity& identity, std::uint32_t epoch) : station_(identity, epoch) {}

  // Packets, case, and packets rejected of each robot in this tick.
  using Answer = std::tuple<std::vector<PacketTuple>, int, std::uint32_t, std::uint32_t>;

  Answer step(const std::vector<nb::bytes>& packets) {
    station_.begin();
    PerSide<std::uint32_t> rejected{};
    for (const nb::bytes& bytes : packets) {
      const wire::Bytes packet = packet_of(bytes);
      const wire::Verdict verdict = station_.receive(packet);
      const bool is_rejected =
          verdict == wire::Verdict::stale || verdict == wire::Verdict::no_session;
      // The sender of a packet with a right tag.
      const auto sender = static_cast<std::size_t>(packet[wire::roles_field.offset] & 15);
      if (is_rejected && sender < 2) ++rejected[sender];
    }
    const auto out = station_.step();
    std::vector<PacketTuple> sent;
    for (std::size_t i = 0; i < out.packet_count; ++i) {
      const runtime::Outgoing& p = out.packets[i];
      sent.emplace_back(static_cast<int>(p.receiver), nb::bytes(p.bytes.data(), p.bytes.size()), 0);
    }
    const int number = station_.current();
    return {sent, number == 0 ? ' ' : '0' + number, rejected[left], rejected[right]};
  }

  nb::bytes greet(std::uint8_t robot) {
    wire::Bytes bytes{};
    station_.greet(static_cast<wire::Role>(robot), bytes);
    return nb::bytes(bytes.data(), bytes.size());
  }

  void hear(const nb::bytes& bytes) { station_.receive(packet_of(bytes)); }

 private:
  runtime::StationRuntime station_;
};

// Calls Python for the programs of a carry.
nb::object input_of(const std::optional<ProgramInput>& input) {
  if (!input) return nb::none();
  nb::list packets;
  for (const wire::Bytes& bytes : input->packets) {
    packets.append(nb::bytes(bytes.data(), bytes.size()));
  }
  const LiftSenses& senses = input->senses;
  return nb::make_tuple(input->elapsed, static_cast<int>(input->sensed.sign),
                        input->sensed.palm_at_target, input->boots, packets,
                        nb::make_tuple(senses.touches, senses.arm_there, senses.far_enough,
                                       senses.steps, senses.beneath));
}

}  // namespace

ProgramOutputs PythonExchange::operator()(std::uint32_t tick, const ProgramInputs& inputs) const {
  ProgramOutputs outputs{};
  const nb::object answers =
      exchange(tick, input_of(inputs[0]), input_of(inputs[1]), input_of(inputs[2]));
  if (inputs[2]) {
    const auto [packets, name, from_left, from_right] = nb::cast<StationHandle::Answer>(answers[2]);
    for (const auto& [receiver, bytes, message] : packets) {
      outputs[2].packets.push_back({static_cast<wire::Role>(receiver), packet_of(bytes)});
    }
    outputs[2].name = static_cast<char>(name);
    outputs[2].rejected_from = {from_left, from_right};
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (!inputs[i]) continue;
    const auto [palm, move, stop, packets, name, waits, awaits, rejected, late, phases, assists] =
        nb::cast<Answer>(answers[i]);
    ProgramOutput& out = outputs[i];
    out.command = {static_cast<Palm>(palm), static_cast<Move>(move), stop};
    for (const auto& [receiver, bytes, message] : packets) {
      out.packets.push_back(
          {static_cast<wire::Role>(receiver), packet_of(bytes), static_cast<MessageKind>(message)});
    }
    out.name = static_cast<char>(name);
    out.waits = waits;
    out.awaits = static_cast<MessageKind>(awaits);
    out.rejected = rejected;
    out.late = late;
    const auto [phase, rejected_phases, late_phases] = phases;
    out.phase = phase;
    out.rejected_phases = rejected_phases;
    out.late_phases = late_phases;
  }
  return outputs;
}

void bind_remote(nb::module_& m) {
  nb::class_<StationHandle>(m, "Station", "The station that decides for both robots.")
      .def(
          "__init__",
          [](StationHandle* self, const nb::bytes& key, std::uint16_t pair, std::uint32_t epoch) {
            new (self) StationHandle({key_of(key), pair, wire::Role::station}, epoch);
          },
          nb::arg("key"), nb::arg("pair"), nb::arg("epoch"))
      .def(
          "step", &StationHandle::step, nb::arg("packets"),
          "One tick; returns packets (receiver, bytes, message), case, and packets rejected of the "
          "left and of the right robot.")
      .def("greet", &StationHandle::greet, nb::arg("robot"), "A hello to a robot.")
      .def("hear", &StationHandle::hear, nb::arg("bytes"), "Takes in a packet before the carry.");
  nb::class_<RemoteControllers>(m, "RemoteControllers",
                                "Controllers of a carry that run elsewhere (sim/remote_team.hpp).")
      .def(
          "__init__",
          [](RemoteControllers* self, nb::object exchange, bool has_clocks, bool has_station) {
            new (self) RemoteControllers{{std::move(exchange)}, has_clocks, has_station};
          },
          nb::arg("exchange"), nb::arg("has_clocks"), nb::arg("has_station"),
          "exchange(tick, left, right, station) gets inputs (elapsed, sign, palm at target, boots, "
          "packets, (touches, arm there, far enough, arm steps, beneath)) or None, and returns "
          "three "
          "answers "
          "of Robot.step or None.");
}

}  // namespace palmbots::bindings

// SPDX-License-Identifier: Apache-2.0
// Robots as programs of their own: what each decides, tick by tick, and the team of a carry whose
// programs run elsewhere.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <variant>

#include "carry.hpp"
#include "machines.hpp"
#include "palmbots/control/shared_sign.hpp"
#include "palmbots/control/silent.hpp"
#include "palmbots/runtime/robot_runtime.hpp"
#include "palmbots/sim/table_team.hpp"
#include "remote.hpp"

namespace palmbots::bindings {

namespace {

using runtime::BeaconProgram;
using runtime::MessageProgram;
using runtime::RobotRuntime;

template <class Table>
using TableProgram = BeaconProgram<TableRobot<Table>>;

using AnyRuntime =
    std::variant<RobotRuntime<BeaconProgram<Resilient>>, RobotRuntime<TableProgram<Silent>>,
                 RobotRuntime<TableProgram<SharedSign>>, RobotRuntime<MessageProgram<Distributed>>,
                 RobotRuntime<MessageProgram<MachineRobot>>,
                 RobotRuntime<MessageProgram<PythonController>>>;

// What a robot knows when its program starts.
struct Start {
  wire::Identity identity;
  std::uint32_t epoch;
  std::size_t side;
  bool is_first;  // this program runs from the start of the carry
  bool assists;   // stored: the palm was up for the partner
};

template <class Table>
AnyRuntime table_runtime(const Spec& spec, const Start& start, wire::Language language) {
  using Robot = TableRobot<Table>;
  const auto times = table_times_of<Table>(spec);
  const typename Robot::Role role{leader_of(spec) == start.side, spec.brake != 0,
                                  start.is_first && spec.start_by_touch != 0};
  return RobotRuntime(start.identity, start.epoch,
                      BeaconProgram(Robot(times, role), language, times.lease, start.epoch));
}

template <class Controller>
AnyRuntime message_runtime(const Start& start, Controller controller) {
  return RobotRuntime(start.identity, start.epoch, MessageProgram(std::move(controller)));
}

AnyRuntime runtime_of(const Spec& spec, const nb::object& controller, const Start& start) {
  if (nb::isinstance<Machines>(controller)) {
    return message_runtime(start,
                           MachineRobot(&nb::cast<const Machines&>(controller).tables[start.side]));
  }
  if (!nb::isinstance<nb::str>(controller)) {
    return message_runtime(start, python_controllers(controller, spec)[start.side]);
  }
  const auto name = nb::cast<std::string>(controller);
  if (name == "resilient") {
    const Resilient::Times times = resilient_timing_of(spec).times;
    const bool yields = leader_of(spec) != start.side;
    const Resilient robot(times, yields, start.assists);
    return RobotRuntime(start.identity, start.epoch,
                        BeaconProgram(robot, wire::Language::beacons, times.lease, start.epoch));
  }
  if (name == "silent") return table_runtime<Silent>(spec, start, wire::Language::none);
  if (name == "shared-sign") return table_runtime<SharedSign>(spec, start, wire::Language::signs);
  if (name == "distributed") return message_runtime(start, Distributed());
  throw std::invalid_argument("controller: does not run on robots");
}

wire::Bytes packet_of(const nb::bytes& bytes) {
  wire::Bytes packet{};
  if (bytes.size() != packet.size()) throw std::out_of_range("a packet has 32 bytes");
  std::copy_n(static_cast<const std::uint8_t*>(bytes.data()), packet.size(), packet.begin());
  return packet;
}

using PacketTuple = std::tuple<int, nb::bytes, int>;  // receiver, bytes, word
// Palm, move, stop, packets, case, waits, awaits, rejected, late, assists.
using Answer = std::tuple<int, int, bool, std::vector<PacketTuple>, int, bool, int, std::uint32_t,
                          std::uint32_t, bool>;

// The program of one robot.
class RobotHandle {
 public:
  RobotHandle(const Spec& spec, nb::object controller, const Start& start)
      : controller_(std::move(controller)), runtime_(runtime_of(spec, controller_, start)) {}

  Answer step(std::uint16_t elapsed, int sign, bool palm_at_target,
              const std::vector<nb::bytes>& packets) {
    return std::visit(
        [&](auto& robot) -> Answer {
          const runtime::ReceivedCounts before = robot.received();
          robot.begin(elapsed);
          for (const nb::bytes& bytes : packets) {
            robot.receive({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
          }
          const runtime::Outputs out = robot.step({static_cast<Sign>(sign), palm_at_target});
          std::vector<PacketTuple> sent;
          for (std::size_t i = 0; i < out.packet_count; ++i) {
            const runtime::Outgoing& p = out.packets[i];
            sent.emplace_back(static_cast<int>(p.receiver),
                              nb::bytes(p.bytes.data(), p.bytes.size()),
                              static_cast<int>(i == 0 ? out.decision.word : MessageKind::none));
          }
          const auto& program = robot.program();
          const Command& command = out.decision.command;
          return {static_cast<int>(command.palm),
                  static_cast<int>(command.move),
                  command.stop,
                  sent,
                  program.name(),
                  program.waits(),
                  static_cast<int>(program.awaits()),
                  robot.received().rejected - before.rejected,
                  robot.received().late - before.late,
                  out.decision.assists};
        },
        runtime_);
  }

  std::optional<nb::bytes> greet() {
    wire::Bytes bytes{};
    const bool written = std::visit([&](auto& robot) { return robot.greet(bytes); }, runtime_);
    if (!written) return std::nullopt;
    return nb::bytes(bytes.data(), bytes.size());
  }

  void hear(const nb::bytes& bytes) {
    std::visit(
        [&](auto& robot) {
          robot.receive({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
        },
        runtime_);
  }

  std::uint32_t count(std::size_t verdict) const {
    return std::visit(
        [&](const auto& robot) {
          return robot.endpoint().count(static_cast<wire::Verdict>(verdict));
        },
        runtime_);
  }

 private:
  nb::object controller_;  // outlives the runtime, which may point into it
  AnyRuntime runtime_;
};

// Calls Python for the programs of a carry.
nb::object input_of(const std::optional<ProgramInput>& input) {
  if (!input) return nb::none();
  nb::list packets;
  for (const wire::Bytes& bytes : input->packets) {
    packets.append(nb::bytes(bytes.data(), bytes.size()));
  }
  return nb::make_tuple(input->elapsed, static_cast<int>(input->sensed.sign),
                        input->sensed.palm_at_target, input->boots, packets);
}

}  // namespace

ProgramOutputs PythonExchange::operator()(std::uint32_t tick, const ProgramInputs& inputs) const {
  ProgramOutputs outputs{};
  const nb::object answers =
      exchange(tick, input_of(inputs[0]), input_of(inputs[1]), input_of(inputs[2]));
  for (std::size_t i = 0; i < programs; ++i) {
    if (!inputs[i]) continue;
    const auto [palm, move, stop, packets, name, waits, awaits, rejected, late, assists] =
        nb::cast<Answer>(answers[i]);
    ProgramOutput& out = outputs[i];
    out.command = {static_cast<Palm>(palm), static_cast<Move>(move), stop};
    for (const auto& [receiver, bytes, word] : packets) {
      out.packets.push_back(
          {static_cast<wire::Role>(receiver), packet_of(bytes), static_cast<MessageKind>(word)});
    }
    out.name = static_cast<char>(name);
    out.waits = waits;
    out.awaits = static_cast<MessageKind>(awaits);
    out.rejected = rejected;
    out.late = late;
  }
  return outputs;
}

void bind_runtime(nb::module_& core) {
  nb::module_ m = core.def_submodule("runtime", "What a robot decides, packets in and out.");
  nb::class_<RobotHandle>(m, "Robot", "The program of one robot.")
      .def(
          "__init__",
          [](RobotHandle* self, const Spec& spec, nb::object controller, std::uint8_t side,
             const nb::bytes& key, std::uint16_t pair, std::uint32_t epoch, bool is_first,
             bool assists) {
            wire::Identity identity{{}, pair, static_cast<wire::Role>(side)};
            if (key.size() != identity.key.size()) throw std::out_of_range("a key has 16 bytes");
            std::copy_n(static_cast<const std::uint8_t*>(key.data()), key.size(),
                        identity.key.begin());
            new (self) RobotHandle(spec, std::move(controller),
                                   {identity, epoch, side, is_first, assists});
          },
          nb::arg("spec"), nb::arg("controller"), nb::arg("side"), nb::arg("key"), nb::arg("pair"),
          nb::arg("epoch"), nb::arg("is_first"), nb::arg("assists"),
          "controller: a name, Machines, or a pair of Python step functions.")
      .def("step", &RobotHandle::step, nb::arg("elapsed"), nb::arg("sign"),
           nb::arg("palm_at_target"), nb::arg("packets"),
           "One tick; returns palm, move, stop, packets (receiver, bytes, word), case, waits, "
           "awaits, packets rejected and late in this tick, and whether the palm assists.")
      .def("greet", &RobotHandle::greet,
           "A hello to the partner, before the carry; None if the controller has no use for it.")
      .def("hear", &RobotHandle::hear, nb::arg("bytes"), "Takes in a packet before the carry.")
      .def("count", &RobotHandle::count, nb::arg("verdict"),
           "How many received packets had this verdict.");
  m.def(
      "uses_clock",
      [](const nb::object& controller) {
        return nb::isinstance<nb::str>(controller) &&
               nb::cast<std::string>(controller) != "distributed";
      },
      nb::arg("controller"),
      "Does it count time, and start at rest? The others act on messages and contacts alone.");
  nb::class_<RemoteControllers>(m, "RemoteControllers",
                                "Controllers of a carry that run elsewhere (sim/remote_team.hpp).")
      .def(
          "__init__",
          [](RemoteControllers* self, nb::object exchange, bool has_clocks, bool starts_at_rest) {
            new (self) RemoteControllers{{std::move(exchange)}, has_clocks, starts_at_rest};
          },
          nb::arg("exchange"), nb::arg("has_clocks"), nb::arg("starts_at_rest"),
          "exchange(tick, left, right, station) gets inputs (elapsed, sign, palm at target, boots, "
          "packets) or None, and returns three answers of Robot.step or None.");
}

}  // namespace palmbots::bindings

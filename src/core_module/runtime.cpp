// SPDX-License-Identifier: Apache-2.0
// Robots as programs of their own: what each decides, tick by tick, and the team of a carry whose
// programs run elsewhere.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <vector>

#include "carry.hpp"
#include "machines.hpp"
#include "palmbots/runtime/any_robot.hpp"
#include "palmbots/sim/lift_robots.hpp"
#include "palmbots/sim/team_registry.hpp"
#include "remote.hpp"

namespace palmbots::bindings {

namespace {

using AnyRobot = std::shared_ptr<runtime::Robot>;

// What a robot knows when its program starts.
struct Start {
  wire::Identity identity;
  std::uint32_t epoch;
  std::size_t side;
  bool assists;  // stored: the palm was up for the partner
  bool holds;    // stored: of the table of the job (runtime/phase_program.hpp)
  runtime::RuntimeSettings settings;
  runtime::StoredMode stored;
  bool carries;  // the carry is under way
};

template <class Table>
runtime::PhaseProgram<Table> phases_of(const Spec& spec, const Start& s) {
  return {{uses_floor(spec), spec.begins_on != StandsOn::palms, spec.ends_on != StandsOn::palms,
           leader_of(spec) == s.side, stands_by(spec, s.side), corrects_level_only(spec),
           table_times_of<Table>(spec)},
          s.epoch,
          s.holds};
}

template <class Table = Lifting, class Program>
AnyRobot robot_with(const Spec& spec, const Start& s, const Program& fresh,
                    const Program& rebooted) {
  return std::make_shared<runtime::RobotWith<Program, runtime::PhaseProgram<Table>>>(
      s.identity, s.epoch, fresh, rebooted, phases_of<Table>(spec, s), s.settings, s.stored,
      s.carries);
}

template <class Controller>
AnyRobot partner_robot(const Spec& spec, const Start& start, const Controller& controller) {
  const runtime::PartnerProgram<Controller> program(controller, start.epoch);
  return robot_with(spec, start, program, program);
}

AnyRobot robot_of(const Spec& spec, const nb::object& controller, const Start& start) {
  if (on_one_palm(spec)) {
    return with_job_table(spec, [&]<class Table>(Table) {
      const runtime::NoProgram program;
      return robot_with<Table>(spec, start, program, program);
    });
  }
  if (nb::isinstance<Machines>(controller)) {
    return partner_robot(spec, start,
                         MachineRobot(&nb::cast<const Machines&>(controller).tables[start.side]));
  }
  if (!nb::isinstance<nb::str>(controller)) {
    return partner_robot(spec, start, python_controllers(controller, spec)[start.side]);
  }
  AnyRobot robot;
  visit_program(nb::cast<std::string>(controller), [&](auto maker) {
    if constexpr (requires { typename decltype(maker)::Program; }) {
      const std::vector<std::uint16_t> times = program_times(maker, spec);
      const runtime::ProgramStart program{times,
                                          start.epoch,
                                          leader_of(spec) == start.side,
                                          spec.brake != 0,
                                          spec.start_by_touch != 0,
                                          start.assists};
      robot = robot_with(spec, start, maker.fresh(program), maker.rebooted(program));
    }
  });
  if (!robot) throw std::invalid_argument("controller: does not run on robots");
  return robot;
}

using StampTuple = std::tuple<std::uint32_t, std::uint32_t>;
// Verdict, sender (−1: the packet is not authentic), stamp, newest stamp that the sender had heard.
using Judged = std::tuple<int, int, StampTuple, StampTuple>;

// The program of one robot.
class RobotHandle {
 public:
  RobotHandle(const Spec& spec, nb::object controller, const Start& start)
      : controller_(std::move(controller)), robot_(robot_of(spec, controller_, start)) {}

  Answer step(std::uint16_t elapsed, const runtime::Reading& reading,
              const std::vector<nb::bytes>& packets) {
    const runtime::ReceivedCounts before = robot_->received();
    const runtime::ReceivedCounts phases_before = robot_->received_phases();
    robot_->begin(elapsed);
    judged_.clear();
    for (const nb::bytes& bytes : packets) judged_.push_back(hear(bytes));
    if (wish_) robot_->operate(*wish_);
    wish_.reset();
    runtime::Outputs out;
    robot_->step(reading, out);
    mode_ = out.mode;
    arm_ = out.arm;
    arm_ends_ = out.arm_ends;
    holds_ = out.holds;
    std::vector<PacketTuple> sent;
    stamps_.clear();
    for (std::size_t i = 0; i < out.packet_count; ++i) {
      const runtime::Outgoing& p = out.packets[i];
      sent.emplace_back(static_cast<int>(p.receiver), nb::bytes(p.bytes.data(), p.bytes.size()),
                        static_cast<int>(p.message));
      const auto kind = static_cast<wire::PacketKind>(p.bytes[wire::kind_field.offset]);
      stamps_.push_back(stamp_of(robot_->endpoint().newest(p.receiver, kind)));
    }
    const Command& command = out.decision.command;
    return {static_cast<int>(command.palm),
            static_cast<int>(command.move),
            command.stop,
            sent,
            robot_->name(),
            robot_->waits(),
            static_cast<int>(robot_->awaits()),
            robot_->received().rejected - before.rejected,
            robot_->received().late - before.late,
            {robot_->phase(), robot_->received_phases().rejected - phases_before.rejected,
             robot_->received_phases().late - phases_before.late},
            out.decision.assists};
  }

  // What the endpoint judged of the packets of the last step.
  std::vector<Judged> judged() const {
    std::vector<Judged> all;
    for (const wire::Decoded& got : judged_) {
      const wire::Packet& packet = got.packet;
      const int sender = wire::is_authentic(got.verdict) ? static_cast<int>(packet.sender) : -1;
      all.emplace_back(static_cast<int>(got.verdict), sender, stamp_of(packet.sent),
                       stamp_of(packet.heard));
    }
    return all;
  }

  // The stamps of the packets that it sent in the last step.
  const std::vector<StampTuple>& stamps() const { return stamps_; }

  const runtime::ModeOutputs& mode() const { return mode_; }
  ArmMove arm() const { return arm_; }
  bool arm_ends() const { return arm_ends_; }
  bool holds() const { return holds_; }
  int phase() const { return robot_->phase(); }
  const char* phase_name() const { return robot_->phase_name(); }
  bool counts() const { return robot_->counts(); }
  double share_of_way() const { return 0.5 * robot_->halves_of_way(); }

  std::optional<nb::bytes> greet() {
    wire::Bytes bytes{};
    const bool written = robot_->greet(bytes);
    if (!written) return std::nullopt;
    return nb::bytes(bytes.data(), bytes.size());
  }

  void operate(int wish) {
    if (wish < 0 || wish >= static_cast<int>(wire::operations)) {
      throw std::out_of_range("operation: unknown number");
    }
    wish_ = static_cast<wire::Operation>(wish);
  }

  wire::Decoded hear(const nb::bytes& bytes) {
    return robot_->receive({static_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  }

  std::uint32_t count(std::size_t verdict) const {
    return robot_->endpoint().count(static_cast<wire::Verdict>(verdict));
  }

 private:
  static StampTuple stamp_of(const wire::SequenceNumber& stamp) {
    return {stamp.epoch, stamp.sequence};
  }

  runtime::ModeOutputs mode_{};
  ArmMove arm_ = ArmMove::hold;
  bool arm_ends_ = false;
  bool holds_ = false;
  std::vector<wire::Decoded> judged_;
  std::vector<StampTuple> stamps_;
  std::optional<wire::Operation> wish_;  // given at the robot, for the next step
  nb::object controller_;                // outlives the robot, which may point into it
  AnyRobot robot_;
};

void bind_settings(nb::module_& m) {
  using runtime::Reading;
  using runtime::RuntimeSettings;
  nb::class_<RuntimeSettings>(m, "RuntimeSettings", "Times in control ticks.")
      .def(
          "__init__",
          [](RuntimeSettings* self, std::uint32_t lease, std::uint32_t station_limit,
             std::uint32_t time_limit, std::uint32_t travel, std::uint32_t stopping_limit,
             std::uint16_t most_overruns, bool has_radio, bool rejoins, bool stops_without_station,
             bool stops_without_partner, std::uint16_t state_period, std::uint16_t status_period,
             std::uint32_t number, std::uint32_t order_age) {
            using namespace runtime;
            new (self) RuntimeSettings{
                {rejoins ? AfterReboot::rejoin : AfterReboot::disarm,
                 stops_without_station ? StationLost::stop : StationLost::carry_on,
                 stops_without_partner ? PartnerLost::stop : PartnerLost::controller, has_radio,
                 lease, station_limit, time_limit, travel, stopping_limit, most_overruns},
                state_period,
                status_period,
                number,
                order_age};
          },
          nb::arg("lease"), nb::arg("station_limit"), nb::arg("time_limit"), nb::arg("travel"),
          nb::arg("stopping_limit"), nb::arg("most_overruns"), nb::arg("has_radio"),
          nb::arg("rejoins"), nb::arg("stops_without_station"), nb::arg("stops_without_partner"),
          nb::arg("state_period"), nb::arg("status_period"), nb::arg("number"),
          nb::arg("order_age") = runtime::never)
      .def_static(
          "lockstep",
          [] {
            using namespace runtime;
            RuntimeSettings settings{};
            settings.mode.station_lost = StationLost::carry_on;
            settings.mode.partner_lost = PartnerLost::controller;
            settings.mode.lease = settings.mode.station_limit = settings.mode.time_limit = never;
            settings.mode.most_overruns = 0xFFFF;
            settings.ends_jobs = false;
            return settings;
          },
          "The controller alone decides, and nothing is sent but what it says.");
  nb::class_<Reading>(m, "Reading", "What a robot reads in a tick.")
      .def(
          "__init__",
          [](Reading* self, int sign, bool palm_at_target, bool contact, bool battery_ok,
             bool driver_ok, bool storage_ok, bool covered, bool stop, std::uint16_t overruns,
             std::uint16_t battery_mv, std::uint16_t progress, std::uint32_t stopping,
             bool arm_there, std::uint8_t arm_steps, bool beneath) {
            if (sign < -1 || sign > 1) throw std::out_of_range("sign is -1, 0 or 1");
            new (self) Reading{{static_cast<Sign>(sign), palm_at_target},
                               contact,
                               battery_ok,
                               driver_ok,
                               storage_ok,
                               covered,
                               stop,
                               overruns,
                               battery_mv,
                               progress,
                               stopping,
                               arm_there,
                               arm_steps,
                               beneath};
          },
          nb::arg("sign"), nb::arg("palm_at_target"), nb::arg("contact") = true,
          nb::arg("battery_ok") = true, nb::arg("driver_ok") = true, nb::arg("storage_ok") = true,
          nb::arg("covered") = false, nb::arg("stop") = false, nb::arg("overruns") = 0,
          nb::arg("battery_mv") = 0xFFFF, nb::arg("progress") = 0, nb::arg("stopping") = 0,
          nb::arg("arm_there") = false, nb::arg("arm_steps") = 0, nb::arg("beneath") = false);
}

}  // namespace

void bind_runtime(nb::module_& core) {
  nb::module_ m = core.def_submodule("runtime", "What a robot decides, packets in and out.");
  bind_settings(m);
  nb::class_<RobotHandle>(m, "Robot", "The program of one robot.")
      .def(
          "__init__",
          [](RobotHandle* self, const Spec& spec, nb::object controller, std::uint8_t side,
             const nb::bytes& key, std::uint16_t pair, std::uint32_t epoch, bool assists,
             const runtime::RuntimeSettings& settings, bool carries, bool stored_carries,
             bool stored_stop, bool holds) {
            const wire::Identity identity{key_of(key), pair, static_cast<wire::Role>(side)};
            new (self) RobotHandle(spec, std::move(controller),
                                   {identity,
                                    epoch,
                                    side,
                                    assists,
                                    holds,
                                    settings,
                                    {stored_carries, stored_stop},
                                    carries});
          },
          nb::arg("spec"), nb::arg("controller"), nb::arg("side"), nb::arg("key"), nb::arg("pair"),
          nb::arg("epoch"), nb::arg("assists"), nb::arg("settings"), nb::arg("carries") = false,
          nb::arg("stored_carries") = false, nb::arg("stored_stop") = false,
          nb::arg("holds") = false,
          "controller: a name, Machines, or a pair of Python step functions. carries: the carry is "
          "under way, as in lockstep.")
      .def(
          "step", &RobotHandle::step, nb::arg("elapsed"), nb::arg("reading"), nb::arg("packets"),
          "One tick; returns palm, move, stop, packets (receiver, bytes, message), case, waits, "
          "awaits, packets rejected and late in this tick, (phase, its packets rejected and late), "
          "and whether the palm assists.")
      .def_prop_ro("mode", [](const RobotHandle& r) { return name_of(r.mode().mode); })
      .def_prop_ro("fault", [](const RobotHandle& r) { return name_of(r.mode().code); })
      .def_prop_ro(
          "wheels", [](const RobotHandle& r) { return r.mode().wheels; },
          "The wheels may turn; otherwise the driver is to stop them at once.")
      .def_prop_ro(
          "to_store",
          [](const RobotHandle& r) {
            return std::tuple(r.mode().store.carries, r.mode().store.stop);
          },
          "To be stored when it changes: a carry is under way, a stop is in force.")
      .def_prop_ro("holds", &RobotHandle::holds,
                   "To be stored when it changes: in a job on the floor, the arms may be up.")
      .def_prop_ro(
          "arm", [](const RobotHandle& r) { return static_cast<int>(r.arm()); },
          "What the arm does: 0 follows the floor, 1 reaches, 2 holds, 3 rises, 4 sinks.")
      .def_prop_ro("arm_ends", &RobotHandle::arm_ends,
                   "The lowest height of the arm is that at the end of the job.")
      .def_prop_ro("phase", &RobotHandle::phase_name,
                   "The phase of a job on the floor; empty: it is none.")
      .def_prop_ro("phase_state", &RobotHandle::phase, "The number of this phase in its table.")
      .def_prop_ro("counts", &RobotHandle::counts,
                   "What it moves counts as a part of the distance.")
      .def_prop_ro("share_of_way", &RobotHandle::share_of_way,
                   "The share of the distance after which it is far enough in this phase.")
      .def("greet", &RobotHandle::greet,
           "A hello to the partner, before the carry; None if the controller has no use for it.")
      .def("operate", &RobotHandle::operate, nb::arg("operation"),
           "What the operator wants who presses a button of the robot; for the next step.")
      .def_prop_ro("judged", &RobotHandle::judged,
                   "Of each packet of the last step (verdict, sender, (epoch, sequence) sent and "
                   "heard); sender -1: its tag is wrong, and nothing is known of it.")
      .def_prop_ro("stamps", &RobotHandle::stamps,
                   "(epoch, sequence) of each packet that it sent in the last step.")
      .def(
          "hear", [](RobotHandle& r, const nb::bytes& bytes) { r.hear(bytes); }, nb::arg("bytes"),
          "Takes in a packet before the carry.")
      .def("count", &RobotHandle::count, nb::arg("verdict"),
           "How many received packets had this verdict.");
  m.def(
      "times",
      [](const Spec& spec, const std::string& controller) {
        std::vector<std::uint16_t> times;
        visit_program(controller, [&](auto maker) { times = program_times(maker, spec); });
        return times;
      },
      nb::arg("spec"), nb::arg("controller"),
      "The times of a shipped controller [ticks], in the order of its struct Times; [] if it has "
      "none.");
  m.def(
      "phase_times",
      [](const Spec& spec) {
        return with_job_table(spec, [&]<class Table>(Table) {
          const TableTimes<Table> times = table_times_of<Table>(spec);
          std::vector<std::uint16_t> all{times.beacon, times.lease};
          all.insert(all.end(), times.limits.begin(), times.limits.end());
          return all;
        });
      },
      nb::arg("spec"),
      "The times of the table of a job on the floor [ticks]: beacon, lease, limits.");
  m.def(
      "job_table",
      [](const Spec& spec) {
        return with_job_table(spec, []<class Table>(Table) { return Table::number; });
      },
      nb::arg("spec"), "The number of the table of a job on the floor.");
  m.def(
      "arm_step_m", [](const Spec& spec) { return lift_step_of(spec); }, nb::arg("spec"),
      "A step of the table of a job on the floor: what an arm moves in a lease and a delay [m].");
  m.attr("policy_board_number") = policy_board_number;
  bind_remote(m);
}

}  // namespace palmbots::bindings

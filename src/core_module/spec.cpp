// SPDX-License-Identifier: Apache-2.0
// Spec: what a scene becomes before it is carried.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <bit>
#include <cstring>
#include <stdexcept>
#include <string>

#include "bindings.hpp"
#include "palmbots/sim/build.hpp"

namespace palmbots::bindings {

namespace {

// Copies a Python list into one of the spec's fixed arrays.
template <class Item, std::size_t N, class Store>
void fill(const std::vector<Item>& items, std::size_t& count, std::array<Store, N>& to,
          const char* what, Store (*convert)(const Item&)) {
  if (items.size() > N) {
    throw std::invalid_argument(std::string(what) + ": at most " + std::to_string(N));
  }
  count = items.size();
  for (std::size_t i = 0; i < count; ++i) to[i] = convert(items[i]);
}

using VertexItem = std::tuple<double, double, double>;
using ZoneItem = std::tuple<int, double, double>;
using BumpItem = std::tuple<std::uint32_t, bool, double, double>;
using PushItem = std::tuple<std::uint32_t, double, double, double>;
using OutageItem = std::tuple<std::uint32_t, double, double>;
using MessageFaultItem = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, double>;
using FaultItem =
    std::tuple<std::uint32_t, std::uint32_t, double, double, std::int32_t, double, std::uint64_t>;
using DirectionItem = std::tuple<double, double, double>;

}  // namespace

void bind_spec(nb::module_& m) {
  nb::class_<PalmSpec>(m, "PalmSpec", "One palm, in SI units and radians.")
      .def(nb::init<>())
      .def_rw("length", &PalmSpec::length)
      .def_rw("offset", &PalmSpec::offset)
      .def_rw("friction", &PalmSpec::friction)
      .def_rw("shallow", &PalmSpec::shallow)
      .def_rw("steep", &PalmSpec::steep)
      .def_rw("rate", &PalmSpec::rate);

  nb::class_<RobotSpec>(m, "RobotSpec", "One robot's wheels, in SI units.")
      .def(nb::init<>())
      .def_rw("speed", &RobotSpec::speed)
      .def_rw("correction", &RobotSpec::correction)
      .def_rw("acceleration", &RobotSpec::acceleration)
      .def_rw("max_speed", &RobotSpec::max_speed)
      .def_rw("noise", &RobotSpec::noise)
      .def_rw("noise_tau", &RobotSpec::noise_tau)
      .def_rw("bias", &RobotSpec::bias)
      .def_rw("clock_drift", &RobotSpec::clock_drift)
      .def_rw("stride", &RobotSpec::stride);

  nb::class_<Spec>(m, "Spec", "Everything that defines a carry, as plain numbers.")
      .def(nb::init<>())
      .def_rw("width", &Spec::width)
      .def_rw("com_left", &Spec::com_left)
      .def_rw("com_right", &Spec::com_right)
      .def_rw("com_height", &Spec::com_height)
      .def_prop_rw(
          "outline",
          [](const Spec& s) {
            std::vector<VertexItem> items;
            for (std::size_t i = 0; i < s.outline.count; ++i) {
              const Vertex<double>& v = s.outline.vertices[i];
              items.emplace_back(v.along[left], v.along[right], v.height);
            }
            return items;
          },
          [](Spec& s, const std::vector<VertexItem>& items) {
            fill<VertexItem, max_outline, Vertex<double>>(
                items, s.outline.count, s.outline.vertices, "outline", [](const VertexItem& v) {
                  return Vertex<double>{{std::get<0>(v), std::get<1>(v)}, std::get<2>(v)};
                });
          },
          "Vertices as (from left contact, from right contact, height); the first is the left "
          "contact.")
      .def_prop_rw(
          "contact_right", [](const Spec& s) { return s.outline.contact[right]; },
          [](Spec& s, std::size_t index) { s.outline.contact = {0, index}; })
      .def_prop_rw(
          "palms", [](const Spec& s) { return std::pair(s.palms[left], s.palms[right]); },
          [](Spec& s, const std::pair<PalmSpec, PalmSpec>& palms) {
            s.palms[left] = palms.first;
            s.palms[right] = palms.second;
          })
      .def_prop_rw(
          "robots", [](const Spec& s) { return std::pair(s.robots[left], s.robots[right]); },
          [](Spec& s, const std::pair<RobotSpec, RobotSpec>& robots) {
            s.robots[left] = robots.first;
            s.robots[right] = robots.second;
          })
      .def_prop_rw(
          "zones",
          [](const Spec& s) {
            std::vector<ZoneItem> items;
            for (std::size_t i = 0; i < s.zone_count; ++i) {
              items.emplace_back(static_cast<int>(s.zones[i].sign), s.zones[i].from, s.zones[i].to);
            }
            return items;
          },
          [](Spec& s, const std::vector<ZoneItem>& items) {
            fill<ZoneItem, max_zones, ZoneSpec>(
                items, s.zone_count, s.zones, "zones", [](const ZoneItem& z) {
                  return ZoneSpec{std::get<0>(z), std::get<1>(z), std::get<2>(z)};
                });
          })
      .def_rw("false_rate", &Spec::false_rate)
      .def_rw("period", &Spec::period)
      .def_rw("latency", &Spec::latency)
      .def_rw("jitter", &Spec::jitter)
      .def_rw("loss", &Spec::loss)
      .def_rw("duplicate", &Spec::duplicate)
      .def_rw("corruption", &Spec::corruption)
      .def_prop_rw(
          "reorders", [](const Spec& s) { return s.reorders != 0; },
          [](Spec& s, bool reorders) { s.reorders = reorders ? 1 : 0; })
      .def_prop_rw(
          "sessions", [](const Spec& s) { return s.sessions != 0; },
          [](Spec& s, bool sessions) { s.sessions = sessions ? 1 : 0; })
      .def_rw("burst_share", &Spec::burst_share)
      .def_rw("burst_mean", &Spec::burst_mean)
      .def_rw("airtime", &Spec::airtime)
      .def_rw("beacon", &Spec::beacon)
      .def_rw("lease", &Spec::lease)
      .def_prop_rw(
          "brake", [](const Spec& s) { return s.brake != 0; },
          [](Spec& s, bool brake) { s.brake = brake ? 1 : 0; })
      .def_prop_rw(
          "start_by_touch", [](const Spec& s) { return s.start_by_touch != 0; },
          [](Spec& s, bool by_touch) { s.start_by_touch = by_touch ? 1 : 0; })
      .def_rw("watchdog", &Spec::watchdog)
      .def_rw("random_reboots", &Spec::random_reboots)
      .def_rw("reboot", &Spec::reboot)
      .def_prop_rw(
          "outages",
          [](const Spec& s) {
            std::vector<OutageItem> items;
            for (std::size_t i = 0; i < s.outage_count; ++i) {
              items.emplace_back(s.outages[i].sender, s.outages[i].from, s.outages[i].to);
            }
            return items;
          },
          [](Spec& s, const std::vector<OutageItem>& items) {
            fill<OutageItem, max_outages, OutageSpec>(
                items, s.outage_count, s.outages, "outages", [](const OutageItem& o) {
                  return OutageSpec{std::get<0>(o), std::get<1>(o), std::get<2>(o)};
                });
          },
          "(sender, from, to) in s; sender 0: left, 1: right, 2: station.")
      .def_prop_rw(
          "message_faults",
          [](const Spec& s) {
            std::vector<MessageFaultItem> items;
            for (std::size_t i = 0; i < s.message_fault_count; ++i) {
              const MessageFaultSpec& plan = s.message_faults[i];
              items.emplace_back(plan.link, plan.message, plan.effect, plan.late);
            }
            return items;
          },
          [](Spec& s, const std::vector<MessageFaultItem>& items) {
            fill<MessageFaultItem, max_message_faults, MessageFaultSpec>(
                items, s.message_fault_count, s.message_faults, "message_faults",
                [](const MessageFaultItem& item) {
                  return MessageFaultSpec{std::get<0>(item), std::get<1>(item), std::get<2>(item),
                                          std::get<3>(item)};
                });
          },
          "(link, message, effect, late) of single messages: link 0: from left, 1: from right, 2: "
          "from the station to left, 3: to right; message from 1; effect 0: lost, 1: late, 2: "
          "copied; late in s.")
      .def_prop_rw(
          "faults",
          [](const Spec& s) {
            std::vector<FaultItem> items;
            for (std::size_t i = 0; i < s.fault_count; ++i) {
              const FaultSpec& f = s.faults[i];
              items.emplace_back(static_cast<std::uint32_t>(f.kind), f.side, f.at, f.lasts, f.reads,
                                 f.rate, f.marks);
            }
            return items;
          },
          [](Spec& s, const std::vector<FaultItem>& items) {
            fill<FaultItem, max_faults, FaultSpec>(
                items, s.fault_count, s.faults, "faults", [](const FaultItem& f) {
                  return FaultSpec{static_cast<FaultKind>(std::get<0>(f)),
                                   std::get<1>(f),
                                   std::get<2>(f),
                                   std::get<3>(f),
                                   std::get<4>(f),
                                   std::get<5>(f),
                                   std::get<6>(f)};
                });
          },
          "(kind, side, at, lasts, reads, rate, marks) in s, in order of FaultKind.")
      .def_rw("distance", &Spec::distance)
      .def_rw("slope", &Spec::slope)
      .def_rw("inertia", &Spec::inertia)
      .def_rw("inertia_lag", &Spec::inertia_lag)
      .def_rw("direction", &Spec::direction)
      .def_rw("timeout_ticks", &Spec::timeout_ticks)
      .def_prop_rw(
          "start", [](const Spec& s) { return std::pair(s.start[left], s.start[right]); },
          [](Spec& s, std::pair<double, double> start) {
            s.start[left] = start.first;
            s.start[right] = start.second;
          })
      .def_prop_rw(
          "bumps",
          [](const Spec& s) {
            std::vector<BumpItem> items;
            for (std::size_t i = 0; i < s.bump_count; ++i) {
              const BumpSpec& b = s.bumps[i];
              items.emplace_back(b.side, b.by_time != 0, b.at, b.shift);
            }
            return items;
          },
          [](Spec& s, const std::vector<BumpItem>& items) {
            fill<BumpItem, max_bumps, BumpSpec>(
                items, s.bump_count, s.bumps, "bumps", [](const BumpItem& b) {
                  return BumpSpec{std::get<0>(b), std::get<1>(b) ? 1U : 0U, std::get<2>(b),
                                  std::get<3>(b)};
                });
          })
      .def_prop_rw(
          "pushes",
          [](const Spec& s) {
            std::vector<PushItem> items;
            for (std::size_t i = 0; i < s.push_count; ++i) {
              const PushSpec& p = s.pushes[i];
              items.emplace_back(p.side, p.at, p.lasts, p.speed);
            }
            return items;
          },
          [](Spec& s, const std::vector<PushItem>& items) {
            fill<PushItem, max_pushes, PushSpec>(
                items, s.push_count, s.pushes, "pushes", [](const PushItem& p) {
                  return PushSpec{std::get<0>(p), std::get<1>(p), std::get<2>(p), std::get<3>(p)};
                });
          },
          "(side, at, lasts, speed) in s and m/s, outward.")
      .def_rw("bump_rate", &Spec::bump_rate)
      .def_rw("bump_max", &Spec::bump_max)
      .def_rw("safe_reach", &Spec::safe_reach)
      .def_prop_rw(
          "directions",
          [](const Spec& s) {
            std::vector<DirectionItem> items;
            for (const DirectionSpec& d : s.directions) {
              items.emplace_back(d.latency, d.jitter, d.loss);
            }
            return items;
          },
          [](Spec& s, const std::vector<DirectionItem>& items) {
            if (items.size() != 3) throw std::invalid_argument("directions: three");
            for (std::size_t i = 0; i < 3; ++i) {
              const auto& [latency, jitter, loss] = items[i];
              s.directions[i] = {latency, jitter, loss};
            }
          },
          "(latency, jitter, loss) of what left, right and station send; < 0: as for all.")
      .def_rw("replay", &Spec::replay)
      .def_rw("replay_delay", &Spec::replay_delay)
      .def_prop_ro(
          "longest_delay", [](const Spec& s) { return s.longest_delay(); },
          "The longest delay of any link [s].")
      .def_prop_ro(
          "may_go_limp", [](const Spec& s) { return may_go_limp(s); },
          "A palm may go limp: carries of this spec do not run side by side.")
      .def(
          "to_bytes",
          [](const Spec& s) { return nb::bytes(reinterpret_cast<const char*>(&s), sizeof s); },
          "The spec as it lies in memory, for C++ programs on the same machine.")
      .def_static(
          "list_from_bytes",
          [](const nb::bytes& bytes) {
            if (bytes.size() % sizeof(Spec) != 0) throw std::invalid_argument("bytes: whole specs");
            std::vector<Spec> specs(bytes.size() / sizeof(Spec));
            std::memcpy(specs.data(), bytes.c_str(), bytes.size());
            return specs;
          },
          nb::arg("bytes"), "The specs of which these are the bytes, one after the other.");

  m.def(
      "safe_reach", [](const Spec& spec) { return safe_reach(spec); }, nb::arg("spec"),
      "How far from the middle of their palms both contacts are certain to be held at any angles "
      "[m]; "
      "-1: unknown.");
}

}  // namespace palmbots::bindings

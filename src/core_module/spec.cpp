// SPDX-License-Identifier: Apache-2.0
// Spec: what a scene becomes before it is carried. Its attributes are the members that the table of
// keys names.
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <span>
#include <stdexcept>
#include <string>

#include "bindings.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/object_frame.hpp"
#include "palmbots/sim/plate_section.hpp"
#include "palmbots/sim/spec_bytes.hpp"
#include "palmbots/sim/standing_start.hpp"
#include "palmbots/sim/wheel_errors.hpp"

namespace palmbots::bindings {

namespace {

nb::object to_python(const Key& key, const void* record) {
  const double value = key.get(record);
  if (key.kind == KeyKind::flag) return nb::bool_(value != 0);
  if (key.kind == KeyKind::number) return nb::float_(value);
  return nb::int_(static_cast<std::int64_t>(value));
}

// The members of a record that the keys name.
nb::tuple to_tuple(std::span<const Key> keys, const void* record) {
  nb::list values;
  for (const Key& key : keys) {
    if (key.get != nullptr) values.append(to_python(key, record));
  }
  return nb::tuple(values);
}

void from_tuple(std::span<const Key> keys, void* record, nb::handle values) {
  std::size_t k = 0;
  for (const Key& key : keys) {
    if (key.get != nullptr) key.put(record, nb::cast<double>(values[k++]));
  }
  if (k != nb::len(values)) throw std::invalid_argument("a record has another number of values");
}

// The attribute of a key; `at` returns the structure that has the member.
template <class Class, class At>
void bind_member(nb::class_<Class>& type, const Key& key, At at) {
  const std::string name(key.member);
  const Key* const row = &key;
  switch (key.kind) {
    case KeyKind::number:
      type.def_prop_rw(
          name.c_str(), [row, at](Class& s) { return row->get(at(s)); },
          [row, at](Class& s, double value) { row->put(at(s), value); });
      break;
    case KeyKind::whole:
    case KeyKind::choice:
      type.def_prop_rw(
          name.c_str(), [row, at](Class& s) { return static_cast<std::int64_t>(row->get(at(s))); },
          [row, at](Class& s, std::int64_t value) { row->put(at(s), double(value)); });
      break;
    case KeyKind::flag:
      type.def_prop_rw(
          name.c_str(), [row, at](Class& s) { return row->get(at(s)) != 0; },
          [row, at](Class& s, bool value) { row->put(at(s), value ? 1.0 : 0.0); });
  }
}

template <class Record>
nb::class_<Record> bind_records(nb::module_& m, const char* name, const char* about,
                                std::span<const Key> keys) {
  nb::class_<Record> type(m, name, about);
  type.def(nb::init<>());
  for (const Key& key : keys) {
    if (key.get != nullptr) {
      bind_member(type, key, [](Record& record) -> void* { return &record; });
    }
  }
  return type;
}

// The attribute of a list: tuples of the members that its keys name.
void bind_list(nb::class_<Spec>& type, const Section& section, const RecordList& list) {
  const std::string name(list.member);
  std::string about = "(";
  for (const Key& key : list.keys) {
    if (key.get != nullptr) about += (about.size() > 1 ? ", " : "") + std::string(key.member);
  }
  about += ") of each, at most " + std::to_string(list.most) + ".";
  const auto at = section.at;
  const RecordList* const rows = &list;
  type.def_prop_rw(
      name.c_str(),
      [rows, at](Spec& s) {
        void* const owner = at(s, 0);
        nb::typed<nb::list, nb::tuple> items;
        for (std::size_t i = 0; i < rows->count(owner); ++i) {
          items.append(to_tuple(rows->keys, rows->at(owner, i)));
        }
        return items;
      },
      [rows, at](Spec& s, const nb::typed<nb::sequence, nb::tuple>& items) {
        const std::size_t count = nb::len(items);
        if (count > rows->most) {
          throw std::invalid_argument(std::string(rows->member) + ": at most " +
                                      std::to_string(rows->most));
        }
        void* const owner = at(s, 0);
        rows->resize(owner, count);
        for (std::size_t i = 0; i < count; ++i) {
          from_tuple(rows->keys, rows->at(owner, i), items[i]);
        }
      },
      about.c_str());
}

std::vector<Spec> specs_of(const nb::bytes& bytes) {
  std::span<const std::byte> rest(static_cast<const std::byte*>(bytes.data()), bytes.size());
  std::vector<Spec> specs;
  while (!rest.empty()) {
    const auto spec = take_spec(rest);
    if (!spec) throw std::invalid_argument("bytes: whole specs");
    specs.push_back(*spec);
  }
  return specs;
}

}  // namespace

void bind_spec(nb::module_& m) {
  m.attr("thin_plate_thickness") = thin_plate_thickness;
  bind_records<PalmSpec>(m, "PalmSpec", "One palm, in SI units and radians.", palm_keys)
      .def(
          "lowest_pivot",
          [](const PalmSpec& p, double angle) { return p.lowest_pivot(sin_cos(angle)); },
          nb::arg("angle"),
          "Height of the pivot [m] with the inner end of the palm on the floor, at an angle [rad].")
      .def_prop_ro("plate_thickness", &plate_thickness,
                   "Thickness of the plate where it is drawn and has mass [m].");
  bind_records<RobotSpec>(m, "RobotSpec", "One robot's wheels, in SI units.", robot_keys);

  bind_records<ArmSpec>(m, "ArmSpec", "What raises and lowers one palm, in SI units.", arm_keys);

  nb::class_<Spec> type(m, "Spec", "Everything that defines a carry, in SI units and radians.");
  type.def(nb::init<>());
  for (const Section& section : sections) {
    for (const RecordList& list : section.lists) {
      if (!list.member.empty()) bind_list(type, section, list);
    }
    if (section.holders != Holders::one || section.name == "start") continue;
    const auto at = section.at;
    for (const Key& key : section.keys) {
      if (key.get != nullptr) bind_member(type, key, [at](Spec& s) { return at(s, 0); });
    }
  }
  type.def_prop_rw(
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
          "arms", [](const Spec& s) { return std::pair(s.arms[left], s.arms[right]); },
          [](Spec& s, const std::pair<ArmSpec, ArmSpec>& arms) {
            s.arms[left] = arms.first;
            s.arms[right] = arms.second;
          })
      .def_prop_ro("uses_floor", &uses_floor,
                   "Whether the job begins or ends on the floor or on a stand.")
      .def_prop_ro("on_one_palm", &on_one_palm,
                   "Whether one palm at a time holds the object in such a job.")
      .def_prop_rw(
          "start", [](const Spec& s) { return std::pair(s.start[left], s.start[right]); },
          [](Spec& s, std::pair<double, double> start) {
            s.start[left] = start.first;
            s.start[right] = start.second;
          })
      .def_prop_ro(
          "silhouette",
          [](const Spec& s) {
            std::vector<std::pair<double, double>> points;
            for (const Vec& p : silhouette(s)) points.emplace_back(p.x, p.y);
            return points;
          },
          "The outline to draw, (x, y) from the left contact vertex [m]: arcs as short edges.")
      .def_prop_ro(
          "corners",
          [](const Spec& s) {
            std::vector<std::tuple<double, double, double>> corners;
            const RoundedBody body = body_of(s);
            for (std::size_t i = 0; i < body.count; ++i) {
              const Corner& c = body.corners[i];
              const Vertex<double>& v = s.outline.vertices[i];
              const Vec at = c.radius > 0 ? c.centre : Vec{v.along[left], v.height};
              corners.emplace_back(at.x, at.y, c.radius);
            }
            return corners;
          },
          "(x, y, radius) of each corner's arc, from the left contact vertex [m].")
      .def_prop_ro(
          "longest_delay", [](const Spec& s) { return s.longest_delay(); },
          "The longest delay of any link [s].")
      .def_prop_ro(
          "may_go_limp", [](const Spec& s) { return may_go_limp(s); },
          "A palm may go limp: carries of this spec do not run side by side.")
      .def(
          "replay_errors",
          [](Spec& s, std::size_t side, const std::vector<std::uint32_t>& segments,
             const std::vector<double>& times, const std::vector<double>& errors,
             const std::vector<double>& gains) {
            if (side > 1 || times.size() != segments.size() || errors.size() != times.size() ||
                gains.size() != times.size()) {
              throw std::invalid_argument("a side, and columns of one length");
            }
            ErrorTrace trace = ErrorTrace::of({segments, times, errors, gains}, s.period);
            if (trace.segments.empty())
              throw std::invalid_argument("no segment is as long as control.period_s");
            s.robots[side].recorded = keep(std::move(trace));
          },
          nb::arg("side"), nb::arg("segments"), nb::arg("times"), nb::arg("errors"),
          nb::arg("gains"),
          "The robot of a side replays recorded displacement errors [m] at times [s]; ValueError: "
          "no segment is as long as a tick.")
      .def(
          "replay_fates",
          [](Spec& s, double interval, std::uint32_t kind, const std::vector<double>& delays) {
            if (!(interval > 0) || kind > RadioTrace::whole || delays.empty()) {
              throw std::invalid_argument("an interval, a kind of delays, and delays");
            }
            s.fates = keep(RadioTrace{interval, kind, delays});
          },
          nb::arg("interval"), nb::arg("kind"), nb::arg("delays"),
          "The radio replays the fates of packets sent at this interval [s]: delays [s], negative "
          "if lost. kind: 0 only losses, 1 in addition to the latency, 2 in place of all delays.")
      .def_prop_ro(
          "is_replayed",
          [](const Spec& s) {
            return s.fates != nullptr || s.robots[left].recorded != nullptr ||
                   s.robots[right].recorded != nullptr;
          },
          "Whether errors of a robot, or fates of packets, are recorded ones.")
      .def(
          "to_bytes",
          [](const Spec& s) {
            std::vector<std::byte> bytes;
            append_bytes(s, bytes);
            return nb::bytes(bytes.data(), bytes.size());
          },
          "All numbers of the spec. Equal specs have equal bytes, on every machine.")
      .def_static("list_from_bytes", &specs_of, nb::arg("bytes"),
                  "The specs of which these are the bytes, one after the other.");

  nb::class_<WheelErrors>(m, "WheelErrors",
                          "The errors of one robot's wheels, as a carry with this seed has them.")
      .def(nb::init<const Spec&, std::size_t, std::uint64_t>(), nb::arg("spec"), nb::arg("side"),
           nb::arg("seed"))
      .def("step", &WheelErrors::step,
           "The error of wheels that drive, in the next tick, along the direction of travel [m/s].")
      .def_prop_ro("held", &WheelErrors::held,
                   "The speed in that tick of wheels that brakes hold [m/s].")
      .def_prop_ro("gain", &WheelErrors::gain, "Actual speed per commanded speed [1].");
}

}  // namespace palmbots::bindings

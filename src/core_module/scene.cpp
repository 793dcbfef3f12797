// SPDX-License-Identifier: Apache-2.0
// Scenes: the table of their keys, the relations between the values of a scene, and its Spec.
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cmath>
#include <string>

#include "bindings.hpp"
#include "palmbots/sim/problem_text.hpp"
#include "palmbots/sim/scene_check.hpp"
#include "palmbots/sim/scene_warnings.hpp"
#include "palmbots/sim/spec_of_scene.hpp"
#include "palmbots/sim/start_refusal.hpp"

namespace palmbots::bindings {

namespace {

// Takes the values of a table of a scene, of a list or of a key. `place` is that of a holder, or the
// index of a record.
void take(SceneValues& scene, nb::handle value, const std::string& path, std::size_t place) {
  if (value.is_none()) return;
  if (nb::isinstance<nb::str>(value)) {
    scene.set(path, place, nb::cast<std::string>(value));
  } else if (nb::isinstance<nb::dict>(value)) {
    const bool is_shared = detail::has_holders(path);
    for (const auto& [name, inner] : nb::borrow<nb::dict>(value)) {
      const std::string key = nb::cast<std::string>(name);
      const std::size_t holder = detail::holder_of(key);
      if (is_shared && holder != detail::no_key) {
        take(scene, inner, path, own(holder));
      } else {
        take(scene, inner, path.empty() ? key : path + "." + key, place);
      }
    }
  } else if (nb::isinstance<nb::tuple>(value) || nb::isinstance<nb::list>(value)) {
    const bool is_list = detail::find_list(path) != detail::no_key;
    if (is_list) scene.begin_list(path, nb::len(value));
    std::size_t i = 0;
    for (nb::handle item : value) {
      if (is_list) {
        take(scene, item, path + "[]", i++);
      } else {
        take(scene, item, path + "[" + std::to_string(i++) + "]", place);
      }
    }
  } else if (nb::isinstance<nb::float_>(value) || nb::isinstance<nb::int_>(value)) {
    scene.set(path, place, nb::cast<double>(value));
  }
}

}  // namespace

SceneValues values_of(const nb::dict& table) {
  SceneValues scene;
  take(scene, table, "", common);
  return scene;
}

namespace {

nb::object value_of(const Key& key, double value) {
  if (!key.allows(value)) return nb::none();
  switch (key.kind) {
    case KeyKind::number: return nb::float_(value);
    case KeyKind::whole: return nb::int_(static_cast<std::int64_t>(value));
    case KeyKind::flag: return nb::bool_(value != 0);
    case KeyKind::choice: {
      const std::string_view name = key.choices->names[static_cast<std::size_t>(value - key.least)];
      return nb::str(name.data(), name.size());
    }
  }
  return nb::none();
}

// Who may have a value of their own for a key: both sides, or all senders.
nb::tuple holders_of(const Section& section, const Key& key) {
  nb::list names;
  for (const Section& own : scene_sections) {
    if (own.name != section.name || own.holders == Holders::one) continue;
    for (const Key& one : own.keys) {
      if (one.name != key.name) continue;
      for (std::size_t k = 0; k < own.holder_count(); ++k) {
        names.append(nb::str(sender_choices.names[k].data(), sender_choices.names[k].size()));
      }
    }
  }
  return nb::tuple(names);
}

nb::dict row_of(const Key& key, const std::string& path, const nb::tuple& holders) {
  constexpr const char* kinds[] = {"number", "whole", "flag", "choice"};
  nb::dict row;
  row["name"] = path;
  row["kind"] = kinds[static_cast<std::size_t>(key.kind)];
  row["unit"] = std::string(unit_names[static_cast<std::size_t>(key.unit)]);
  row["least"] = key.least;
  row["most"] = std::isinf(key.most) ? nb::object(nb::none()) : nb::object(nb::float_(key.most));
  row["is_open"] = key.is_open;
  nb::list choices;
  for (std::size_t k = 0; key.choices != nullptr && k < key.choices->count; ++k) {
    choices.append(nb::str(key.choices->names[k].data(), key.choices->names[k].size()));
  }
  row["choices"] = nb::tuple(choices);
  row["default"] = value_of(key, key.initial);
  row["holders"] = holders;
  return row;
}

// The rows of the table.
nb::list scene_keys() {
  nb::list rows;
  for (const Section& section : scene_sections) {
    const std::string table(section.name);
    if (section.holders != Holders::senders) {
      for (const Key& key : section.keys) {
        if (key.name.empty()) continue;
        const std::string path = table + "." + std::string(key.name);
        rows.append(row_of(key, path, holders_of(section, key)));
      }
    }
    for (const RecordList& list : section.lists) {
      const std::string name = table + "." + std::string(list.name) + "[]";
      for (const Key& key : list.keys) {
        if (key.name.empty()) continue;
        const std::string dot = key.name.starts_with('[') ? "" : ".";
        const std::string ending = key.name == itself ? "" : dot + std::string(key.name);
        rows.append(row_of(key, name + ending, nb::tuple()));
      }
    }
  }
  return rows;
}

// A controller of the registry, or one that is not in it: who decides.
ControllerInfo controller_of(const std::string& name, const std::string& team) {
  for (const ControllerInfo& info : controller_infos) {
    if (info.name == name) return info;
  }
  for (const Decider decider : {Decider::none, Decider::station, Decider::robots}) {
    if (team == name_of(decider)) return {.name = "", .description = "", .decider = decider};
  }
  throw std::invalid_argument("team: none, station or robots");
}

}  // namespace

void bind_scene(nb::module_& m) {
  m.def(
      "scene_keys", &scene_keys,
      "The keys of a scene that the core reads, in its table's order: name (`[]` stands for the "
      "records of a list), kind, unit, limits, choices, default (None: not set), and holders: the "
      "sides or senders that may have a value of their own.");
  m.def(
      "scene_lists",
      [] {
        nb::dict lists;
        for (const Section& section : scene_sections) {
          for (const RecordList& list : section.lists) {
            const std::string name = std::string(section.name) + "." + std::string(list.name);
            nb::list initial;
            for (const double number : list.initial) initial.append(number);
            lists[name.c_str()] = nb::make_tuple(list.most, initial);
          }
        }
        return lists;
      },
      "The lists of a scene: how many records each may have, and the numbers of the default.");
  m.def(
      "complete_object",
      [](const nb::dict& table) {
        const SceneObject object = object_of(values_of(table));
        nb::list vertices;
        for (const Point& vertex : object.vertices) {
          vertices.append(nb::make_tuple(vertex.x, vertex.y));
        }
        nb::dict found;
        found["vertices_m"] = vertices;
        found["contacts"] = nb::make_tuple(object.contacts[left], object.contacts[right]);
        found["com_m"] = nb::make_tuple(object.com.x, object.com.y);
        found["mass_kg"] = object.mass;
        return found;
      },
      nb::arg("scene"),
      "The outline of the object, and the keys that follow from it where they are not set.");
  m.def(
      "check_scene",
      [](const nb::dict& table) {
        std::vector<std::tuple<std::string, std::vector<double>, std::string, std::string>> found;
        for (const Problem& p : check(values_of(table))) {
          const auto value = p.value.all();
          found.emplace_back(key_text(p), std::vector<double>(value.begin(), value.end()),
                             filled_in(p.problem, p.numbers), filled_in(p.allowed, p.numbers));
        }
        return found;
      },
      nb::arg("scene"),
      "The relations between the given values of a scene that do not hold: (key, value, problem, "
      "allowed). Without a value, it is that of the key.");
  m.def(
      "friction_limit", &friction_limit, nb::arg("steepest_deg"),
      "Upper limit of the friction coefficient on a palm at this angle; infinite if it is level.");
  m.def(
      "spec_of_scene", [](const nb::dict& table) { return spec_of(values_of(table)); },
      nb::arg("scene"), "The spec of the given values of a scene.");
  m.def(
      "warnings_before",
      [](const nb::dict& table, const std::string& controller, const std::string& team) {
        const SceneValues scene = values_of(table);
        return warnings_before(spec_of(scene), controller_of(controller, team),
                               value_warnings(scene));
      },
      nb::arg("scene"), nb::arg("controller"), nb::arg("team"),
      "The warnings that are known before a carry of the given values of a scene starts. "
      "controller: of the registry, or an empty name. team: who decides, if it is none of these.");
  m.def(
      "zero_zone",
      [](const nb::dict& table) {
        const ZeroZone zone = zero_zone_of(spec_of(values_of(table)));
        return nb::make_tuple(zone.low, zone.high);
      },
      nb::arg("scene"), "Where the sensor stops reading - and starts reading + [m].");
  m.def(
      "overrun",
      [](const nb::dict& table, const std::string& controller, const std::string& team) {
        return overrun_of(spec_of(values_of(table)), controller_of(controller, team));
      },
      nb::arg("scene"), nb::arg("controller"), nb::arg("team"),
      "How far a contact can overrun the edge of the zero zone [m].");
  m.def(
      "palm_overlap", [](const Spec& spec) { return palm_overlap_of(spec); }, nb::arg("spec"),
      "The overlap of the palms at the start [m]; negative: the gap between them.");
  m.def(
      "palm_refusal", [](const Spec& spec) { return palm_refusal(spec); }, nb::arg("spec"),
      "Why no carry can begin with these palms; empty: it can.");
  m.def(
      "time_limit", [](const nb::dict& table) { return time_limit_of(values_of(table)); },
      nb::arg("scene"), "The time limit of a carry [s].");
}

}  // namespace palmbots::bindings

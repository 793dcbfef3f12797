// SPDX-License-Identifier: Apache-2.0
// The sections `object`, `start`, `floor`, `world` and `task` of a scene: what is carried, and how far. Lengths in m,
// times in s.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "palmbots/mechanics/clearance.hpp"
#include "palmbots/sim/scene_key.hpp"

namespace palmbots {

// The object in the frame of its two contact vertices: origin at the left one, x towards the right
// one. Where a contact vertex is rounded, the centre of its arc takes its place.
struct ObjectSpec {
  double width = 0;
  double com_left = 0;   // of the centre of mass from the left contact, along x
  double com_right = 0;  // from the right contact
  double com_height = 0;
  Outline<double> outline{};
};

namespace detail {

// A number of a vertex of the outline: its distance from a contact, its height or its radius.
template <std::size_t Which, class Corner>
constexpr auto& number_of(Corner& vertex) {
  if constexpr (Which < 2) {
    return vertex.along[Which];
  } else if constexpr (Which == 2) {
    return vertex.height;
  } else {
    return vertex.radius;
  }
}

template <std::size_t Which>
constexpr Key vertex_key() {
  Key key;
  key.member = "vertex";
  key.get = [](const void* v) { return number_of<Which>(*static_cast<const Vertex<double>*>(v)); };
  key.put = [](void* v, double value) {
    number_of<Which>(*static_cast<Vertex<double>*>(v)) = value;
  };
  return key;
}

constexpr Key contact_right_key() {
  Key key;
  key.member = "contact_right";
  key.kind = KeyKind::whole;
  key.get = [](const void* object) {
    return double(static_cast<const ObjectSpec*>(object)->outline.contact[right]);
  };
  key.put = [](void* object, double value) {
    static_cast<ObjectSpec*>(object)->outline.contact = {0, static_cast<std::size_t>(value)};
  };
  return key;
}

constexpr Key contact_key(std::string_view name, double initial) {
  constexpr double none = std::numeric_limits<double>::infinity();
  return source_whole(name, 0, none, initial);
}

}  // namespace detail

inline constexpr Key vertex_keys[] = {
    source_number("[0]", Unit::m, -10, 10, 0),
    source_number("[1]", Unit::m, -10, 10, 0),
    detail::vertex_key<left>(),
    detail::vertex_key<right>(),
    detail::vertex_key<2>(),
    detail::vertex_key<3>(),
};
inline constexpr Key edge_radius_keys[] = {source_number(itself, Unit::m, 0, 5, 0)};
inline constexpr double default_vertices[] = {0, 0, 0.25, 0, 0.25, 0.16, 0, 0.16};
inline constexpr Key object_keys[] = {
    detail::contact_key("contacts[0]", 0),
    detail::contact_key("contacts[1]", 1),
    source_number("com_m[0]", Unit::m, -10, 10, 0.125),
    source_number("com_m[1]", Unit::m, -10, 10, 0.04),
    source_number("mass_kg", Unit::kg, 0.001, 1000, 0.5),
    source_number("depth_m", Unit::m, 0.001, 10, 0.1),
    derived<&ObjectSpec::width>(),
    derived<&ObjectSpec::com_left>(),
    derived<&ObjectSpec::com_right>(),
    derived<&ObjectSpec::com_height>(),
    detail::contact_right_key(),
};
inline constexpr RecordList object_lists[] = {
    {
        "vertices_m",
        "outline",
        max_outline,
        vertex_keys,
        default_vertices,
        [](const void* object) { return static_cast<const ObjectSpec*>(object)->outline.count; },
        [](void* object, std::size_t n) { static_cast<ObjectSpec*>(object)->outline.count = n; },
        [](void* object, std::size_t k) -> void* {
          return &static_cast<ObjectSpec*>(object)->outline.vertices[k];
        },
    },
    source_list("edge_radius_m", max_outline, edge_radius_keys),
};

struct StartSpec {
  double start[2]{};  // contact coordinates
};

namespace detail {

template <std::size_t Side>
constexpr Key start_key(std::string_view name) {
  Key key = source_number(name, Unit::m, -10, 10, 0);
  key.member = "start";
  key.get = [](const void* start) { return static_cast<const StartSpec*>(start)->start[Side]; };
  key.put = [](void* start, double p) { static_cast<StartSpec*>(start)->start[Side] = p; };
  return key;
}

}  // namespace detail

inline constexpr Key start_keys[] = {
    detail::start_key<left>("left_m"),
    detail::start_key<right>("right_m"),
};

// A wall (mechanics/surface.hpp). Places count from the COM of the object at its start.
struct WallSpec {
  double at = 0.0;  // x; in a scene in the direction of travel
  double height = std::numeric_limits<double>::infinity();  // infinite: no upper edge
  double friction = -1.0;                                   // negative: that of the floor
};
inline constexpr Key wall_keys[] = {
    number<&WallSpec::at>("at_m", Unit::m, -10, 10),
    number<&WallSpec::height>("height_m", Unit::m, 0.001, 10),
    number<&WallSpec::friction>("friction", Unit::none, 0, 5),
};

// A block on the floor, from x to x. With a gap it consists of two halves beside the path of the
// robots.
struct StandSpec {
  double from = 0.0;
  double to = 0.0;
  double height = 0.001;
  double friction = -1.0;  // negative: that of the floor
  double gap = -1.0;       // between the halves, across the path; negative: none
};
inline constexpr Key stand_keys[] = {
    number<&StandSpec::from>("from_m", Unit::m, -10, 10),
    number<&StandSpec::to>("to_m", Unit::m, -10, 10),
    number<&StandSpec::height>("height_m", Unit::m, 0.001, 10),
    number<&StandSpec::friction>("friction", Unit::none, 0, 5),
    number<&StandSpec::gap>("gap_m", Unit::m, 0.001, 10),
};

// What stands still around object and palms.
struct FloorSpec {
  double floor_friction = 0.3;  // between object and floor
  std::array<WallSpec, 2> walls{};
  std::size_t wall_count = 0;
  std::array<StandSpec, 2> stands{};
  std::size_t stand_count = 0;
};
inline constexpr Key floor_keys[] = {
    number<&FloorSpec::floor_friction>("friction", Unit::none, 0, 5),
};
inline constexpr RecordList floor_lists[] = {
    records<&FloorSpec::walls, &FloorSpec::wall_count>("walls", wall_keys),
    records<&FloorSpec::stands, &FloorSpec::stand_count>("stands", stand_keys),
};

// Which motion follows an event after which mechanics permit several.
enum class Ambiguity : std::uint8_t { rule, drawn };

struct WorldSpec {
  Ambiguity ambiguity = Ambiguity::rule;
  double fall = 0.003;  // of a contact vertex in a job on the floor, at most [m]
};
inline constexpr Choices ambiguity_choices(0, "rule", "drawn");
inline constexpr Key world_keys[] = {
    choice<&WorldSpec::ambiguity>("ambiguity", ambiguity_choices),
    number<&WorldSpec::fall>("fall_m", Unit::m, 0, 1),
};

// What an object stands on before a job, or after it.
enum class StandsOn : std::uint8_t { palms, floor, stand };

// Which robots drive at first to get under an object on the floor: both, or the one that leads. Or that
// one does the whole job alone, against a wall. Or the one that follows hands the object to it.
enum class Docking : std::uint8_t { together, one_first, alone, hand_over };

struct TaskSpec {
  StandsOn begins_on = StandsOn::palms;
  StandsOn ends_on = StandsOn::palms;
  Docking docking = Docking::together;
  double distance = 1.5;
  double slope = 0;           // specific force towards −x
  bool inertia = true;        // false: accelerations have no effect, as the paper assumes
  double inertia_lag = 0.05;  // time constant of their average
  double direction = 1;       // +1: the right robot leads, −1: the left one
  std::uint64_t timeout_ticks = 5000;
  double safe_reach = -1;  // see ModelParams; −1: unknown
};
inline constexpr Choices direction_choices(0, "forward", "backward");
inline constexpr Choices support_choices(0, "palms", "floor", "stand");
inline constexpr Choices docking_choices(0, "together", "one-first", "alone", "hand-over");
inline constexpr Key task_keys[] = {
    choice<&TaskSpec::begins_on>("from", support_choices),
    choice<&TaskSpec::ends_on>("to", support_choices),
    choice<&TaskSpec::docking>("dock", docking_choices),
    number<&TaskSpec::distance>("distance_m", Unit::m, 0.001, 10000),
    between(source_number("slope_deg", Unit::degrees, -80, 80, 0)),
    source_number("timeout_s", Unit::s, 0.001, 1e6),
    source_choice("direction", direction_choices, 0),
    flag<&TaskSpec::inertia>("inertia"),
    number<&TaskSpec::inertia_lag>("inertia_tau_s", Unit::s, 0, 1000),
    derived<&TaskSpec::slope>(),
    derived<&TaskSpec::direction>(),
    derived<&TaskSpec::timeout_ticks>(),
    derived<&TaskSpec::safe_reach>(),
};

}  // namespace palmbots

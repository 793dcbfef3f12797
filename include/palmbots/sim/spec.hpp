// SPDX-License-Identifier: Apache-2.0
// The specification of a carry: everything that defines it, as plain numbers in SI units and
// radians, left and right resolved.
//
// Numbers are double here whatever the precision of the carry. A scene becomes a spec by
// sim/spec_of_scene.hpp, which also fills in what follows from the scene.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/sim/disturbance_keys.hpp"
#include "palmbots/sim/radio_keys.hpp"
#include "palmbots/sim/robot_keys.hpp"
#include "palmbots/sim/scene_key.hpp"
#include "palmbots/sim/task_keys.hpp"

namespace palmbots {

// The complete specification of one carry: the sections of a scene, one after the other.
struct Spec : ObjectSpec,
              TactileSpec,
              ControlSpec,
              RadioSpec,
              FaultsSpec,
              BumpsSpec,
              StartSpec,
              FloorSpec,
              WorldSpec,
              TaskSpec {
  PalmSpec palms[2]{};
  RobotSpec robots[2]{};
  ArmSpec arms[2]{};
  DirectionSpec directions[3]{};  // from the left robot, the right one, the station

  // The longest delay of any link [s].
  constexpr double longest_delay() const {
    double longest = 0;
    for (const DirectionSpec& d : directions) {
      const double delay =
          (d.latency < 0 ? latency : d.latency) + (d.jitter < 0 ? jitter : d.jitter);
      longest = delay > longest ? delay : longest;
    }
    return longest;
  }

  // The control period of the robot with the longer one [s].
  constexpr double longest_period() const {
    const std::uint64_t one = robots[0].stride;
    const std::uint64_t two = robots[1].stride;
    return period * static_cast<double>(one < two ? two : one);
  }
};

// Whether the job begins or ends on the floor or on a stand; otherwise the object is on the palms all
// the time.
inline bool uses_floor(const Spec& spec) {
  return spec.begins_on != StandsOn::palms || spec.ends_on != StandsOn::palms;
}

// The side of the robot that leads, that is the front one in the direction of travel.
inline std::size_t leader_of(const Spec& spec) { return spec.direction > 0 ? right : left; }

// True if a palm may go limp. Carries side by side (batch/lane_carries.hpp) do not provide for that.
inline bool may_go_limp(const Spec& spec) {
  for (std::size_t i = 0; i < spec.fault_count; ++i) {
    if ((spec.faults[i].marks & palm_goes_limp) != 0) return true;
  }
  return false;
}

// Whose values the keys of a section are.
enum class Holders : std::uint8_t {
  one,      // the pair's
  sides,    // of both robots, unless a table of one side overrides them
  senders,  // of one sender; keys of the same names in another section are those of all
};

// A section of a scene: its keys and lists, and the structures of a spec that hold them.
struct Section {
  std::string_view name;
  Holders holders = Holders::one;
  std::span<const Key> keys;
  std::span<const RecordList> lists;
  void* (*at)(Spec&, std::size_t holder) = nullptr;

  constexpr std::size_t holder_count() const {
    return holders == Holders::one ? 1 : holders == Holders::sides ? 2 : 3;
  }
};

namespace detail {

template <class Part>
constexpr Section section(std::string_view name, std::span<const Key> keys,
                          std::span<const RecordList> lists = {}) {
  return {name, Holders::one, keys, lists,
          [](Spec& spec, std::size_t) -> void* { return static_cast<Part*>(&spec); }};
}
template <auto Member>
constexpr Section section_of_holders(std::string_view name, Holders holders,
                                     std::span<const Key> keys) {
  return {name, holders, keys, {}, [](Spec& spec, std::size_t holder) -> void* {
            return &(spec.*Member)[holder];
          }};
}

}  // namespace detail

// The table of scene keys.
inline constexpr Section sections[] = {
    detail::section<ObjectSpec>("object", object_keys, object_lists),
    detail::section_of_holders<&Spec::palms>("palm", Holders::sides, palm_keys),
    detail::section_of_holders<&Spec::robots>("robot", Holders::sides, robot_keys),
    detail::section_of_holders<&Spec::arms>("arm", Holders::sides, arm_keys),
    detail::section<TactileSpec>("tactile", tactile_keys, tactile_lists),
    detail::section<ControlSpec>("control", control_keys),
    detail::section<RadioSpec>("radio", radio_keys, radio_lists),
    detail::section_of_holders<&Spec::directions>("radio", Holders::senders, direction_keys),
    detail::section<FaultsSpec>("faults", faults_keys, faults_lists),
    detail::section<BumpsSpec>("bumps", bumps_keys, bumps_lists),
    detail::section<StartSpec>("start", start_keys),
    detail::section<FloorSpec>("floor", floor_keys, floor_lists),
    detail::section<WorldSpec>("world", world_keys),
    detail::section<TaskSpec>("task", task_keys),
};

}  // namespace palmbots

// SPDX-License-Identifier: Apache-2.0
// What the nine switches of a palm say: seven along it feel the object, two feel where the palm is.
//
// A switch counts as closed or open when it has been read so for `debounce` ticks in a row. Switches
// that contradict each other are a fault, and so is a palm that reaches neither end in time. A palm
// that is not plugged in closes no switch, so it shows as such a palm.
#pragma once

#include <cstddef>
#include <cstdint>

#include "board_fault.hpp"
#include "palmbots/control/messages.hpp"
#include "settings.hpp"

namespace palmbots::app {

class PalmSwitches {
 public:
  explicit PalmSwitches(const Settings& settings) : settings_(settings) {}

  // Once per tick: the closed switches, and the palm's commanded angle.
  void read(std::uint16_t closed, Palm commanded, std::uint16_t elapsed) {
    debounce(closed);
    found_ = 0;
    for (std::size_t i = 0; i < switch_count; ++i) {
      if ((closed_ >> i & 1) != 0) found_ |= bit(static_cast<SwitchMeaning>(settings_.switches[i]));
    }
    commanded_ = commanded;
    const auto count = [elapsed](std::uint32_t& time, bool goes_on) {
      time = !goes_on ? 0 : time < 0xFFFF0000 ? time + elapsed : time;
    };
    count(contradictory_, contradicts());
    count(on_the_way_, !at_target() && commanded == before_);
    before_ = commanded;
  }

  Sign sign() const {
    if (has(SwitchMeaning::zero) || has(SwitchMeaning::minus) == has(SwitchMeaning::plus)) {
      return Sign::zero;
    }
    return has(SwitchMeaning::minus) ? Sign::negative : Sign::positive;
  }
  bool at_goal() const { return has(SwitchMeaning::goal); }
  bool is_beneath() const { return has(SwitchMeaning::beneath); }
  bool has_contact() const {
    return has(SwitchMeaning::minus) || has(SwitchMeaning::zero) || has(SwitchMeaning::plus);
  }
  // The palm is at the commanded end, and not at the other one.
  bool at_target() const {
    const bool is_steep = has(SwitchMeaning::steep_end);
    const bool is_shallow = has(SwitchMeaning::shallow_end);
    return commanded_ == Palm::steep ? is_steep && !is_shallow : is_shallow && !is_steep;
  }
  BoardFault fault() const {
    if (contradictory_ > most_contradictory) return BoardFault::switches;
    return on_the_way_ > settings_.turn_limit ? BoardFault::palm : BoardFault::none;
  }

 private:
  static constexpr std::size_t switch_count = 9;
  // Neighbours may both be closed for a moment, and a switch may bounce.
  static constexpr std::uint32_t most_contradictory = 5;  // [ticks]

  static constexpr unsigned bit(SwitchMeaning m) { return 1U << static_cast<unsigned>(m); }
  bool has(SwitchMeaning m) const { return (found_ & bit(m)) != 0; }
  bool contradicts() const {
    return (has(SwitchMeaning::minus) && has(SwitchMeaning::plus)) ||
           (has(SwitchMeaning::steep_end) && has(SwitchMeaning::shallow_end));
  }

  void debounce(std::uint16_t closed) {
    for (std::size_t i = 0; i < switch_count; ++i) {
      const auto mask = static_cast<std::uint16_t>(1U << i);
      if (((closed ^ closed_) & mask) == 0) {
        seen_[i] = 0;
      } else if (++seen_[i] >= settings_.debounce) {
        closed_ = static_cast<std::uint16_t>(closed_ ^ mask);
        seen_[i] = 0;
      }
    }
  }

  const Settings& settings_;
  std::uint16_t closed_ = 0;
  std::uint8_t seen_[switch_count]{};  // readings in a row that differ from `closed_`
  unsigned found_ = 0;                 // the meanings of the closed switches
  Palm commanded_ = Palm::steep;
  Palm before_ = Palm::steep;
  std::uint32_t contradictory_ = 0;  // [ticks]
  std::uint32_t on_the_way_ = 0;     // since the command, or since the palm left its end [ticks]
};

}  // namespace palmbots::app

// SPDX-License-Identifier: Apache-2.0
// Notices that a board hears only packets that are not for it: of another pair, or with another key.
#pragma once

#include <cstdint>

#include "palmbots/wire/endpoint.hpp"

namespace palmbots::app {

class Strangers {
 public:
  // Once per tick. `lease` is how long news counts [ticks].
  void count(const wire::Endpoint& endpoint, std::uint16_t elapsed, std::uint32_t lease) {
    using wire::Verdict;
    const std::uint32_t own = endpoint.count(Verdict::accepted) +
                              endpoint.count(Verdict::no_session) + endpoint.count(Verdict::stale);
    const std::uint32_t others = endpoint.count(Verdict::wrong_pair) +
                                 endpoint.count(Verdict::bad_tag) +
                                 endpoint.count(Verdict::wrong_version);
    const auto age = [&](std::uint32_t& time, bool has_come) {
      time = has_come ? 0 : time < 0xFFFF0000 ? time + elapsed : time;
    };
    age(since_own_, own != own_);
    age(since_others_, others != others_);
    own_ = own;
    others_ = others;
    limit_ = 4 * lease;
  }
  bool are_all_there_is() const { return since_own_ > limit_ && since_others_ <= limit_; }

 private:
  std::uint32_t own_ = 0, others_ = 0;
  std::uint32_t since_own_ = 0;  // [ticks]
  std::uint32_t since_others_ = 0xFFFF0000;
  std::uint32_t limit_ = 0;
};

}  // namespace palmbots::app

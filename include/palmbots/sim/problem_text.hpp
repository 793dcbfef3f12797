// SPDX-License-Identifier: Apache-2.0
// The words for a problem of a scene, which the command line, Python and the page share.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/scene_key.hpp"
#include "palmbots/sim/scene_problem.hpp"
#include "palmbots/sim/scene_values.hpp"

namespace palmbots {

// The key as a scene file spells it: "palm.left.friction"; in a list, with the index of the record:
// "radio.outages[2].end_s".
inline std::string key_text(const Problem& problem) {
  const std::string name(problem.key);
  if (const std::size_t bracket = name.find("[]"); bracket != name.npos) {
    return name.substr(0, bracket + 1) + std::to_string(problem.place) + name.substr(bracket + 1);
  }
  if (problem.place == common) return name;
  const std::size_t dot = name.find('.') + 1;
  return name.substr(0, dot) + std::string(sender_choices.names[problem.place - 1]) + "." +
         name.substr(dot);
}

// The text of a problem, with its numbers in place of {0}, {1}, …
inline std::string filled_in(std::string_view text, const Numbers& numbers) {
  std::string filled;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '{') {
      filled += text[i];
      continue;
    }
    filled += short_text(numbers.values[std::size_t(text[i + 1] - '0')]);
    i += 2;
  }
  return filled;
}

}  // namespace palmbots

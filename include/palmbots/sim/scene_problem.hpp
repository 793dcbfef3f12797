// SPDX-License-Identifier: Apache-2.0
// A relation between keys that does not hold. A host makes a line for a person of it: "KEY: VALUE
// PROBLEM; allowed: ALLOWED".
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <span>
#include <string_view>
#include <vector>

namespace palmbots {

// A few numbers.
struct Numbers {
  std::array<double, 4> values{};
  std::size_t count = 0;

  Numbers() = default;
  Numbers(std::initializer_list<double> given) : count(given.size()) {
    std::copy(given.begin(), given.end(), values.begin());
  }
  std::span<const double> all() const { return {values.data(), count}; }
};

struct Problem {
  std::string_view key;  // to blame, by its name and place as in SceneValues
  std::size_t place = 0;
  std::string_view problem;  // with {0}, {1} … in place of the numbers
  std::string_view allowed;  // the same
  Numbers numbers{};
  Numbers value{};  // to show; none: the value of the key
};

using Problems = std::vector<Problem>;

[[gnu::noinline]] inline void report(Problems& problems, const char* key, std::size_t place,
                                     const char* problem, const char* allowed,
                                     std::initializer_list<double> numbers = {},
                                     std::initializer_list<double> value = {}) {
  problems.push_back({key, place, problem, allowed, Numbers(numbers), Numbers(value)});
}

}  // namespace palmbots

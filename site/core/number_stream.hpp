// SPDX-License-Identifier: Apache-2.0
// The numbers that the page hands to the core, read one after the other.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palmbots::page {

// A reader of the input buffer. Lists begin with their length, which is cut to what there is room
// for.
class NumberStream {
 public:
  explicit NumberStream(const double* at) : at_(at) {}

  double next() { return *at_++; }
  std::uint32_t whole() { return static_cast<std::uint32_t>(next()); }
  std::size_t count(std::size_t most) {
    const double n = next();
    return n < double(most) ? static_cast<std::size_t>(n) : most;
  }

 private:
  const double* at_;
};

}  // namespace palmbots::page

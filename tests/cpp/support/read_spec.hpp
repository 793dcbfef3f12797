// SPDX-License-Identifier: Apache-2.0
// A Spec from standard input, as Spec.to_bytes writes it in Python.
#pragma once

#include <cstdio>
#include <optional>
#include <vector>

#include "palmbots/sim/spec_bytes.hpp"

inline std::optional<palmbots::Spec> read_spec() {
  std::vector<std::byte> bytes(1 << 16);
  bytes.resize(std::fread(bytes.data(), 1, bytes.size(), stdin));
  std::span<const std::byte> rest(bytes);
  return palmbots::take_spec(rest);
}

// SPDX-License-Identifier: Apache-2.0
// A scene of the page: its values as given, the Spec to carry, and what there is to say about both.
#pragma once

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "number_stream.hpp"
#include "palmbots/runtime/controller_registry.hpp"
#include "palmbots/sim/carry_warnings.hpp"
#include "palmbots/sim/scene_problem.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots::page {

// Longest carry that the page records [ticks]: twenty minutes at the default period. The page refuses
// a scene with a longer time limit, so that no carry is cut.
inline constexpr double most_ticks = 120000;

struct PageScene {
  Problems problems;
  Spec spec;
  std::vector<double> object;          // contacts, centre of mass and vertices [m]
  std::string refusal;                 // why no carry can begin, though nothing is wrong
  std::vector<std::string> warnings;   // about the object
  std::vector<std::string> of_limits;  // about numbers that exceed what the analysis allows
  double timeout = 0;  // time limit of a carry [s], which may exceed what the page records

  double longest_timeout() const { return most_ticks * spec.period; }
  bool is_too_long() const { return !(std::nearbyint(timeout / spec.period) <= most_ticks); }
};

// Reads the values that site/src/shared/scene_values.ts writes. Each value has a line of text in
// `lines` and two numbers in `in`: its place and the value. The line is the name of a key, followed
// by `=WORD` if the value is a word. A name that ends with # begins a list; its value is the number
// of records.
PageScene read_scene(std::string_view lines, NumberStream in);

// The lines about a problem: its key, what is wrong and what is allowed.
std::string problem_lines(const Problem& problem);

// The lines with the warnings that are known before a carry, and after it.
std::string warning_lines(const PageScene& scene, const ControllerInfo& controller);
std::string warning_lines(const Spec& spec, const CarryEnd& end, bool stops_in_silence);

}  // namespace palmbots::page

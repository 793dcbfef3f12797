// SPDX-License-Identifier: Apache-2.0
// Apart from core.cpp, because it runs once for each scene or carry and is compiled to be small.
#include "page_scene.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "palmbots/sim/limit_warnings.hpp"
#include "palmbots/sim/problem_text.hpp"
#include "palmbots/sim/scene_check.hpp"
#include "palmbots/sim/scene_object.hpp"
#include "palmbots/sim/scene_values.hpp"
#include "palmbots/sim/scene_warnings.hpp"
#include "palmbots/sim/spec_of_scene.hpp"
#include "palmbots/sim/start_refusal.hpp"

namespace palmbots::page {

namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text.append(line).append("\n");
  return text;
}

}  // namespace

PageScene read_scene(std::string_view lines, NumberStream in) {
  SceneValues values;
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    const std::string_view line = lines.substr(0, end);
    lines.remove_prefix(end == lines.npos ? lines.size() : end + 1);
    const std::size_t place = in.whole();
    const double value = in.next();
    const std::size_t equals = line.find('=');
    if (equals != line.npos) {
      values.set(line.substr(0, equals), place, line.substr(equals + 1));
    } else if (line.ends_with('#')) {
      values.begin_list(line.substr(0, line.size() - 1), static_cast<std::size_t>(value));
    } else {
      values.set(line, place, value);
    }
  }
  PageScene scene;
  scene.problems = check(values);
  scene.spec = spec_of(values);
  const SceneObject object = object_of(values);
  scene.object = {double(object.contacts[left]), double(object.contacts[right]), object.com.x,
                  object.com.y};
  for (const Point& vertex : object.vertices) {
    scene.object.insert(scene.object.end(), {vertex.x, vertex.y});
  }
  if (scene.problems.empty()) {
    scene.refusal = load_refusal(values, scene.spec, false);
    if (scene.refusal.empty()) scene.refusal = palm_refusal(scene.spec);
    scene.warnings = value_warnings(values);
    scene.of_limits = limit_warnings(values, scene.spec);
  }
  scene.timeout = time_limit_of(values);
  scene.spec.timeout_ticks =
      std::min(scene.spec.timeout_ticks, static_cast<std::uint64_t>(most_ticks));
  return scene;
}

std::string problem_lines(const Problem& problem) {
  return joined({key_text(problem), filled_in(problem.problem, problem.numbers),
                 filled_in(problem.allowed, problem.numbers)});
}

std::string warning_lines(const PageScene& scene, const ControllerInfo& controller) {
  std::vector<std::string> lines = warnings_before(scene.spec, controller, scene.warnings);
  // The analysis is about corrections.
  if (controller.decider != Decider::none) {
    lines.insert(lines.end(), scene.of_limits.begin(), scene.of_limits.end());
  }
  return joined(lines);
}

std::string warning_lines(const Spec& spec, const CarryEnd& end, bool stops_in_silence) {
  return joined(warnings_after(spec, end, stops_in_silence));
}

}  // namespace palmbots::page

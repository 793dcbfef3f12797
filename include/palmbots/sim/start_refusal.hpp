// SPDX-License-Identifier: Apache-2.0
// Why no carry can begin with these palms and contacts: one sentence, for the command line, Python and
// the page.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "palmbots/base/number_text.hpp"
#include "palmbots/sim/build.hpp"
#include "palmbots/sim/problem_text.hpp"
#include "palmbots/sim/standing_start.hpp"
#include "palmbots/world/quasistatic_world.hpp"

namespace palmbots {

// Overlap of the palms at the start, both steep [m]; negative: the gap between them. A palm extends
// inward from its contact by half its length plus the contact coordinate p.
inline double palm_overlap_of(const Spec& spec) {
  double reach = 0;
  PerSide<double> rise{};
  const PerSide<double> radius = contact_radii(spec.outline);
  for (const std::size_t side : {left, right}) {
    const PalmSpec& palm = spec.palms[side];
    const double p = spec.start[side];
    const SinCos<double> steep = sin_cos(palm.steep);
    reach += (p + 0.5 * palm.length) * steep.cos - radius[side] * steep.sin;
    rise[side] = p * steep.sin + (palm.offset + radius[side]) * steep.cos;
  }
  const double z = rise[right] - rise[left];
  return reach - std::sqrt(std::max(spec.width * spec.width - z * z, 0.0));
}

// A corner of the object, or a point of its arc, that is in a palm.
struct BuriedCorner {
  double depth;  // [m]
  double along;  // from the contact, along the palm, outward [m]
  std::size_t side;
};

// The corner that is deepest in a palm at the start, by more than a thousandth of the object's size.
inline std::optional<BuriedCorner> buried_corner_of(const Spec& spec) {
  const Model<double> model = model_of<double>(spec);
  const World<double> world(model, configuration_of(spec, model));
  const Pose pose = world.pose();
  double most = 1e-3 * world.shapes().size;
  std::optional<BuriedCorner> deepest;
  for (const std::size_t side : {left, right}) {
    const double angle = spec.palms[side].steep;
    const Carrier palm = side == left ? Carrier::left_palm : Carrier::right_palm;
    Travel still{};
    still.palms[side] = {world.pivot(side), {}, angle, 0.0, angle};
    const Frame frame = still.frame(palm, 0.0);
    each_drawn_point(world.shapes().body, [&](std::size_t, Vec point) {
      const Vec seen = frame.from_world(pose.at + pose.to_world(point) - frame.origin);
      const double depth = spec.palms[side].offset - seen.y;
      if (std::abs(seen.x) > 0.5 * spec.palms[side].length || depth <= most) return;
      most = depth;
      deepest = {depth, seen.x - spec.start[side], side};
    });
  }
  return deepest;
}

// A palm with a heel that lies in the object at the start, by more than a thousandth of its size.
inline std::optional<std::size_t> pierced_by_heel(const Spec& spec) {
  const Model<double> model = model_of<double>(spec);
  const World<double> world(model, configuration_of(spec, model));
  const auto side = world.pierced_palm(1e-3 * world.shapes().size);
  return side && spec.palms[*side].heel > 0 ? side : std::nullopt;
}

// Why no carry can begin with these palms; empty: it can. No world models that they touch each other,
// which they do not where one palm at a time holds the object.
inline std::string palm_refusal(const Spec& spec) {
  if (is_alone(spec) || hands_over(spec)) return "";
  if (const auto buried = buried_corner_of(spec)) {
    return sentence(
        "object.contacts: at the start, the {} palm would lie in the object, by {} at the corner "
        "{} {} of the contact; allowed: the corners that the palms touch, or palms that are less "
        "steep",
        {buried->side == left ? "left" : "right", millimetres(buried->depth),
         millimetres(std::abs(buried->along)), buried->along > 0 ? "outward" : "inward"});
  }
  if (const auto side = pierced_by_heel(spec)) {
    const std::string name = *side == left ? "left" : "right";
    return sentence(
        "palm.heel_m: at the start, the {} palm with its heel of {} would lie in the object; "
        "allowed: a lower heel, a longer palm, or start.{}_m farther inward",
        {name, millimetres(spec.palms[*side].heel), name});
  }
  const double overlap = palm_overlap_of(spec);
  if (!(overlap > 0)) return "";
  const double level = sin_cos(spec.palms[left].steep).cos + sin_cos(spec.palms[right].steep).cos;
  const double shorter = std::ceil(1e3 * overlap / (0.5 * level)) / 1e3;
  return sentence(
      "palm.length_m: the palms would collide under the object, where they overlap by {} at the "
      "start; allowed: palms that are {} m shorter, or a wider object",
      {millimetres(overlap), short_text(shorter)});
}

}  // namespace palmbots

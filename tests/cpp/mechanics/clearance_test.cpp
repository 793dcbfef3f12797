// SPDX-License-Identifier: Apache-2.0
// What a palm touches besides its contact vertex, for random outlines: against winding numbers.
#include "palmbots/mechanics/clearance.hpp"

#include "support/check.hpp"
#include "support/random_outline.hpp"

namespace {

using namespace palmbots;
using outlines::Object;
using outlines::Polygon;

constexpr double unclear = 1e-6;  // [m] what lies nearer to the palm's line may round either way

PalmFrameVector<double> vector_of(const Object& object, double angle) {
  return {object.width * std::cos(angle), object.width * std::sin(angle)};
}

// The clear cone contains a palm's direction if all other vertices lie above the palm's line, which
// passes below the centre of the arc if the contact vertex is rounded.
void clear_cone_against_every_vertex() {
  std::mt19937 chance(1);
  int clear = 0;
  for (int again = 0; again < 20'000; ++again) {
    const Object object = outlines::random_object(chance);
    Outline<double> outline = outlines::outline_of<double>(object);
    const double angle = outlines::between(chance, -3.1, 3.1);
    const std::size_t side = chance() % 2;
    const double radius = again % 2 == 0 ? 0.0 : outlines::between(chance, 0.0, 0.1);
    outline.vertices[outline.contact[side]].radius = radius;
    const Polygon seen = outlines::seen_from(object, side, angle);
    double lowest = 1e9;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (i != outline.contact[side]) lowest = std::min(lowest, seen[i].y);
    }
    if (std::abs(lowest + radius) < unclear || std::abs(std::cos(angle)) < 1e-3) continue;
    const bool wanted = std::cos(angle) > 0 && lowest > -radius;
    CHECK(clear_cone(outline, side).contains(vector_of(object, angle)) == wanted);
    clear += wanted;
  }
  CHECK(clear > 2000);
}

// A palm touches if a piece of it lies inside the object. It is a tip contact if only an end does,
// without a vertex on the plate. A palm that went through a corner and out again is left out: it has
// touched before.
void further_contact_against_winding_numbers() {
  std::mt19937 chance(2);
  int counts[4]{};
  for (int again = 0; again < 4000; ++again) {
    const Object object = outlines::random_object(chance);
    const double angle = outlines::between(chance, -0.6, 0.6);
    const double half = outlines::between(chance, 0.02, 0.3);
    const double contact = outlines::between(chance, -half, half);
    const std::size_t side = chance() % 2;
    const Outline<double> outline = outlines::outline_of<double>(object);
    const Polygon seen = outlines::seen_from(object, side, angle);
    const double from = contact - half;
    const double to = contact + half;
    bool is_clear_case = true;
    bool has_vertex_below = false;
    bool has_vertex_on_plate = false;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      if (i == outline.contact[side]) continue;
      is_clear_case = is_clear_case && std::abs(seen[i].y) > unclear &&
                      std::abs(seen[i].x - from) > unclear && std::abs(seen[i].x - to) > unclear;
      const bool is_below = seen[i].y < 0;
      has_vertex_below = has_vertex_below || is_below;
      has_vertex_on_plate = has_vertex_on_plate || (is_below && seen[i].x > from && seen[i].x < to);
    }
    const bool end_is_in =
        outlines::is_inside(seen, {from, 0}) || outlines::is_inside(seen, {to, 0});
    if (!is_clear_case) continue;
    const ContactKind found =
        further_contact(outline, side, vector_of(object, angle), object.width, contact, half);
    ++counts[static_cast<int>(found)];
    if (has_vertex_on_plate) CHECK(found == ContactKind::flush);
    if (end_is_in) CHECK(found != ContactKind::none);
    if (found == ContactKind::flush) CHECK(has_vertex_below);
    if (found == ContactKind::tip) CHECK(end_is_in);
    if (!has_vertex_below) CHECK(found == ContactKind::none);
  }
  CHECK(counts[0] > 300 && counts[static_cast<int>(ContactKind::flush)] > 300);
  CHECK(counts[static_cast<int>(ContactKind::tip)] > 20);
}

}  // namespace

int main() {
  clear_cone_against_every_vertex();
  further_contact_against_winding_numbers();
}

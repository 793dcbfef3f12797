// SPDX-License-Identifier: Apache-2.0
// Row policy: a program of the station that is a table with one row for each pair of contact signs.
//
// A row gives the angles of both palms and what each robot's wheels do, as in a policy file
// (docs/theory/derivation.md). The station commands the row of the newest signs. As in Table 1 the
// palms come first: the robots drive once both have reported that their palms are at the row's
// angles.
#pragma once

#include <array>
#include <cstdint>

#include "palmbots/control/centralized.hpp"

namespace palmbots {

// The station's program. Pairs are (left, right).
class RowPolicy {
 public:
  static constexpr bool half_moves = false;  // a row states what each robot drives

  struct Row {
    Palm palms[2];
    Move drives[2];

    constexpr bool operator==(const Row&) const = default;
  };
  static constexpr int row_count = 9;
  // In the order (+, +), (+, 0), (+, −), (0, +), …, (−, −).
  using Rows = std::array<Row, row_count>;

  RowPolicy() = default;
  explicit RowPolicy(const Rows& rows) : rows_(rows) {}

  static constexpr std::uint8_t row_of(Sign l, Sign r) {
    return static_cast<std::uint8_t>(3 * (1 - static_cast<int>(l)) + (1 - static_cast<int>(r)));
  }
  static constexpr std::uint8_t centred = 4;  // the row (0, 0)

  // One tick with the newest reports. Do not call it before both robots have reported.
  Centralized::Output step(const Centralized::Report (&in)[2]) {
    now_ = row_of(in[0].sign, in[1].sign);
    const Row& row = rows_[now_];
    bool turned = true;
    for (int i = 0; i < 2; ++i) {
      turned = turned && in[i].palm == row.palms[i] && in[i].palm_at_target;
    }
    const auto command = [&](int i) {
      return Command{row.palms[i], turned ? row.drives[i] : Move::hold};
    };
    return {{command(0), command(1)}};
  }

  // The number of the row in force, from 1; 0 if both contacts are centred.
  int current() const { return now_ == centred ? 0 : now_ + 1; }

  // The sign of a contact in the row in force.
  int sense(int contact) const { return 1 - (contact == 0 ? now_ / 3 : now_ % 3); }

  constexpr bool operator==(const RowPolicy&) const = default;

 private:
  Rows rows_{};
  std::uint8_t now_ = centred;
};

static_assert(RowPolicy::row_of(Sign::zero, Sign::zero) == RowPolicy::centred);

}  // namespace palmbots

// SPDX-License-Identifier: Apache-2.0
// Linear systems of few equations for as many unknowns.
#pragma once

#include <array>
#include <cstddef>

#include "palmbots/base/scalar.hpp"

namespace palmbots {

// Equations row · x = value in echelon form. add() skips an equation that depends on those before
// it and returns false.
template <class Real, std::size_t n = 4>
class EchelonForm {
 public:
  using Row = std::array<Real, n>;

  constexpr bool add(Row row, Real value) {
    if (full()) return false;
    const Real scale = largest(row);
    for (std::size_t k = 0; k < count_; ++k) {
      if (row[pivots_[k]] == Real(0)) continue;
      const Real factor = row[pivots_[k]] / rows_[k][pivots_[k]];
      for (std::size_t c = 0; c < n; ++c) row[c] -= factor * rows_[k][c];
      row[pivots_[k]] = Real(0);
      value -= factor * values_[k];
    }
    std::size_t pivot = 0;
    for (std::size_t c = 1; c < n; ++c)
      pivot = magnitude(row[c]) > magnitude(row[pivot]) ? c : pivot;
    if (!(magnitude(row[pivot]) > dependent * scale)) return false;
    rows_[count_] = row;
    values_[count_] = value;
    pivots_[count_++] = pivot;
    return true;
  }
  constexpr bool full() const { return count_ == n; }

  constexpr Row solution() const {
    Row x{};
    for (std::size_t k = count_; k-- > 0;) {
      Real rest = values_[k];
      for (std::size_t c = 0; c < n; ++c) {
        if (c != pivots_[k]) rest -= rows_[k][c] * x[c];
      }
      x[pivots_[k]] = rest / rows_[k][pivots_[k]];
    }
    return x;
  }

  static constexpr Real dependent = sizeof(Real) == 8 ? Real(1e-10) : Real(1e-5);

  static constexpr Real largest(const Row& row) {
    Real most = Real(0);
    for (const Real x : row) most = magnitude(x) > most ? magnitude(x) : most;
    return most;
  }

 private:
  std::array<Row, n> rows_{};
  std::array<Real, n> values_{};
  std::array<std::size_t, n> pivots_{};
  std::size_t count_ = 0;
};

}  // namespace palmbots

// SPDX-License-Identifier: Apache-2.0
// What is new: the order of stamps, and what a window takes.
#include "palmbots/wire/replay_window.hpp"

#include <cstdint>

#include "support/check.hpp"

using palmbots::wire::ReplayWindow;
using palmbots::wire::SequenceNumber;

namespace {

void test_a_window_takes_each_stamp_once_and_only_upwards() {
  ReplayWindow window;
  CHECK(!window.accept({0, 0}));
  CHECK(window.accept({1, 1}));
  CHECK(!window.accept({1, 1}));
  CHECK(window.accept({1, 3}));
  CHECK(!window.accept({1, 2}));
  CHECK(window.accept({1, 0xFFFFFFFF}));
  CHECK(!window.accept({1, 4}));
  // A boot later the sequence starts again, and what was sent before it is over.
  CHECK(window.accept({2, 1}));
  CHECK(!window.accept({1, 0xFFFFFFFF}));
  CHECK(!window.accept({0, 0xFFFFFFFF}));
  CHECK((window.newest() == SequenceNumber{2, 1}));
}

// The definition: a number is new if it is greater than the greatest so far, epoch first.
void test_window_agrees_with_its_definition() {
  ReplayWindow window;
  std::uint64_t greatest = 0;
  std::uint32_t random = 1;
  for (int i = 0; i < 100000; ++i) {
    random = random * 1664525 + 1013904223;
    const SequenceNumber stamp{random >> 28, random >> 8 & 0xff};
    const std::uint64_t number = std::uint64_t{stamp.epoch} << 32 | stamp.sequence;
    CHECK(window.accept(stamp) == (number > greatest));
    if (number > greatest) greatest = number;
    if (i % 1000 == 0) {
      window = ReplayWindow{};
      greatest = 0;
    }
  }
}

}  // namespace

int main() {
  test_a_window_takes_each_stamp_once_and_only_upwards();
  test_window_agrees_with_its_definition();
}

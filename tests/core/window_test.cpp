// What is new: the order of stamps, and what a window takes.
#include "palmbots/window.hpp"

#include <cstdint>

#include "check.hpp"

using palmbots::wire::Stamp;
using palmbots::wire::Window;

namespace {

void test_a_window_takes_each_stamp_once_and_only_upwards() {
  Window window;
  CHECK(!window.take({0, 0}));
  CHECK(window.take({1, 1}));
  CHECK(!window.take({1, 1}));
  CHECK(window.take({1, 3}));
  CHECK(!window.take({1, 2}));
  CHECK(window.take({1, 0xFFFFFFFF}));
  CHECK(!window.take({1, 4}));
  // A boot later the sequence starts again, and what was sent before it is over.
  CHECK(window.take({2, 1}));
  CHECK(!window.take({1, 0xFFFFFFFF}));
  CHECK(!window.take({0, 0xFFFFFFFF}));
  CHECK((window.newest() == Stamp{2, 1}));
}

// Against the definition: new is what is greater than the greatest so far, epoch first.
void test_a_window_against_one_number() {
  Window window;
  std::uint64_t greatest = 0;
  std::uint32_t random = 1;
  for (int i = 0; i < 100000; ++i) {
    random = random * 1664525 + 1013904223;
    const Stamp stamp{random >> 28, random >> 8 & 0xff};
    const std::uint64_t number = std::uint64_t{stamp.epoch} << 32 | stamp.sequence;
    CHECK(window.take(stamp) == (number > greatest));
    if (number > greatest) greatest = number;
    if (i % 1000 == 0) {
      window = Window{};
      greatest = 0;
    }
  }
}

}  // namespace

int main() {
  test_a_window_takes_each_stamp_once_and_only_upwards();
  test_a_window_against_one_number();
}

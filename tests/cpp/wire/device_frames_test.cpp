// SPDX-License-Identifier: Apache-2.0
// What the frames of bridges and motor boards contain: it survives, and nothing else is taken.
#include "palmbots/wire/device_frames.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "support/check.hpp"

using namespace palmbots::wire;

namespace {

// Any bytes of this length are taken if and only if `allowed` says so, and then survive.
template <std::size_t Size, class Value, class Allowed>
void test_bytes(bool (*in)(Content, Value&), const Allowed& allowed) {
  std::mt19937 chance(4);
  std::size_t taken = 0;
  for (int again = 0; again < 20'000; ++again) {
    std::array<std::uint8_t, Size> bytes{};
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(chance() % 2 == 0 ? chance() % 8 : chance());
    }
    // As from a buffer in which more follows.
    std::array<std::uint8_t, Size + 4> buffer{};
    std::fill(std::copy(bytes.begin(), bytes.end(), buffer.begin()), buffer.end(), 0xFF);
    Value value{};
    const bool is_taken = in(Content(buffer).first(Size), value);
    CHECK(is_taken == allowed(bytes));
    CHECK(is_taken || value == Value{});
    if (is_taken) CHECK(content_of(value) == bytes);
    taken += is_taken;
  }
  CHECK(taken > 100);
  for (std::size_t size = 0; size <= max_content; ++size) {
    const std::vector<std::uint8_t> bytes(size, 1);
    Value value{};
    CHECK(in(bytes, value) == (size == Size));
  }
}

void test_numbers_are_where_the_page_says() {
  const BoardCommand command{7, true, false, 0x0102, 1000, -1000, -2};
  const std::array<std::uint8_t, 10> command_bytes{7, 1, 2, 1, 0xE8, 0x03, 0x18, 0xFC, 0xFE, 0xFF};
  CHECK(content_of(command) == command_bytes);
  const BoardReading reading{9, true, 0x0304, 0x0100, -3, -4, 0x01020304, 7400, 1};
  const std::array<std::uint8_t, 20> reading_bytes{9,    1,    4, 3, 0, 1, 0xFD, 0xFF, 0xFC, 0xFF,
                                                   0xFF, 0xFF, 4, 3, 2, 1, 0xE8, 0x1C, 1,    0};
  CHECK(content_of(reading) == reading_bytes);
  const BoardIdentity board{1, true, false, true, 9, 500};
  CHECK(content_of(board) == (std::array<std::uint8_t, 5>{1, 5, 9, 0xF4, 1}));
  const BridgeReport report{1, 2, 3, 4, 5, 0x01020304};
  const std::array<std::uint8_t, 24> report_bytes{1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0,
                                                  4, 0, 0, 0, 5, 0, 0, 0, 4, 3, 2, 1};
  CHECK(content_of(report) == report_bytes);
}

// The default values command no motion and report nothing.
void test_what_is_not_set() {
  CHECK(content_of(BoardCommand{}) == (std::array<std::uint8_t, 10>{0, 0, 1}));
  CHECK(content_of(BoardReading{}) == (std::array<std::uint8_t, 20>{}));
  CHECK(content_of(BridgeReport{}) == (std::array<std::uint8_t, 24>{}));
  CHECK(content_of(BoardIdentity{}) == (std::array<std::uint8_t, 5>{board_version}));
}

}  // namespace

int main() {
  test_what_is_not_set();
  test_numbers_are_where_the_page_says();
  test_bytes<24>(bridge_report_in, [](const auto&) { return true; });
  test_bytes<5>(board_identity_in, [](const auto& b) { return b[1] < 8 && b[2] <= 16; });
  test_bytes<10>(board_command_in, [](const auto& b) { return b[1] < 4 && b[2] + 256 * b[3] > 0; });
  test_bytes<20>(board_reading_in, [](const auto& b) { return b[1] < 2; });
}

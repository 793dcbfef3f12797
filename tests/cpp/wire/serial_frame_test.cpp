// SPDX-License-Identifier: Apache-2.0
// Frames on a serial line: every content survives, damage is noticed, and the next frame is found.
#include "palmbots/wire/serial_frame.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "support/check.hpp"
#include "support/frame_laws.hpp"

using namespace palmbots::wire;
using Stream = std::vector<std::uint8_t>;

namespace {

Stream framed(FrameKind kind, const Stream& content) {
  std::array<std::uint8_t, max_frame> bytes{};
  const std::size_t size = encode_frame(kind, content, bytes);
  CHECK(size > 0);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)};
}

// What the decoder finds, as kind and content.
std::vector<Stream> found_in(FrameDecoder& decoder, const Stream& stream) {
  std::vector<Stream> found;
  for (const std::uint8_t byte : stream) {
    if (!decoder.take(byte)) continue;
    const Frame frame = decoder.frame();
    found.push_back({frame.kind});
    found.back().insert(found.back().end(), frame.content.begin(), frame.content.end());
  }
  return found;
}

Stream random_content(std::mt19937& chance, std::size_t size) {
  Stream content(size);
  const bool many_zeros = chance() % 2 == 0;
  for (std::uint8_t& byte : content) {
    byte = many_zeros && chance() % 2 == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(chance());
  }
  return content;
}

void test_crc_has_its_published_check_value() {
  const Stream digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  CHECK(crc16(digits) == 0x29B1);
  CHECK(frame_laws::remainder_of(digits) == 0x29B1);
}

void test_every_content_survives() {
  std::mt19937 chance(1);
  FrameDecoder decoder;
  std::uint32_t frames = 0;
  for (std::size_t size = 0; size <= max_content; ++size) {
    for (int again = 0; again < 50; ++again) {
      const Stream content = random_content(chance, size);
      const Stream bytes = framed(static_cast<FrameKind>(chance() % 256), content);
      CHECK(bytes.size() == size + 5 && bytes.back() == 0);
      CHECK(std::count(bytes.begin(), bytes.end(), 0) == 1);
      const auto found = found_in(decoder, bytes);
      CHECK(found == frame_laws::frames_in(bytes).frames);
      CHECK(found.size() == 1);
      CHECK(Stream(found[0].begin() + 1, found[0].end()) == content);
      CHECK(decoder.frames() == ++frames && decoder.damaged() == 0);
    }
  }
}

void test_content_that_is_too_long_is_not_framed() {
  std::array<std::uint8_t, max_frame> bytes{};
  const Stream content(max_content + 1, 7);
  CHECK(encode_frame(FrameKind::packet, content, bytes) == 0);
  CHECK(bytes == (std::array<std::uint8_t, max_frame>{}));
}

// One flipped bit, one byte less or one more: no frame, and the next one is found.
void test_damage_is_noticed() {
  std::mt19937 chance(2);
  const Stream next = framed(FrameKind::board_reading, {1, 0, 2});
  std::size_t damaged = 0;
  const auto check = [&](Stream bytes) {
    bytes.insert(bytes.end(), next.begin(), next.end());
    FrameDecoder decoder;
    const auto found = found_in(decoder, bytes);
    const auto expected = frame_laws::frames_in(bytes);
    CHECK(found == expected.frames && decoder.damaged() == expected.damaged);
    // Damage of the last byte, the zero, also destroys the next frame.
    CHECK(found.size() <= 1);
    if (found.size() == 1) CHECK(found[0] == (Stream{0x14, 1, 0, 2}));
    damaged += decoder.damaged();
  };
  for (std::size_t size = 0; size <= max_content; size += 8) {
    const Stream good = framed(FrameKind::packet, random_content(chance, size));
    for (std::size_t at = 0; at < good.size(); ++at) {
      for (int bit = 0; bit < 8; ++bit) {
        Stream bytes = good;
        bytes[at] ^= static_cast<std::uint8_t>(1 << bit);
        check(bytes);
      }
      Stream shorter = good;
      shorter.erase(shorter.begin() + static_cast<std::ptrdiff_t>(at));
      check(shorter);
      Stream longer = good;
      longer.insert(longer.begin() + static_cast<std::ptrdiff_t>(at), 0x55);
      check(longer);
    }
  }
  CHECK(damaged > 3000);
}

void test_noise_of_any_length_is_skipped() {
  std::mt19937 chance(3);
  const Stream good = framed(FrameKind::packet, {1, 2, 3});
  for (std::size_t length = 0; length < 300; ++length) {
    FrameDecoder decoder;
    Stream stream = random_content(chance, length);
    const auto before = frame_laws::frames_in(stream);
    stream.push_back(0);
    stream.insert(stream.end(), good.begin(), good.end());
    const auto found = found_in(decoder, stream);
    CHECK(!found.empty() && found.back() == (Stream{1, 1, 2, 3}));
    CHECK(found.size() >= before.frames.size() + 1);
  }
}

}  // namespace

int main() {
  test_crc_has_its_published_check_value();
  test_every_content_survives();
  test_content_that_is_too_long_is_not_framed();
  test_damage_is_noticed();
  test_noise_of_any_length_is_skipped();
}

// SPDX-License-Identifier: Apache-2.0
// SipHash-2-4 against the test vectors of its authors, all 64, and what a tag must depend on.
#include "palmbots/wire/siphash.hpp"

#include <array>
#include <cstdint>
#include <span>

#include "support/check.hpp"
#include "support/siphash24_vectors.hpp"

using palmbots::siphash24;

namespace {

std::array<std::uint8_t, 16> counting_key() {
  std::array<std::uint8_t, 16> key{};
  for (std::size_t i = 0; i < key.size(); ++i) key[i] = static_cast<std::uint8_t>(i);
  return key;
}

std::array<std::uint8_t, 64> counting_text() {
  std::array<std::uint8_t, 64> text{};
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<std::uint8_t>(i);
  return text;
}

// The digits of a vector in the order of its bytes, the first byte in front.
std::uint64_t first_byte_in_front(std::uint64_t tag) {
  std::uint64_t digits = 0;
  for (int i = 0; i < 8; ++i) digits = digits << 8 | (tag >> 8 * i & 0xff);
  return digits;
}

void test_vectors_of_the_authors() {
  const auto text = counting_text();
  for (std::size_t size = 0; size < 64; ++size) {
    const std::span<const std::uint8_t> part(text.data(), size);
    CHECK(first_byte_in_front(siphash24(counting_key(), part)) == siphash24_vectors[size]);
  }
}

// The example of the paper's appendix A: 15 bytes, a129ca6149be45e5.
void test_example_of_the_paper() {
  const auto text = counting_text();
  CHECK(siphash24(counting_key(), std::span(text).first(15)) == 0xa129ca6149be45e5);
}

// Every bit of the key and of the text changes the tag, and so does a zero byte more.
void test_every_bit_of_key_and_text_changes_the_tag() {
  auto key = counting_key();
  std::array<std::uint8_t, 16> text{};
  const std::uint64_t tag = siphash24(key, text);
  for (std::size_t bit = 0; bit < 128; ++bit) {
    const auto mask = static_cast<std::uint8_t>(1 << bit % 8);
    key[bit / 8] ^= mask;
    CHECK(siphash24(key, text) != tag);
    key[bit / 8] ^= mask;
    text[bit / 8] ^= mask;
    CHECK(siphash24(key, text) != tag);
    text[bit / 8] ^= mask;
  }
  CHECK(siphash24(key, std::span(text).first(15)) != tag);
}

}  // namespace

int main() {
  test_vectors_of_the_authors();
  test_example_of_the_paper();
  test_every_bit_of_key_and_text_changes_the_tag();
}

// SPDX-License-Identifier: Apache-2.0
// Numbers as text, with the digits of printf's %.nf and %.ng in the C locale.
//
// A number is m 2^e with whole m and e. Its decimal digits are exact: they begin as those of m and are
// doubled or halved |e| times. They are rounded once, halves to even. printf itself would bring its
// 128-bit arithmetic into the page's core, 15 kB; the core needs a few numbers in sentences.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace palmbots {

namespace detail {

// Decimal digits d₀ d₁ … of a number ≥ 0, of which `whole` stand before the point (a negative count:
// so many zeros follow the point).
struct Decimal {
  std::string digits;
  int whole = 0;

  explicit Decimal(double value) {
    constexpr int mantissa_bits = 52;
    const auto bits = std::bit_cast<std::uint64_t>(value);
    int exponent = static_cast<int>(bits >> mantissa_bits & 0x7FF);
    std::uint64_t mantissa = bits & ((std::uint64_t{1} << mantissa_bits) - 1);
    if (exponent > 0) mantissa |= std::uint64_t{1} << mantissa_bits;
    exponent = (exponent > 0 ? exponent : 1) - 1023 - mantissa_bits;
    for (; mantissa > 0; mantissa /= 10) digits.insert(0, 1, static_cast<char>(mantissa % 10));
    whole = static_cast<int>(digits.size());
    for (; exponent > 0; --exponent) twice();
    for (; exponent < 0 && !digits.empty(); ++exponent) half();
  }

  // Keeps the first `count` digits, rounded.
  void round_to(int count) {
    if (count >= static_cast<int>(digits.size())) return;
    const auto kept = static_cast<std::size_t>(count > 0 ? count : 0);
    bool up = count >= 0 && digits[kept] >= 5;
    if (up && digits[kept] == 5 && digits.find_first_not_of('\0', kept + 1) == digits.npos) {
      up = kept > 0 && digits[kept - 1] % 2 == 1;  // exactly half
    }
    digits.resize(kept);
    if (up) {
      std::size_t i = kept;
      while (i > 0 && digits[i - 1] == 9) digits[--i] = 0;
      if (i > 0) {
        ++digits[i - 1];
      } else {
        digits.insert(0, 1, char{1});
        ++whole;
      }
    }
  }

 private:
  void twice() {
    int carry = 0;
    for (std::size_t i = digits.size(); i-- > 0;) {
      const int sum = 2 * digits[i] + carry;
      digits[i] = static_cast<char>(sum % 10);
      carry = sum / 10;
    }
    if (carry == 0) return;
    digits.insert(0, 1, static_cast<char>(carry));
    ++whole;
  }
  void half() {
    int rest = 0;
    for (char& digit : digits) {
      const int sum = 10 * rest + digit;
      digit = static_cast<char>(sum / 2);
      rest = sum % 2;
    }
    if (rest > 0) digits += char{5};
    if (digits[0] > 0) return;
    digits.erase(0, 1);
    --whole;
  }
};

// The digits with the point after the first `whole` of them, and `places` digits after it.
inline std::string with_point(const std::string& digits, int whole, int places) {
  std::string text;
  for (int i = whole < 1 ? whole - 1 : 0; i < whole + places; ++i) {
    if (i == whole) text += '.';
    const bool is_there = i >= 0 && i < static_cast<int>(digits.size());
    text += static_cast<char>('0' + (is_there ? digits[static_cast<std::size_t>(i)] : 0));
  }
  return text;
}

// The sign, and the text of what is no number; a number leaves `rest` empty.
inline std::string sign_of(double value, std::string& rest) {
  if (!std::isfinite(value)) rest = value != value ? "nan" : "inf";
  return std::signbit(value) ? "-" : "";
}

}  // namespace detail

// %.nf
inline std::string fixed_text(double value, int places) {
  std::string rest;
  const std::string sign = detail::sign_of(value, rest);
  if (!rest.empty()) return sign + rest;
  detail::Decimal number(std::abs(value));
  number.round_to(number.whole + places);
  return sign + detail::with_point(number.digits, number.whole, places);
}

// %.ng: `most` significant digits, without zeros at the end.
inline std::string short_text(double value, int most = 6) {
  std::string rest;
  const std::string sign = detail::sign_of(value, rest);
  if (!rest.empty()) return sign + rest;
  detail::Decimal number(std::abs(value));
  number.round_to(most);
  std::string& digits = number.digits;
  while (!digits.empty() && digits.back() == 0) digits.pop_back();
  if (digits.empty()) return sign + "0";
  const int exponent = number.whole - 1;
  const int count = static_cast<int>(digits.size());
  const auto after = [&](int whole) { return count > whole ? count - whole : 0; };
  if (exponent >= -4 && exponent < most) {
    return sign + detail::with_point(digits, number.whole, after(number.whole));
  }
  const int size = exponent < 0 ? -exponent : exponent;
  return sign + detail::with_point(digits, 1, after(1)) + (exponent < 0 ? "e-" : "e+") +
         (size < 10 ? "0" : "") + std::to_string(size);
}

// A text with words in place of {}, one after the other.
inline std::string sentence(std::string_view text, std::initializer_list<std::string> words) {
  std::string whole;
  const std::string* word = words.begin();
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '{') {
      whole += text[i];
      continue;
    }
    whole += *word++;
    ++i;
  }
  return whole;
}

// A length [m] in mm.
inline std::string millimetres(double metres) {
  const std::string text = fixed_text(1e3 * metres, 1);
  return (text == "-0.0" ? "0.0" : text) + " mm";
}

}  // namespace palmbots

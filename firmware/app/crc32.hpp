// SPDX-License-Identifier: Apache-2.0
// CRC-32 (polynomial 0x04C11DB7, reflected), as in zlib.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace palmbots::app {

namespace detail {
inline constexpr std::array<std::uint32_t, 16> crc_table = [] {
  std::array<std::uint32_t, 16> table{};
  for (std::uint32_t i = 0; i < 16; ++i) {
    std::uint32_t crc = i;
    for (int bit = 0; bit < 4; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0xEDB88320U : 0U);
    table[i] = crc;
  }
  return table;
}();
}  // namespace detail

inline std::uint32_t crc32(const void* begin, std::size_t size) {
  const auto* bytes = static_cast<const std::uint8_t*>(begin);
  std::uint32_t crc = 0xFFFFFFFF;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= bytes[i];
    crc = crc >> 4 ^ detail::crc_table[crc & 15];
    crc = crc >> 4 ^ detail::crc_table[crc & 15];
  }
  return ~crc;
}

}  // namespace palmbots::app

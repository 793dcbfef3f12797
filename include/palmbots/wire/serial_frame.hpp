// SPDX-License-Identifier: Apache-2.0
// Frames on a serial line (docs/reference/wire.md): one kind byte, up to 64 bytes of content and a
// CRC-16, encoded with Consistent Overhead Byte Stuffing (Cheshire and Baker, 1999) and ended by a
// zero byte.
//
// No other byte of a frame is zero. A receiver that starts in the middle of a frame, or loses bytes
// of one, therefore finds the next frame after the next zero. What the frames of each kind contain
// is in wire/device_frames.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palmbots::wire {

// What a frame is for. A receiver ignores kinds that it does not know.
enum class FrameKind : std::uint8_t {
  packet = 0x01,         // one packet of the radio, in both directions
  bridge_report = 0x02,  // bridge → program: what it has forwarded and dropped
  board_hello = 0x11,    // program → motor board: what are you?
  board_identity = 0x12,
  board_command = 0x13,  // program → motor board: wheels and palm
  board_reading = 0x14,  // motor board → program: sensors
};

inline constexpr std::size_t max_content = 64;
// Kind, content and CRC; one byte more by the encoding, and the final zero.
inline constexpr std::size_t max_unstuffed = 1 + max_content + 2;
inline constexpr std::size_t max_frame = max_unstuffed + 2;

namespace detail {
// What four bits add to a CRC. A board computes a CRC for each packet, so speed matters there, and so
// does memory: a table for whole bytes would need 16 times as much.
inline constexpr std::array<std::uint16_t, 16> crc16_table = [] {
  std::array<std::uint16_t, 16> table{};
  for (std::uint32_t i = 0; i < table.size(); ++i) {
    std::uint32_t crc = i << 12;
    for (int bit = 0; bit < 4; ++bit) crc = (crc & 0x8000) != 0 ? crc << 1 ^ 0x1021 : crc << 1;
    table[i] = static_cast<std::uint16_t>(crc);
  }
  return table;
}();
}  // namespace detail

// CRC-16 with the polynomial x¹⁶ + x¹² + x⁵ + 1, initial value FFFF, most significant bit first
// (CRC-16/IBM-3740, also called CCITT-FALSE).
constexpr std::uint16_t crc16(std::span<const std::uint8_t> bytes) {
  std::uint32_t crc = 0xFFFF;
  for (const std::uint8_t byte : bytes) {
    crc = (crc << 4 & 0xFFFF) ^ detail::crc16_table[(crc >> 12 ^ byte >> 4) & 15];
    crc = (crc << 4 & 0xFFFF) ^ detail::crc16_table[(crc >> 12 ^ byte) & 15];
  }
  return static_cast<std::uint16_t>(crc);
}

// Writes a frame with its final zero, and returns its size. Content that is longer than
// `max_content` cannot be framed: 0 is returned, and nothing written.
constexpr std::size_t encode_frame(FrameKind kind, std::span<const std::uint8_t> content,
                                   std::span<std::uint8_t, max_frame> out) {
  if (content.size() > max_content) return 0;
  std::array<std::uint8_t, max_unstuffed> plain{};
  std::size_t size = 0;
  plain[size++] = static_cast<std::uint8_t>(kind);
  for (const std::uint8_t byte : content) plain[size++] = byte;
  const std::uint16_t crc = crc16(std::span(plain).first(size));
  plain[size++] = static_cast<std::uint8_t>(crc & 255);
  plain[size++] = static_cast<std::uint8_t>(crc >> 8);
  // Each zero is replaced by the distance to the next one; the first byte is the distance to the
  // first. Frames are shorter than 254 bytes, so every distance fits into its byte.
  std::size_t zero = 0;
  std::size_t end = 1;
  for (std::size_t i = 0; i < size; ++i, ++end) {
    out[end] = plain[i];
    if (plain[i] != 0) continue;
    out[zero] = static_cast<std::uint8_t>(end - zero);
    zero = end;
  }
  out[zero] = static_cast<std::uint8_t>(end - zero);
  out[end] = 0;
  return end + 1;
}

// A frame that has arrived. The content is valid until the decoder takes its next byte.
struct Frame {
  std::uint8_t kind = 0;
  std::span<const std::uint8_t> content{};
};

// Finds frames in the bytes of a serial line.
class FrameDecoder {
 public:
  // Takes one byte; true: it completes a frame, which `frame` returns.
  constexpr bool take(std::uint8_t byte) {
    if (byte != 0) {
      if (size_ < bytes_.size()) bytes_[size_] = byte;
      if (size_ <= bytes_.size()) ++size_;  // one more than there is room for: too long
      return false;
    }
    const std::size_t size = size_;
    size_ = 0;
    if (size == 0) return false;  // two zeros follow each other: no frame between them
    if (size <= bytes_.size() && unstuff(size) && crc_is_right()) {
      ++frames_;
      return true;
    }
    plain_size_ = 0;
    ++damaged_;
    return false;
  }

  // The newest complete frame.
  constexpr Frame frame() const {
    if (plain_size_ < 3) return {};
    return {bytes_[0], std::span(bytes_).subspan(1, plain_size_ - 3)};
  }

  constexpr std::uint32_t frames() const { return frames_; }
  // Byte sequences between two zeros that are no frame.
  constexpr std::uint32_t damaged() const { return damaged_; }

 private:
  // Puts the zeros back, in place. Returns false if a distance leads beyond the end.
  constexpr bool unstuff(std::size_t size) {
    std::size_t next = bytes_[0];  // where the next zero belongs
    for (std::size_t i = 1; i < size; ++i) {
      const std::uint8_t byte = bytes_[i];
      bytes_[i - 1] = i == next ? 0 : byte;
      if (i == next) next += byte;
    }
    plain_size_ = size - 1;
    return next == size;
  }

  constexpr bool crc_is_right() const {
    if (plain_size_ < 3) return false;
    const auto bytes = std::span(bytes_);
    return crc16(bytes.first(plain_size_ - 2)) ==
           (bytes_[plain_size_ - 2] | bytes_[plain_size_ - 1] << 8);
  }

  std::array<std::uint8_t, max_frame - 1> bytes_{};
  std::size_t size_ = 0;        // of the bytes since the last zero
  std::size_t plain_size_ = 0;  // of the newest frame
  std::uint32_t frames_ = 0;
  std::uint32_t damaged_ = 0;
};

}  // namespace palmbots::wire

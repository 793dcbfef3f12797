// SPDX-License-Identifier: Apache-2.0
// The program of the third board, the station's radio: it passes packets between a serial line and
// the radio, in the frames of palmbots/wire/serial_frame.hpp. It has no key and does not look into
// packets. What it cannot forward in time it drops, and reports how often.
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "../board/board.hpp"
#include "crc32.hpp"
#include "only_show.hpp"
#include "palmbots/wire/device_frames.hpp"
#include "palmbots/wire/serial_frame.hpp"
#include "picture.hpp"
#include "settings.hpp"

// Without settings: `palmbots firmware` replaces them.
[[gnu::section(".settings"),
  gnu::used]] constinit const palmbots::app::SettingsPage settings_page{};

namespace palmbots::app {

namespace {

// The LEDs show a ring, and one more light while the station, and while a robot is heard.
constexpr std::uint32_t ring = 0b00000'01110'01010'01110'00000;
constexpr std::uint32_t hears_line = 1U << 20, hears_radio = 1U << 24;

class Dongle {
 public:
  explicit Dongle(std::uint32_t seed) : random_(seed | 1) {}

  [[noreturn]] void run() {
    while (true) {
      board::sleep();
      board::serve_radio();
      board::serve_uart();
      from_radio();
      from_line();
      if (board::take_alarm() || (follows_ && !board::is_sending())) send_oldest();
      if (board::take_slot() && slots_++ % slots_per_row == 0) board::next_row();
      const std::uint16_t elapsed = board::take_ticks();
      if (elapsed == 0) continue;
      tick(elapsed);
      board::feed_watchdog();
    }
  }

 private:
  static constexpr std::size_t room = 8;
  static constexpr std::uint32_t report_period = 100;  // [ticks of 5 ms]
  static constexpr std::uint32_t slots_per_row = 2;    // a row of LEDs shines for 2 ms
  static constexpr std::uint32_t span_us = 3000;       // within which a packet leaves
  static constexpr std::uint32_t heard_for = 100;      // [ticks]

  void from_radio() {
    while (board::take_packet(received_)) {
      since_radio_ = 0;
      if (write(wire::FrameKind::packet, {received_.bytes.data(), received_.size})) {
        ++report_.received;
      } else {
        ++report_.serial_full;
      }
    }
  }

  void from_line() {
    std::uint8_t bytes[64];
    while (const std::size_t count = board::read_uart(bytes, sizeof bytes)) {
      for (std::size_t i = 0; i < count; ++i) {
        if (decoder_.take(bytes[i])) take_frame(decoder_.frame());
      }
    }
    report_.serial_damaged = decoder_.damaged() + unknown_;
  }

  void take_frame(const wire::Frame& frame) {
    const bool is_packet = frame.kind == static_cast<std::uint8_t>(wire::FrameKind::packet) &&
                           !frame.content.empty() &&
                           frame.content.size() <= board::RadioPacket::most_bytes;
    if (!is_packet) {
      ++unknown_;
      return;
    }
    since_line_ = 0;
    if (count_ == room) {
      ++report_.radio_full;
      return;
    }
    board::RadioPacket& packet = waiting_[(first_ + count_) % room];
    packet.size = static_cast<std::uint8_t>(frame.content.size());
    for (std::size_t i = 0; i < frame.content.size(); ++i) packet.bytes[i] = frame.content[i];
    if (count_++ == 0 && !follows_) set_alarm();
  }

  // A packet leaves at a random instant, as those of the robots do. What waits then follows it.
  void set_alarm() {
    random_ ^= random_ << 13;
    random_ ^= random_ >> 17;
    random_ ^= random_ << 5;
    board::set_alarm(50 + static_cast<std::uint32_t>(std::uint64_t{random_} * span_us >> 32));
  }

  void send_oldest() {
    if (count_ > 0 && board::send(waiting_[first_])) {
      ++report_.sent;
      first_ = (first_ + 1) % room;
      --count_;
    }
    follows_ = count_ > 0;
  }

  void tick(std::uint16_t elapsed) {
    const auto age = [elapsed](std::uint32_t& time) {
      time = time < 0xFFFF0000 ? time + elapsed : time;
    };
    age(since_line_);
    age(since_radio_);
    board::show(ring | (since_line_ < heard_for ? hears_line : 0) |
                (since_radio_ < heard_for ? hears_radio : 0));
    since_report_ += elapsed;
    if (since_report_ < report_period) return;
    since_report_ = 0;
    report_.radio_damaged = board::damaged_packets();
    const auto content = wire::content_of(report_);
    write(wire::FrameKind::bridge_report, content);
  }

  bool write(wire::FrameKind kind, std::span<const std::uint8_t> content) {
    std::array<std::uint8_t, wire::max_frame> frame;
    const std::size_t size = wire::encode_frame(kind, content, frame);
    if (size == 0 || size > board::uart_room()) return false;
    board::write_uart(frame.data(), size);
    return true;
  }

  wire::FrameDecoder decoder_;
  wire::BridgeReport report_;
  std::uint32_t unknown_ = 0;
  std::uint32_t random_;
  std::uint32_t slots_ = 0;
  std::uint32_t since_line_ = heard_for, since_radio_ = heard_for, since_report_ = 0;
  board::RadioPacket received_;  // a member, because a local one would be cleared in each call
  board::RadioPacket waiting_[room];
  std::size_t first_ = 0, count_ = 0;
  bool follows_ = false;  // a packet has been sent, and others wait
};

}  // namespace

}  // namespace palmbots::app

extern "C" void run_program() {
  using namespace palmbots;
  board::start();
  const app::SettingsPage& page = app::flashed_settings();
  const app::Settings& s = page.settings;
  const bool is_right = s.magic == app::Settings::right_magic && s.role == 2 &&
                        s.check == app::crc32(&s, offsetof(app::Settings, check));
  if (!is_right) app::only_show(app::BoardFault::settings);
  board::start_uart();
  board::start_radio(s.channel, s.power_dbm);
  static app::Dongle dongle(board::random_word());
  board::start_watchdog(s.watchdog_us);
  board::start_ticks(s.period_us);
  dongle.run();
}

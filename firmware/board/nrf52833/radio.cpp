// SPDX-License-Identifier: Apache-2.0
// RADIO: 1 Mbit/s, proprietary packets of one length byte and the content, with a checksum of 24 bits.
//
// The radio listens except while it sends. A packet that arrives while this board sends is lost, as
// with every radio that has one antenna.
#include <cstdint>

#include "../board.hpp"
#include "registers.hpp"
#include "wake.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t ready_start = 1, end_disable = 2;
constexpr std::uint32_t wakes_on = 1U << 3 | 1U << 4;  // END, DISABLED
constexpr std::size_t room = 16;

enum class State : std::uint8_t { listening, turning, sending };

// The radio writes into buffer `newest`; the `waiting` ones before it are full.
RadioPacket buffers[room];
std::size_t newest, waiting;
RadioPacket to_send;
State state;
std::uint32_t lost, damaged;

void listen() {
  state = State::listening;
  RADIO::SHORTS = ready_start;
  RADIO::PACKETPTR = address_of(&buffers[newest]);
  RADIO::EVENTS_DISABLED = 0;
  RADIO::EVENTS_END = 0;
  RADIO::TASKS_RXEN = 1;
}

void keep_received() {
  const bool is_right = RADIO::CRCSTATUS == 1;
  if (!is_right) ++damaged;
  const bool is_whole = is_right && buffers[newest].size <= RadioPacket::most_bytes;
  if (is_whole && waiting + 1 < room) {
    newest = (newest + 1) % room;
    ++waiting;
  } else if (is_whole) {
    ++lost;
  }
}

}  // namespace

void start_radio(std::uint8_t channel, std::int8_t power_dbm) {
  RADIO::MODE = 0;  // 1 Mbit/s
  RADIO::FREQUENCY = channel;
  RADIO::TXPOWER = static_cast<std::uint8_t>(power_dbm);
  RADIO::PCNF0 = 8;  // the length has 8 bits
  // At most so many bytes, an address of 4 + 1 bytes, least significant bit first, whitened.
  RADIO::PCNF1 = RadioPacket::most_bytes | 4U << 16 | 1U << 25;
  RADIO::BASE0 = 0x706C6D62;
  RADIO::PREFIX0 = 0x74;
  RADIO::TXADDRESS = 0;
  RADIO::RXADDRESSES = 1;
  RADIO::CRCCNF = 3;
  RADIO::CRCPOLY = 0x00065B;
  RADIO::CRCINIT = 0x555555;
  RADIO::DATAWHITEIV = channel;
  RADIO::INTENSET = wakes_on;
  wakes(Interrupt::radio);
  listen();
}

bool take_packet(RadioPacket& packet) {
  if (waiting == 0) return false;
  packet = buffers[(newest + room - waiting) % room];
  --waiting;
  return true;
}

bool is_sending() { return state != State::listening; }

bool send(const RadioPacket& packet) {
  serve_radio();  // a packet that has just arrived is not lost
  if (is_sending()) return false;
  to_send = packet;
  state = State::turning;
  RADIO::EVENTS_DISABLED = 0;
  RADIO::TASKS_DISABLE = 1;
  return true;
}

void serve_radio() {
  if (state == State::listening) {
    if (RADIO::EVENTS_END == 0) return;
    RADIO::EVENTS_END = 0;
    keep_received();
    RADIO::PACKETPTR = address_of(&buffers[newest]);
    RADIO::TASKS_START = 1;
  } else if (RADIO::EVENTS_DISABLED != 0) {
    RADIO::EVENTS_DISABLED = 0;
    RADIO::EVENTS_END = 0;
    if (state == State::sending) {
      listen();
    } else {
      state = State::sending;
      RADIO::SHORTS = ready_start | end_disable;
      RADIO::PACKETPTR = address_of(&to_send);
      RADIO::TASKS_TXEN = 1;
    }
  } else if (RADIO::EVENTS_END != 0) {
    RADIO::EVENTS_END = 0;  // DISABLED follows
  } else {
    return;
  }
  has_been_served(Interrupt::radio);
}

std::uint32_t lost_packets() { return lost; }

std::uint32_t damaged_packets() { return damaged; }

}  // namespace palmbots::board

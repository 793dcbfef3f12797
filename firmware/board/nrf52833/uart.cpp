// SPDX-License-Identifier: Apache-2.0
// UARTE0: 1 Mbit/s to the interface chip of the board, which is a serial port for the computer.
//
// The peripheral fills one of two halves of a ring while the other is the next one. TIMER1 counts the
// bytes, through PPI, so that a line that falls silent in the middle of a half is read too. No byte ends
// the sleep: the processor would be busy with nothing else. The program looks in each slot of its tick,
// which must be shorter than a half lasts, 1.28 ms.
#include <cstdint>

#include "../board.hpp"
#include "pins.hpp"
#include "registers.hpp"
#include "wake.hpp"

namespace palmbots::board {

namespace {

constexpr std::uint32_t half = 128;
constexpr std::size_t out_room = 512;

std::uint8_t incoming[2 * half];
std::uint32_t read_so_far;
unsigned next_half;

std::uint8_t outgoing[out_room];
std::size_t out_begin, out_count, out_under_way;

void send_some() {
  if (out_under_way != 0 || out_count == 0) return;
  const std::size_t to_end = out_room - out_begin;
  out_under_way = out_count < to_end ? out_count : to_end;
  UARTE0::TXD_PTR = address_of(outgoing + out_begin);
  UARTE0::TXD_MAXCNT = static_cast<std::uint32_t>(out_under_way);
  UARTE0::EVENTS_ENDTX = 0;
  UARTE0::TASKS_STARTTX = 1;
}

}  // namespace

void start_uart() {
  pins::set(pins::uart_txd);
  pins::configure(pins::uart_txd, pins::output);
  pins::configure(pins::uart_rxd, pins::input_pull_up);
  UARTE0::PSEL_TXD = pins::uart_txd;
  UARTE0::PSEL_RXD = pins::uart_rxd;
  UARTE0::BAUDRATE = 0x10000000;  // 1 Mbit/s
  UARTE0::ENABLE = 8;
  TIMER1::MODE = 2;  // counts events
  TIMER1::BITMODE = 3;
  TIMER1::TASKS_CLEAR = 1;
  TIMER1::TASKS_START = 1;
  PPI::CH0_EEP = decltype(UARTE0::EVENTS_RXDRDY)::at;
  PPI::CH0_TEP = decltype(TIMER1::TASKS_COUNT)::at;
  PPI::CHENSET = 1;
  UARTE0::SHORTS = 1U << 5;  // ENDRX starts the next half
  UARTE0::RXD_PTR = address_of(incoming);
  UARTE0::RXD_MAXCNT = half;
  UARTE0::INTENSET = 1U << 8 | 1U << 19;  // ENDTX, RXSTARTED
  wakes(Interrupt::uart);
  UARTE0::TASKS_STARTRX = 1;
}

void serve_uart() {
  if (UARTE0::EVENTS_RXSTARTED != 0) {  // the address is taken: the next one may be set
    UARTE0::EVENTS_RXSTARTED = 0;
    next_half = 1 - next_half;
    UARTE0::RXD_PTR = address_of(incoming + half * next_half);
  }
  if (UARTE0::EVENTS_ENDTX != 0) {
    UARTE0::EVENTS_ENDTX = 0;
    out_begin = (out_begin + out_under_way) % out_room;
    out_count -= out_under_way;
    out_under_way = 0;
  }
  has_been_served(Interrupt::uart);
  send_some();
}

std::size_t read_uart(std::uint8_t* bytes, std::size_t size) {
  TIMER1::TASKS_CAPTURE[0] = 1;
  const std::uint32_t arrived = TIMER1::CC[0];
  if (arrived - read_so_far > half) read_so_far = arrived - half;  // overwritten, or about to be
  std::size_t count = 0;
  for (; count < size && read_so_far != arrived; ++count) {
    bytes[count] = incoming[read_so_far++ % (2 * half)];
  }
  return count;
}

std::size_t uart_room() { return out_room - out_count; }

void write_uart(const std::uint8_t* bytes, std::size_t size) {
  for (std::size_t i = 0; i < size && out_count < out_room; ++i, ++out_count) {
    outgoing[(out_begin + out_count) % out_room] = bytes[i];
  }
  send_some();
}

}  // namespace palmbots::board

// The registers of the nRF52833 that the board and its emulator use, from Nordic's description of the
// chip (nrf52833.svd; the crate nrf-pac ships it).
//
// Copyright (c) 2010 - 2024, Nordic Semiconductor ASA All rights reserved.
//
// SPDX-License-Identifier: BSD-3-Clause
//
// Redistribution and use in source and binary forms, with or without
// modification, are permitted provided that the following conditions are met:
//
// 1. Redistributions of source code must retain the above copyright notice, this
// list of conditions and the following disclaimer.
//
// 2. Redistributions in binary form must reproduce the above copyright
// notice, this list of conditions and the following disclaimer in the
// documentation and/or other materials provided with the distribution.
//
// 3. Neither the name of Nordic Semiconductor ASA nor the names of its
// contributors may be used to endorse or promote products derived from this
// software without specific prior written permission.
//
// THIS SOFTWARE IS PROVIDED BY THE COPYRIGHT HOLDERS AND CONTRIBUTORS "AS IS"
// AND ANY EXPRESS OR IMPLIED WARRANTIES, INCLUDING, BUT NOT LIMITED TO, THE
// IMPLIED WARRANTIES OF MERCHANTABILITY, AND FITNESS FOR A PARTICULAR PURPOSE
// ARE DISCLAIMED. IN NO EVENT SHALL NORDIC SEMICONDUCTOR ASA OR CONTRIBUTORS BE
// LIABLE FOR ANY DIRECT, INDIRECT, INCIDENTAL, SPECIAL, EXEMPLARY, OR
// CONSEQUENTIAL DAMAGES (INCLUDING, BUT NOT LIMITED TO, PROCUREMENT OF
// SUBSTITUTE GOODS OR SERVICES; LOSS OF USE, DATA, OR PROFITS; OR BUSINESS
// INTERRUPTION) HOWEVER CAUSED AND ON ANY THEORY OF LIABILITY, WHETHER IN
// CONTRACT, STRICT LIABILITY, OR TORT (INCLUDING NEGLIGENCE OR OTHERWISE)
// ARISING IN ANY WAY OUT OF THE USE OF THIS SOFTWARE, EVEN IF ADVISED OF THE
// POSSIBILITY OF SUCH DAMAGE.
#pragma once

#include "../register.hpp"

namespace palmbots::board::APPROTECT {
inline constexpr Register<0x40000558> DISABLE{};
}

namespace palmbots::board::CLOCK {
inline constexpr Register<0x40000000> TASKS_HFCLKSTART{};
inline constexpr Register<0x40000100> EVENTS_HFCLKSTARTED{};
}  // namespace palmbots::board::CLOCK

namespace palmbots::board::NVMC {
inline constexpr Register<0x4001E400> READY{};
inline constexpr Register<0x4001E504> CONFIG{};
inline constexpr Register<0x4001E508> ERASEPAGE{};
}  // namespace palmbots::board::NVMC

namespace palmbots::board::P0 {
inline constexpr Register<0x50000504> OUT{};
inline constexpr Register<0x50000508> OUTSET{};
inline constexpr Register<0x5000050C> OUTCLR{};
inline constexpr Register<0x50000510> IN{};
inline constexpr Registers<0x50000700, 4> PIN_CNF{};
}  // namespace palmbots::board::P0

namespace palmbots::board::P1 {
inline constexpr Register<0x50000804> OUT{};
inline constexpr Register<0x50000808> OUTSET{};
inline constexpr Register<0x5000080C> OUTCLR{};
inline constexpr Register<0x50000810> IN{};
inline constexpr Registers<0x50000A00, 4> PIN_CNF{};
}  // namespace palmbots::board::P1

namespace palmbots::board::POWER {
inline constexpr Register<0x40000108> EVENTS_POFWARN{};
inline constexpr Register<0x40000510> POFCON{};
}  // namespace palmbots::board::POWER

namespace palmbots::board::PPI {
inline constexpr Register<0x4001F504> CHENSET{};
inline constexpr Register<0x4001F510> CH0_EEP{};
inline constexpr Register<0x4001F514> CH0_TEP{};
}  // namespace palmbots::board::PPI

namespace palmbots::board::PWM0 {
inline constexpr Registers<0x4001C008, 4> TASKS_SEQSTART{};
inline constexpr Register<0x4001C500> ENABLE{};
inline constexpr Register<0x4001C504> MODE{};
inline constexpr Register<0x4001C508> COUNTERTOP{};
inline constexpr Register<0x4001C50C> PRESCALER{};
inline constexpr Register<0x4001C510> DECODER{};
inline constexpr Register<0x4001C514> LOOP{};
inline constexpr Register<0x4001C520> SEQ0_PTR{};
inline constexpr Register<0x4001C524> SEQ0_CNT{};
inline constexpr Register<0x4001C528> SEQ0_REFRESH{};
inline constexpr Register<0x4001C52C> SEQ0_ENDDELAY{};
inline constexpr Registers<0x4001C560, 4> PSEL_OUT{};
}  // namespace palmbots::board::PWM0

namespace palmbots::board::RADIO {
inline constexpr Register<0x40001000> TASKS_TXEN{};
inline constexpr Register<0x40001004> TASKS_RXEN{};
inline constexpr Register<0x40001008> TASKS_START{};
inline constexpr Register<0x40001010> TASKS_DISABLE{};
inline constexpr Register<0x40001100> EVENTS_READY{};
inline constexpr Register<0x4000110C> EVENTS_END{};
inline constexpr Register<0x40001110> EVENTS_DISABLED{};
inline constexpr Register<0x40001200> SHORTS{};
inline constexpr Register<0x40001304> INTENSET{};
inline constexpr Register<0x40001400> CRCSTATUS{};
inline constexpr Register<0x40001504> PACKETPTR{};
inline constexpr Register<0x40001508> FREQUENCY{};
inline constexpr Register<0x4000150C> TXPOWER{};
inline constexpr Register<0x40001510> MODE{};
inline constexpr Register<0x40001514> PCNF0{};
inline constexpr Register<0x40001518> PCNF1{};
inline constexpr Register<0x4000151C> BASE0{};
inline constexpr Register<0x40001524> PREFIX0{};
inline constexpr Register<0x4000152C> TXADDRESS{};
inline constexpr Register<0x40001530> RXADDRESSES{};
inline constexpr Register<0x40001534> CRCCNF{};
inline constexpr Register<0x40001538> CRCPOLY{};
inline constexpr Register<0x4000153C> CRCINIT{};
inline constexpr Register<0x40001554> DATAWHITEIV{};
}  // namespace palmbots::board::RADIO

namespace palmbots::board::RNG {
inline constexpr Register<0x4000D000> TASKS_START{};
inline constexpr Register<0x4000D004> TASKS_STOP{};
inline constexpr Register<0x4000D100> EVENTS_VALRDY{};
inline constexpr Register<0x4000D504> CONFIG{};
inline constexpr Register<0x4000D508> VALUE{};
}  // namespace palmbots::board::RNG

namespace palmbots::board::SAADC {
inline constexpr Register<0x40007000> TASKS_START{};
inline constexpr Register<0x40007004> TASKS_SAMPLE{};
inline constexpr Register<0x40007100> EVENTS_STARTED{};
inline constexpr Register<0x40007104> EVENTS_END{};
inline constexpr Register<0x40007500> ENABLE{};
inline constexpr Register<0x40007510> CH0_PSELP{};
inline constexpr Register<0x40007514> CH0_PSELN{};
inline constexpr Register<0x40007518> CH0_CONFIG{};
inline constexpr Register<0x400075F0> RESOLUTION{};
inline constexpr Register<0x4000762C> RESULT_PTR{};
inline constexpr Register<0x40007630> RESULT_MAXCNT{};
}  // namespace palmbots::board::SAADC

namespace palmbots::board::TIMER0 {
inline constexpr Register<0x40008000> TASKS_START{};
inline constexpr Register<0x4000800C> TASKS_CLEAR{};
inline constexpr Registers<0x40008040, 4> TASKS_CAPTURE{};
inline constexpr Registers<0x40008140, 4> EVENTS_COMPARE{};
inline constexpr Register<0x40008304> INTENSET{};
inline constexpr Register<0x40008504> MODE{};
inline constexpr Register<0x40008508> BITMODE{};
inline constexpr Register<0x40008510> PRESCALER{};
inline constexpr Registers<0x40008540, 4> CC{};
}  // namespace palmbots::board::TIMER0

namespace palmbots::board::TIMER1 {
inline constexpr Register<0x40009000> TASKS_START{};
inline constexpr Register<0x40009008> TASKS_COUNT{};
inline constexpr Register<0x4000900C> TASKS_CLEAR{};
inline constexpr Registers<0x40009040, 4> TASKS_CAPTURE{};
inline constexpr Register<0x40009504> MODE{};
inline constexpr Register<0x40009508> BITMODE{};
inline constexpr Registers<0x40009540, 4> CC{};
}  // namespace palmbots::board::TIMER1

namespace palmbots::board::TWIM0 {
inline constexpr Register<0x40003008> TASKS_STARTTX{};
inline constexpr Register<0x40003014> TASKS_STOP{};
inline constexpr Register<0x40003104> EVENTS_STOPPED{};
inline constexpr Register<0x40003124> EVENTS_ERROR{};
inline constexpr Register<0x40003160> EVENTS_LASTTX{};
inline constexpr Register<0x40003200> SHORTS{};
inline constexpr Register<0x400034C4> ERRORSRC{};
inline constexpr Register<0x40003500> ENABLE{};
inline constexpr Register<0x40003508> PSEL_SCL{};
inline constexpr Register<0x4000350C> PSEL_SDA{};
inline constexpr Register<0x40003524> FREQUENCY{};
inline constexpr Register<0x40003544> TXD_PTR{};
inline constexpr Register<0x40003548> TXD_MAXCNT{};
inline constexpr Register<0x4000354C> TXD_AMOUNT{};
inline constexpr Register<0x40003588> ADDRESS{};
}  // namespace palmbots::board::TWIM0

namespace palmbots::board::UARTE0 {
inline constexpr Register<0x40002000> TASKS_STARTRX{};
inline constexpr Register<0x40002008> TASKS_STARTTX{};
inline constexpr Register<0x40002108> EVENTS_RXDRDY{};
inline constexpr Register<0x40002110> EVENTS_ENDRX{};
inline constexpr Register<0x40002120> EVENTS_ENDTX{};
inline constexpr Register<0x4000214C> EVENTS_RXSTARTED{};
inline constexpr Register<0x40002200> SHORTS{};
inline constexpr Register<0x40002304> INTENSET{};
inline constexpr Register<0x40002500> ENABLE{};
inline constexpr Register<0x4000250C> PSEL_TXD{};
inline constexpr Register<0x40002514> PSEL_RXD{};
inline constexpr Register<0x40002524> BAUDRATE{};
inline constexpr Register<0x40002534> RXD_PTR{};
inline constexpr Register<0x40002538> RXD_MAXCNT{};
inline constexpr Register<0x40002544> TXD_PTR{};
inline constexpr Register<0x40002548> TXD_MAXCNT{};
inline constexpr Register<0x4000254C> TXD_AMOUNT{};
}  // namespace palmbots::board::UARTE0

namespace palmbots::board::UICR {
inline constexpr Register<0x10001208> APPROTECT{};
inline constexpr Register<0x1000120C> NFCPINS{};
}  // namespace palmbots::board::UICR

namespace palmbots::board::WDT {
inline constexpr Register<0x40010000> TASKS_START{};
inline constexpr Register<0x40010504> CRV{};
inline constexpr Register<0x40010508> RREN{};
inline constexpr Register<0x4001050C> CONFIG{};
inline constexpr Registers<0x40010600, 4> RR{};
}  // namespace palmbots::board::WDT

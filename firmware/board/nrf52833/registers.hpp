// clang-format off
// The registers of the nRF52833 that the board uses, from Nordic's description of the chip. Written
// by generate_registers.py; do not edit.
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
inline constexpr Register<0x40000550> FORCEPROTECT{};
inline constexpr Register<0x40000558> DISABLE{};
}

namespace palmbots::board::CLOCK {
inline constexpr Register<0x40000000> TASKS_HFCLKSTART{};
inline constexpr Register<0x40000004> TASKS_HFCLKSTOP{};
inline constexpr Register<0x40000008> TASKS_LFCLKSTART{};
inline constexpr Register<0x4000000C> TASKS_LFCLKSTOP{};
inline constexpr Register<0x40000010> TASKS_CAL{};
inline constexpr Register<0x40000014> TASKS_CTSTART{};
inline constexpr Register<0x40000018> TASKS_CTSTOP{};
inline constexpr Register<0x40000100> EVENTS_HFCLKSTARTED{};
inline constexpr Register<0x40000104> EVENTS_LFCLKSTARTED{};
inline constexpr Register<0x4000010C> EVENTS_DONE{};
inline constexpr Register<0x40000110> EVENTS_CTTO{};
inline constexpr Register<0x40000128> EVENTS_CTSTARTED{};
inline constexpr Register<0x4000012C> EVENTS_CTSTOPPED{};
inline constexpr Register<0x40000304> INTENSET{};
inline constexpr Register<0x40000308> INTENCLR{};
inline constexpr Register<0x40000408> HFCLKRUN{};
inline constexpr Register<0x4000040C> HFCLKSTAT{};
inline constexpr Register<0x40000414> LFCLKRUN{};
inline constexpr Register<0x40000418> LFCLKSTAT{};
inline constexpr Register<0x4000041C> LFCLKSRCCOPY{};
inline constexpr Register<0x40000518> LFCLKSRC{};
inline constexpr Register<0x40000528> HFXODEBOUNCE{};
inline constexpr Register<0x4000052C> LFXODEBOUNCE{};
inline constexpr Register<0x40000538> CTIV{};
inline constexpr Register<0x4000055C> TRACECONFIG{};
}

namespace palmbots::board::FICR {
inline constexpr Register<0x10000010> CODEPAGESIZE{};
inline constexpr Register<0x10000014> CODESIZE{};
inline constexpr Registers<0x10000060, 4> DEVICEID{};
inline constexpr Registers<0x10000080, 4> ER{};
inline constexpr Registers<0x10000090, 4> IR{};
inline constexpr Register<0x100000A0> DEVICEADDRTYPE{};
inline constexpr Registers<0x100000A4, 4> DEVICEADDR{};
inline constexpr Register<0x10000100> INFO_PART{};
inline constexpr Register<0x10000104> INFO_VARIANT{};
inline constexpr Register<0x10000108> INFO_PACKAGE{};
inline constexpr Register<0x1000010C> INFO_RAM{};
inline constexpr Register<0x10000110> INFO_FLASH{};
inline constexpr Registers<0x10000350, 4> PRODTEST{};
inline constexpr Register<0x10000404> TEMP_A0{};
inline constexpr Register<0x10000408> TEMP_A1{};
inline constexpr Register<0x1000040C> TEMP_A2{};
inline constexpr Register<0x10000410> TEMP_A3{};
inline constexpr Register<0x10000414> TEMP_A4{};
inline constexpr Register<0x10000418> TEMP_A5{};
inline constexpr Register<0x1000041C> TEMP_B0{};
inline constexpr Register<0x10000420> TEMP_B1{};
inline constexpr Register<0x10000424> TEMP_B2{};
inline constexpr Register<0x10000428> TEMP_B3{};
inline constexpr Register<0x1000042C> TEMP_B4{};
inline constexpr Register<0x10000430> TEMP_B5{};
inline constexpr Register<0x10000434> TEMP_T0{};
inline constexpr Register<0x10000438> TEMP_T1{};
inline constexpr Register<0x1000043C> TEMP_T2{};
inline constexpr Register<0x10000440> TEMP_T3{};
inline constexpr Register<0x10000444> TEMP_T4{};
inline constexpr Register<0x10000450> NFC_TAGHEADER0{};
inline constexpr Register<0x10000454> NFC_TAGHEADER1{};
inline constexpr Register<0x10000458> NFC_TAGHEADER2{};
inline constexpr Register<0x1000045C> NFC_TAGHEADER3{};
}

namespace palmbots::board::NVMC {
inline constexpr Register<0x4001E400> READY{};
inline constexpr Register<0x4001E408> READYNEXT{};
inline constexpr Register<0x4001E504> CONFIG{};
inline constexpr Register<0x4001E508> ERASEPAGE{};
inline constexpr Register<0x4001E508> ERASEPCR1{};
inline constexpr Register<0x4001E50C> ERASEALL{};
inline constexpr Register<0x4001E510> ERASEPCR0{};
inline constexpr Register<0x4001E514> ERASEUICR{};
inline constexpr Register<0x4001E518> ERASEPAGEPARTIAL{};
inline constexpr Register<0x4001E51C> ERASEPAGEPARTIALCFG{};
inline constexpr Register<0x4001E540> ICACHECNF{};
inline constexpr Register<0x4001E548> IHIT{};
inline constexpr Register<0x4001E54C> IMISS{};
}

namespace palmbots::board::P0 {
inline constexpr Register<0x50000504> OUT{};
inline constexpr Register<0x50000508> OUTSET{};
inline constexpr Register<0x5000050C> OUTCLR{};
inline constexpr Register<0x50000510> IN{};
inline constexpr Register<0x50000514> DIR{};
inline constexpr Register<0x50000518> DIRSET{};
inline constexpr Register<0x5000051C> DIRCLR{};
inline constexpr Register<0x50000520> LATCH{};
inline constexpr Register<0x50000524> DETECTMODE{};
inline constexpr Registers<0x50000700, 4> PIN_CNF{};
}

namespace palmbots::board::P1 {
inline constexpr Register<0x50000804> OUT{};
inline constexpr Register<0x50000808> OUTSET{};
inline constexpr Register<0x5000080C> OUTCLR{};
inline constexpr Register<0x50000810> IN{};
inline constexpr Register<0x50000814> DIR{};
inline constexpr Register<0x50000818> DIRSET{};
inline constexpr Register<0x5000081C> DIRCLR{};
inline constexpr Register<0x50000820> LATCH{};
inline constexpr Register<0x50000824> DETECTMODE{};
inline constexpr Registers<0x50000A00, 4> PIN_CNF{};
}

namespace palmbots::board::POWER {
inline constexpr Register<0x40000078> TASKS_CONSTLAT{};
inline constexpr Register<0x4000007C> TASKS_LOWPWR{};
inline constexpr Register<0x40000108> EVENTS_POFWARN{};
inline constexpr Register<0x40000114> EVENTS_SLEEPENTER{};
inline constexpr Register<0x40000118> EVENTS_SLEEPEXIT{};
inline constexpr Register<0x4000011C> EVENTS_USBDETECTED{};
inline constexpr Register<0x40000120> EVENTS_USBREMOVED{};
inline constexpr Register<0x40000124> EVENTS_USBPWRRDY{};
inline constexpr Register<0x40000304> INTENSET{};
inline constexpr Register<0x40000308> INTENCLR{};
inline constexpr Register<0x40000400> RESETREAS{};
inline constexpr Register<0x40000428> RAMSTATUS{};
inline constexpr Register<0x40000438> USBREGSTATUS{};
inline constexpr Register<0x40000500> SYSTEMOFF{};
inline constexpr Register<0x40000510> POFCON{};
inline constexpr Register<0x4000051C> GPREGRET{};
inline constexpr Register<0x40000520> GPREGRET2{};
inline constexpr Register<0x40000578> DCDCEN{};
inline constexpr Register<0x40000640> MAINREGSTATUS{};
inline constexpr Register<0x40000900> RAM0_POWER{};
inline constexpr Register<0x40000904> RAM0_POWERSET{};
inline constexpr Register<0x40000908> RAM0_POWERCLR{};
inline constexpr Register<0x40000910> RAM1_POWER{};
inline constexpr Register<0x40000914> RAM1_POWERSET{};
inline constexpr Register<0x40000918> RAM1_POWERCLR{};
inline constexpr Register<0x40000920> RAM2_POWER{};
inline constexpr Register<0x40000924> RAM2_POWERSET{};
inline constexpr Register<0x40000928> RAM2_POWERCLR{};
inline constexpr Register<0x40000930> RAM3_POWER{};
inline constexpr Register<0x40000934> RAM3_POWERSET{};
inline constexpr Register<0x40000938> RAM3_POWERCLR{};
inline constexpr Register<0x40000940> RAM4_POWER{};
inline constexpr Register<0x40000944> RAM4_POWERSET{};
inline constexpr Register<0x40000948> RAM4_POWERCLR{};
inline constexpr Register<0x40000950> RAM5_POWER{};
inline constexpr Register<0x40000954> RAM5_POWERSET{};
inline constexpr Register<0x40000958> RAM5_POWERCLR{};
inline constexpr Register<0x40000960> RAM6_POWER{};
inline constexpr Register<0x40000964> RAM6_POWERSET{};
inline constexpr Register<0x40000968> RAM6_POWERCLR{};
inline constexpr Register<0x40000970> RAM7_POWER{};
inline constexpr Register<0x40000974> RAM7_POWERSET{};
inline constexpr Register<0x40000978> RAM7_POWERCLR{};
inline constexpr Register<0x40000980> RAM8_POWER{};
inline constexpr Register<0x40000984> RAM8_POWERSET{};
inline constexpr Register<0x40000988> RAM8_POWERCLR{};
}

namespace palmbots::board::PPI {
inline constexpr Register<0x4001F000> TASKS_CHG0_EN{};
inline constexpr Register<0x4001F004> TASKS_CHG0_DIS{};
inline constexpr Register<0x4001F008> TASKS_CHG1_EN{};
inline constexpr Register<0x4001F00C> TASKS_CHG1_DIS{};
inline constexpr Register<0x4001F010> TASKS_CHG2_EN{};
inline constexpr Register<0x4001F014> TASKS_CHG2_DIS{};
inline constexpr Register<0x4001F018> TASKS_CHG3_EN{};
inline constexpr Register<0x4001F01C> TASKS_CHG3_DIS{};
inline constexpr Register<0x4001F020> TASKS_CHG4_EN{};
inline constexpr Register<0x4001F024> TASKS_CHG4_DIS{};
inline constexpr Register<0x4001F028> TASKS_CHG5_EN{};
inline constexpr Register<0x4001F02C> TASKS_CHG5_DIS{};
inline constexpr Register<0x4001F500> CHEN{};
inline constexpr Register<0x4001F504> CHENSET{};
inline constexpr Register<0x4001F508> CHENCLR{};
inline constexpr Register<0x4001F510> CH0_EEP{};
inline constexpr Register<0x4001F514> CH0_TEP{};
inline constexpr Register<0x4001F518> CH1_EEP{};
inline constexpr Register<0x4001F51C> CH1_TEP{};
inline constexpr Register<0x4001F520> CH2_EEP{};
inline constexpr Register<0x4001F524> CH2_TEP{};
inline constexpr Register<0x4001F528> CH3_EEP{};
inline constexpr Register<0x4001F52C> CH3_TEP{};
inline constexpr Register<0x4001F530> CH4_EEP{};
inline constexpr Register<0x4001F534> CH4_TEP{};
inline constexpr Register<0x4001F538> CH5_EEP{};
inline constexpr Register<0x4001F53C> CH5_TEP{};
inline constexpr Register<0x4001F540> CH6_EEP{};
inline constexpr Register<0x4001F544> CH6_TEP{};
inline constexpr Register<0x4001F548> CH7_EEP{};
inline constexpr Register<0x4001F54C> CH7_TEP{};
inline constexpr Register<0x4001F550> CH8_EEP{};
inline constexpr Register<0x4001F554> CH8_TEP{};
inline constexpr Register<0x4001F558> CH9_EEP{};
inline constexpr Register<0x4001F55C> CH9_TEP{};
inline constexpr Register<0x4001F560> CH10_EEP{};
inline constexpr Register<0x4001F564> CH10_TEP{};
inline constexpr Register<0x4001F568> CH11_EEP{};
inline constexpr Register<0x4001F56C> CH11_TEP{};
inline constexpr Register<0x4001F570> CH12_EEP{};
inline constexpr Register<0x4001F574> CH12_TEP{};
inline constexpr Register<0x4001F578> CH13_EEP{};
inline constexpr Register<0x4001F57C> CH13_TEP{};
inline constexpr Register<0x4001F580> CH14_EEP{};
inline constexpr Register<0x4001F584> CH14_TEP{};
inline constexpr Register<0x4001F588> CH15_EEP{};
inline constexpr Register<0x4001F58C> CH15_TEP{};
inline constexpr Register<0x4001F590> CH16_EEP{};
inline constexpr Register<0x4001F594> CH16_TEP{};
inline constexpr Register<0x4001F598> CH17_EEP{};
inline constexpr Register<0x4001F59C> CH17_TEP{};
inline constexpr Register<0x4001F5A0> CH18_EEP{};
inline constexpr Register<0x4001F5A4> CH18_TEP{};
inline constexpr Register<0x4001F5A8> CH19_EEP{};
inline constexpr Register<0x4001F5AC> CH19_TEP{};
inline constexpr Registers<0x4001F800, 4> CHG{};
inline constexpr Register<0x4001F910> FORK0_TEP{};
inline constexpr Register<0x4001F914> FORK1_TEP{};
inline constexpr Register<0x4001F918> FORK2_TEP{};
inline constexpr Register<0x4001F91C> FORK3_TEP{};
inline constexpr Register<0x4001F920> FORK4_TEP{};
inline constexpr Register<0x4001F924> FORK5_TEP{};
inline constexpr Register<0x4001F928> FORK6_TEP{};
inline constexpr Register<0x4001F92C> FORK7_TEP{};
inline constexpr Register<0x4001F930> FORK8_TEP{};
inline constexpr Register<0x4001F934> FORK9_TEP{};
inline constexpr Register<0x4001F938> FORK10_TEP{};
inline constexpr Register<0x4001F93C> FORK11_TEP{};
inline constexpr Register<0x4001F940> FORK12_TEP{};
inline constexpr Register<0x4001F944> FORK13_TEP{};
inline constexpr Register<0x4001F948> FORK14_TEP{};
inline constexpr Register<0x4001F94C> FORK15_TEP{};
inline constexpr Register<0x4001F950> FORK16_TEP{};
inline constexpr Register<0x4001F954> FORK17_TEP{};
inline constexpr Register<0x4001F958> FORK18_TEP{};
inline constexpr Register<0x4001F95C> FORK19_TEP{};
inline constexpr Register<0x4001F960> FORK20_TEP{};
inline constexpr Register<0x4001F964> FORK21_TEP{};
inline constexpr Register<0x4001F968> FORK22_TEP{};
inline constexpr Register<0x4001F96C> FORK23_TEP{};
inline constexpr Register<0x4001F970> FORK24_TEP{};
inline constexpr Register<0x4001F974> FORK25_TEP{};
inline constexpr Register<0x4001F978> FORK26_TEP{};
inline constexpr Register<0x4001F97C> FORK27_TEP{};
inline constexpr Register<0x4001F980> FORK28_TEP{};
inline constexpr Register<0x4001F984> FORK29_TEP{};
inline constexpr Register<0x4001F988> FORK30_TEP{};
inline constexpr Register<0x4001F98C> FORK31_TEP{};
}

namespace palmbots::board::PWM0 {
inline constexpr Register<0x4001C004> TASKS_STOP{};
inline constexpr Registers<0x4001C008, 4> TASKS_SEQSTART{};
inline constexpr Register<0x4001C010> TASKS_NEXTSTEP{};
inline constexpr Register<0x4001C104> EVENTS_STOPPED{};
inline constexpr Registers<0x4001C108, 4> EVENTS_SEQSTARTED{};
inline constexpr Registers<0x4001C110, 4> EVENTS_SEQEND{};
inline constexpr Register<0x4001C118> EVENTS_PWMPERIODEND{};
inline constexpr Register<0x4001C11C> EVENTS_LOOPSDONE{};
inline constexpr Register<0x4001C200> SHORTS{};
inline constexpr Register<0x4001C300> INTEN{};
inline constexpr Register<0x4001C304> INTENSET{};
inline constexpr Register<0x4001C308> INTENCLR{};
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
inline constexpr Register<0x4001C540> SEQ1_PTR{};
inline constexpr Register<0x4001C544> SEQ1_CNT{};
inline constexpr Register<0x4001C548> SEQ1_REFRESH{};
inline constexpr Register<0x4001C54C> SEQ1_ENDDELAY{};
inline constexpr Registers<0x4001C560, 4> PSEL_OUT{};
}

namespace palmbots::board::RADIO {
inline constexpr Register<0x40001000> TASKS_TXEN{};
inline constexpr Register<0x40001004> TASKS_RXEN{};
inline constexpr Register<0x40001008> TASKS_START{};
inline constexpr Register<0x4000100C> TASKS_STOP{};
inline constexpr Register<0x40001010> TASKS_DISABLE{};
inline constexpr Register<0x40001014> TASKS_RSSISTART{};
inline constexpr Register<0x40001018> TASKS_RSSISTOP{};
inline constexpr Register<0x4000101C> TASKS_BCSTART{};
inline constexpr Register<0x40001020> TASKS_BCSTOP{};
inline constexpr Register<0x40001024> TASKS_EDSTART{};
inline constexpr Register<0x40001028> TASKS_EDSTOP{};
inline constexpr Register<0x4000102C> TASKS_CCASTART{};
inline constexpr Register<0x40001030> TASKS_CCASTOP{};
inline constexpr Register<0x40001100> EVENTS_READY{};
inline constexpr Register<0x40001104> EVENTS_ADDRESS{};
inline constexpr Register<0x40001108> EVENTS_PAYLOAD{};
inline constexpr Register<0x4000110C> EVENTS_END{};
inline constexpr Register<0x40001110> EVENTS_DISABLED{};
inline constexpr Register<0x40001114> EVENTS_DEVMATCH{};
inline constexpr Register<0x40001118> EVENTS_DEVMISS{};
inline constexpr Register<0x4000111C> EVENTS_RSSIEND{};
inline constexpr Register<0x40001128> EVENTS_BCMATCH{};
inline constexpr Register<0x40001130> EVENTS_CRCOK{};
inline constexpr Register<0x40001134> EVENTS_CRCERROR{};
inline constexpr Register<0x40001138> EVENTS_FRAMESTART{};
inline constexpr Register<0x4000113C> EVENTS_EDEND{};
inline constexpr Register<0x40001140> EVENTS_EDSTOPPED{};
inline constexpr Register<0x40001144> EVENTS_CCAIDLE{};
inline constexpr Register<0x40001148> EVENTS_CCABUSY{};
inline constexpr Register<0x4000114C> EVENTS_CCASTOPPED{};
inline constexpr Register<0x40001150> EVENTS_RATEBOOST{};
inline constexpr Register<0x40001154> EVENTS_TXREADY{};
inline constexpr Register<0x40001158> EVENTS_RXREADY{};
inline constexpr Register<0x4000115C> EVENTS_MHRMATCH{};
inline constexpr Register<0x40001168> EVENTS_SYNC{};
inline constexpr Register<0x4000116C> EVENTS_PHYEND{};
inline constexpr Register<0x40001170> EVENTS_CTEPRESENT{};
inline constexpr Register<0x40001200> SHORTS{};
inline constexpr Register<0x40001304> INTENSET{};
inline constexpr Register<0x40001308> INTENCLR{};
inline constexpr Register<0x40001400> CRCSTATUS{};
inline constexpr Register<0x40001408> RXMATCH{};
inline constexpr Register<0x4000140C> RXCRC{};
inline constexpr Register<0x40001410> DAI{};
inline constexpr Register<0x40001414> PDUSTAT{};
inline constexpr Register<0x4000144C> CTESTATUS{};
inline constexpr Register<0x40001458> DFESTATUS{};
inline constexpr Register<0x40001504> PACKETPTR{};
inline constexpr Register<0x40001508> FREQUENCY{};
inline constexpr Register<0x4000150C> TXPOWER{};
inline constexpr Register<0x40001510> MODE{};
inline constexpr Register<0x40001514> PCNF0{};
inline constexpr Register<0x40001518> PCNF1{};
inline constexpr Register<0x4000151C> BASE0{};
inline constexpr Register<0x40001520> BASE1{};
inline constexpr Register<0x40001524> PREFIX0{};
inline constexpr Register<0x40001528> PREFIX1{};
inline constexpr Register<0x4000152C> TXADDRESS{};
inline constexpr Register<0x40001530> RXADDRESSES{};
inline constexpr Register<0x40001534> CRCCNF{};
inline constexpr Register<0x40001538> CRCPOLY{};
inline constexpr Register<0x4000153C> CRCINIT{};
inline constexpr Register<0x40001544> TIFS{};
inline constexpr Register<0x40001548> RSSISAMPLE{};
inline constexpr Register<0x40001550> STATE{};
inline constexpr Register<0x40001554> DATAWHITEIV{};
inline constexpr Register<0x40001560> BCC{};
inline constexpr Registers<0x40001600, 4> DAB{};
inline constexpr Registers<0x40001620, 4> DAP{};
inline constexpr Register<0x40001640> DACNF{};
inline constexpr Register<0x40001644> MHRMATCHCONF{};
inline constexpr Register<0x40001648> MHRMATCHMAS{};
inline constexpr Register<0x40001650> MODECNF0{};
inline constexpr Register<0x40001660> SFD{};
inline constexpr Register<0x40001664> EDCNT{};
inline constexpr Register<0x40001668> EDSAMPLE{};
inline constexpr Register<0x4000166C> CCACTRL{};
inline constexpr Register<0x40001900> DFEMODE{};
inline constexpr Register<0x40001904> CTEINLINECONF{};
inline constexpr Register<0x40001910> DFECTRL1{};
inline constexpr Register<0x40001914> DFECTRL2{};
inline constexpr Register<0x40001928> SWITCHPATTERN{};
inline constexpr Register<0x4000192C> CLEARPATTERN{};
inline constexpr Registers<0x40001930, 4> PSEL_DFEGPIO{};
inline constexpr Register<0x40001950> DFEPACKET_PTR{};
inline constexpr Register<0x40001954> DFEPACKET_MAXCNT{};
inline constexpr Register<0x40001958> DFEPACKET_AMOUNT{};
inline constexpr Register<0x40001FFC> POWER{};
}

namespace palmbots::board::RNG {
inline constexpr Register<0x4000D000> TASKS_START{};
inline constexpr Register<0x4000D004> TASKS_STOP{};
inline constexpr Register<0x4000D100> EVENTS_VALRDY{};
inline constexpr Register<0x4000D200> SHORTS{};
inline constexpr Register<0x4000D304> INTENSET{};
inline constexpr Register<0x4000D308> INTENCLR{};
inline constexpr Register<0x4000D504> CONFIG{};
inline constexpr Register<0x4000D508> VALUE{};
}

namespace palmbots::board::SAADC {
inline constexpr Register<0x40007000> TASKS_START{};
inline constexpr Register<0x40007004> TASKS_SAMPLE{};
inline constexpr Register<0x40007008> TASKS_STOP{};
inline constexpr Register<0x4000700C> TASKS_CALIBRATEOFFSET{};
inline constexpr Register<0x40007100> EVENTS_STARTED{};
inline constexpr Register<0x40007104> EVENTS_END{};
inline constexpr Register<0x40007108> EVENTS_DONE{};
inline constexpr Register<0x4000710C> EVENTS_RESULTDONE{};
inline constexpr Register<0x40007110> EVENTS_CALIBRATEDONE{};
inline constexpr Register<0x40007114> EVENTS_STOPPED{};
inline constexpr Register<0x40007118> EVENTS_CH0_LIMITH{};
inline constexpr Register<0x4000711C> EVENTS_CH0_LIMITL{};
inline constexpr Register<0x40007120> EVENTS_CH1_LIMITH{};
inline constexpr Register<0x40007124> EVENTS_CH1_LIMITL{};
inline constexpr Register<0x40007128> EVENTS_CH2_LIMITH{};
inline constexpr Register<0x4000712C> EVENTS_CH2_LIMITL{};
inline constexpr Register<0x40007130> EVENTS_CH3_LIMITH{};
inline constexpr Register<0x40007134> EVENTS_CH3_LIMITL{};
inline constexpr Register<0x40007138> EVENTS_CH4_LIMITH{};
inline constexpr Register<0x4000713C> EVENTS_CH4_LIMITL{};
inline constexpr Register<0x40007140> EVENTS_CH5_LIMITH{};
inline constexpr Register<0x40007144> EVENTS_CH5_LIMITL{};
inline constexpr Register<0x40007148> EVENTS_CH6_LIMITH{};
inline constexpr Register<0x4000714C> EVENTS_CH6_LIMITL{};
inline constexpr Register<0x40007150> EVENTS_CH7_LIMITH{};
inline constexpr Register<0x40007154> EVENTS_CH7_LIMITL{};
inline constexpr Register<0x40007300> INTEN{};
inline constexpr Register<0x40007304> INTENSET{};
inline constexpr Register<0x40007308> INTENCLR{};
inline constexpr Register<0x40007400> STATUS{};
inline constexpr Register<0x40007500> ENABLE{};
inline constexpr Register<0x40007510> CH0_PSELP{};
inline constexpr Register<0x40007514> CH0_PSELN{};
inline constexpr Register<0x40007518> CH0_CONFIG{};
inline constexpr Register<0x4000751C> CH0_LIMIT{};
inline constexpr Register<0x40007520> CH1_PSELP{};
inline constexpr Register<0x40007524> CH1_PSELN{};
inline constexpr Register<0x40007528> CH1_CONFIG{};
inline constexpr Register<0x4000752C> CH1_LIMIT{};
inline constexpr Register<0x40007530> CH2_PSELP{};
inline constexpr Register<0x40007534> CH2_PSELN{};
inline constexpr Register<0x40007538> CH2_CONFIG{};
inline constexpr Register<0x4000753C> CH2_LIMIT{};
inline constexpr Register<0x40007540> CH3_PSELP{};
inline constexpr Register<0x40007544> CH3_PSELN{};
inline constexpr Register<0x40007548> CH3_CONFIG{};
inline constexpr Register<0x4000754C> CH3_LIMIT{};
inline constexpr Register<0x40007550> CH4_PSELP{};
inline constexpr Register<0x40007554> CH4_PSELN{};
inline constexpr Register<0x40007558> CH4_CONFIG{};
inline constexpr Register<0x4000755C> CH4_LIMIT{};
inline constexpr Register<0x40007560> CH5_PSELP{};
inline constexpr Register<0x40007564> CH5_PSELN{};
inline constexpr Register<0x40007568> CH5_CONFIG{};
inline constexpr Register<0x4000756C> CH5_LIMIT{};
inline constexpr Register<0x40007570> CH6_PSELP{};
inline constexpr Register<0x40007574> CH6_PSELN{};
inline constexpr Register<0x40007578> CH6_CONFIG{};
inline constexpr Register<0x4000757C> CH6_LIMIT{};
inline constexpr Register<0x40007580> CH7_PSELP{};
inline constexpr Register<0x40007584> CH7_PSELN{};
inline constexpr Register<0x40007588> CH7_CONFIG{};
inline constexpr Register<0x4000758C> CH7_LIMIT{};
inline constexpr Register<0x400075F0> RESOLUTION{};
inline constexpr Register<0x400075F4> OVERSAMPLE{};
inline constexpr Register<0x400075F8> SAMPLERATE{};
inline constexpr Register<0x4000762C> RESULT_PTR{};
inline constexpr Register<0x40007630> RESULT_MAXCNT{};
inline constexpr Register<0x40007634> RESULT_AMOUNT{};
}

namespace palmbots::board::TIMER0 {
inline constexpr Register<0x40008000> TASKS_START{};
inline constexpr Register<0x40008004> TASKS_STOP{};
inline constexpr Register<0x40008008> TASKS_COUNT{};
inline constexpr Register<0x4000800C> TASKS_CLEAR{};
inline constexpr Register<0x40008010> TASKS_SHUTDOWN{};
inline constexpr Registers<0x40008040, 4> TASKS_CAPTURE{};
inline constexpr Registers<0x40008140, 4> EVENTS_COMPARE{};
inline constexpr Register<0x40008200> SHORTS{};
inline constexpr Register<0x40008304> INTENSET{};
inline constexpr Register<0x40008308> INTENCLR{};
inline constexpr Register<0x40008504> MODE{};
inline constexpr Register<0x40008508> BITMODE{};
inline constexpr Register<0x40008510> PRESCALER{};
inline constexpr Registers<0x40008540, 4> CC{};
}

namespace palmbots::board::TIMER1 {
inline constexpr Register<0x40009000> TASKS_START{};
inline constexpr Register<0x40009004> TASKS_STOP{};
inline constexpr Register<0x40009008> TASKS_COUNT{};
inline constexpr Register<0x4000900C> TASKS_CLEAR{};
inline constexpr Register<0x40009010> TASKS_SHUTDOWN{};
inline constexpr Registers<0x40009040, 4> TASKS_CAPTURE{};
inline constexpr Registers<0x40009140, 4> EVENTS_COMPARE{};
inline constexpr Register<0x40009200> SHORTS{};
inline constexpr Register<0x40009304> INTENSET{};
inline constexpr Register<0x40009308> INTENCLR{};
inline constexpr Register<0x40009504> MODE{};
inline constexpr Register<0x40009508> BITMODE{};
inline constexpr Register<0x40009510> PRESCALER{};
inline constexpr Registers<0x40009540, 4> CC{};
}

namespace palmbots::board::TWIM0 {
inline constexpr Register<0x40003000> TASKS_STARTRX{};
inline constexpr Register<0x40003008> TASKS_STARTTX{};
inline constexpr Register<0x40003014> TASKS_STOP{};
inline constexpr Register<0x4000301C> TASKS_SUSPEND{};
inline constexpr Register<0x40003020> TASKS_RESUME{};
inline constexpr Register<0x40003104> EVENTS_STOPPED{};
inline constexpr Register<0x40003124> EVENTS_ERROR{};
inline constexpr Register<0x40003148> EVENTS_SUSPENDED{};
inline constexpr Register<0x4000314C> EVENTS_RXSTARTED{};
inline constexpr Register<0x40003150> EVENTS_TXSTARTED{};
inline constexpr Register<0x4000315C> EVENTS_LASTRX{};
inline constexpr Register<0x40003160> EVENTS_LASTTX{};
inline constexpr Register<0x40003200> SHORTS{};
inline constexpr Register<0x40003300> INTEN{};
inline constexpr Register<0x40003304> INTENSET{};
inline constexpr Register<0x40003308> INTENCLR{};
inline constexpr Register<0x400034C4> ERRORSRC{};
inline constexpr Register<0x40003500> ENABLE{};
inline constexpr Register<0x40003508> PSEL_SCL{};
inline constexpr Register<0x4000350C> PSEL_SDA{};
inline constexpr Register<0x40003524> FREQUENCY{};
inline constexpr Register<0x40003534> RXD_PTR{};
inline constexpr Register<0x40003538> RXD_MAXCNT{};
inline constexpr Register<0x4000353C> RXD_AMOUNT{};
inline constexpr Register<0x40003540> RXD_LIST{};
inline constexpr Register<0x40003544> TXD_PTR{};
inline constexpr Register<0x40003548> TXD_MAXCNT{};
inline constexpr Register<0x4000354C> TXD_AMOUNT{};
inline constexpr Register<0x40003550> TXD_LIST{};
inline constexpr Register<0x40003588> ADDRESS{};
}

namespace palmbots::board::UARTE0 {
inline constexpr Register<0x40002000> TASKS_STARTRX{};
inline constexpr Register<0x40002004> TASKS_STOPRX{};
inline constexpr Register<0x40002008> TASKS_STARTTX{};
inline constexpr Register<0x4000200C> TASKS_STOPTX{};
inline constexpr Register<0x4000202C> TASKS_FLUSHRX{};
inline constexpr Register<0x40002100> EVENTS_CTS{};
inline constexpr Register<0x40002104> EVENTS_NCTS{};
inline constexpr Register<0x40002108> EVENTS_RXDRDY{};
inline constexpr Register<0x40002110> EVENTS_ENDRX{};
inline constexpr Register<0x4000211C> EVENTS_TXDRDY{};
inline constexpr Register<0x40002120> EVENTS_ENDTX{};
inline constexpr Register<0x40002124> EVENTS_ERROR{};
inline constexpr Register<0x40002144> EVENTS_RXTO{};
inline constexpr Register<0x4000214C> EVENTS_RXSTARTED{};
inline constexpr Register<0x40002150> EVENTS_TXSTARTED{};
inline constexpr Register<0x40002158> EVENTS_TXSTOPPED{};
inline constexpr Register<0x40002200> SHORTS{};
inline constexpr Register<0x40002300> INTEN{};
inline constexpr Register<0x40002304> INTENSET{};
inline constexpr Register<0x40002308> INTENCLR{};
inline constexpr Register<0x40002480> ERRORSRC{};
inline constexpr Register<0x40002500> ENABLE{};
inline constexpr Register<0x40002508> PSEL_RTS{};
inline constexpr Register<0x4000250C> PSEL_TXD{};
inline constexpr Register<0x40002510> PSEL_CTS{};
inline constexpr Register<0x40002514> PSEL_RXD{};
inline constexpr Register<0x40002524> BAUDRATE{};
inline constexpr Register<0x40002534> RXD_PTR{};
inline constexpr Register<0x40002538> RXD_MAXCNT{};
inline constexpr Register<0x4000253C> RXD_AMOUNT{};
inline constexpr Register<0x40002544> TXD_PTR{};
inline constexpr Register<0x40002548> TXD_MAXCNT{};
inline constexpr Register<0x4000254C> TXD_AMOUNT{};
inline constexpr Register<0x4000256C> CONFIG{};
}

namespace palmbots::board::UICR {
inline constexpr Registers<0x10001014, 4> NRFFW{};
inline constexpr Registers<0x10001050, 4> NRFHW{};
inline constexpr Registers<0x10001080, 4> CUSTOMER{};
inline constexpr Registers<0x10001200, 4> PSELRESET{};
inline constexpr Register<0x10001208> APPROTECT{};
inline constexpr Register<0x1000120C> NFCPINS{};
inline constexpr Register<0x10001210> DEBUGCTRL{};
inline constexpr Register<0x10001304> REGOUT0{};
}

namespace palmbots::board::WDT {
inline constexpr Register<0x40010000> TASKS_START{};
inline constexpr Register<0x40010100> EVENTS_TIMEOUT{};
inline constexpr Register<0x40010304> INTENSET{};
inline constexpr Register<0x40010308> INTENCLR{};
inline constexpr Register<0x40010400> RUNSTATUS{};
inline constexpr Register<0x40010404> REQSTATUS{};
inline constexpr Register<0x40010504> CRV{};
inline constexpr Register<0x40010508> RREN{};
inline constexpr Register<0x4001050C> CONFIG{};
inline constexpr Registers<0x40010600, 4> RR{};
}

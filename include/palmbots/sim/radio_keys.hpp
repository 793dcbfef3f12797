// SPDX-License-Identifier: Apache-2.0
// The section `radio` of a scene: the links, and what happens to messages. Times in s.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "palmbots/sim/radio_channel.hpp"
#include "palmbots/sim/scene_key.hpp"

namespace palmbots {

// A period in which no message of this sender arrives.
struct OutageSpec {
  std::uint64_t sender = 0;  // 0: left, 1: right, 2: the station
  double from = 0;
  double to = 0;
};
inline constexpr Key outage_keys[] = {
    choice<&OutageSpec::sender>("sender", sender_choices),
    number<&OutageSpec::from>("start_s", Unit::s, 0, 1e6),
    number<&OutageSpec::to>("end_s", Unit::s, 0, 1e6),
};

// A scheduled fault of one message.
struct MessageFaultSpec {
  std::uint32_t link = 0;     // as in MessageFault
  std::uint32_t message = 1;  // number among all on this link, from 1
  std::uint32_t effect = 0;   // as in MessageEffect
  double late = -1;           // in addition to the delay of the link; < 0: the message is lost
};
inline constexpr Choices effect_choices(0, "lost", "delayed", "duplicated");
inline constexpr Key message_fault_keys[] = {
    source_choice("sender", sender_choices, 0),
    source_choice("receiver", side_choices),
    derived<&MessageFaultSpec::link>(),
    whole<&MessageFaultSpec::message>("message", 1, 1e6),
    choice<&MessageFaultSpec::effect>("effect", effect_choices),
    number<&MessageFaultSpec::late>("delay_s", Unit::s, 0, 10),
};

// What a link does to a message: of all links, or of those from one sender.
template <class Section>
struct LinkKeys {
  static constexpr Key latency = number<&Section::latency>("latency_s", Unit::s, 0, 10);
  static constexpr Key jitter = number<&Section::jitter>("jitter_s", Unit::s, 0, 10);
  static constexpr Key loss = number<&Section::loss>("loss", Unit::none, 0, 1);
};

// What differs on the links from one sender; a negative value is that of all links.
struct DirectionSpec {
  double latency = -1;
  double jitter = -1;
  double loss = -1;
};
inline constexpr Key direction_keys[] = {
    LinkKeys<DirectionSpec>::latency,
    LinkKeys<DirectionSpec>::jitter,
    LinkKeys<DirectionSpec>::loss,
};

struct RadioTrace;  // sim/recorded_traces.hpp

struct RadioSpec {
  double latency = 0.05;
  double jitter = 0;
  bool reorders = false;
  bool sessions = true;  // packets are judged as on the wire
  double loss = 0;
  double burst_share = 0;  // share of the time in which a link is dead
  double burst_mean = 0.1;
  double duplicate = 0;
  double corruption = 0;
  double airtime = 0;  // 0: no collisions
  double replay = 0;   // probability that an attacker sends a packet again
  double replay_delay = 1;
  double beacon = 0.05;
  double lease = 0;  // 0: computed (table_lease.hpp, control/resilient_timing.hpp)
  std::array<OutageSpec, max_outages> outages{};
  std::size_t outage_count = 0;
  std::array<MessageFaultSpec, max_message_faults> message_faults{};
  std::size_t message_fault_count = 0;
  // A recording that takes the place of losses and bursts, and of delays if it has them, or null.
  const RadioTrace* fates = nullptr;
};
inline constexpr Key radio_keys[] = {
    LinkKeys<RadioSpec>::latency,
    LinkKeys<RadioSpec>::jitter,
    flag<&RadioSpec::reorders>("reorder"),
    flag<&RadioSpec::sessions>("sessions"),
    LinkKeys<RadioSpec>::loss,
    number<&RadioSpec::burst_share>("burst_fraction", Unit::none, 0, 0.99),
    number<&RadioSpec::burst_mean>("burst_s", Unit::s, 0.0001, 1e6),
    number<&RadioSpec::duplicate>("duplicate", Unit::none, 0, 1),
    number<&RadioSpec::corruption>("corruption", Unit::none, 0, 1),
    number<&RadioSpec::airtime>("airtime_s", Unit::s, 0, 10),
    number<&RadioSpec::replay>("replay", Unit::none, 0, 1),
    number<&RadioSpec::replay_delay>("replay_within_s", Unit::s, 0.0001, 1e6),
    number<&RadioSpec::beacon>("beacon_s", Unit::s, 0.0001, 1e6),
    number<&RadioSpec::lease>("lease_s", Unit::s, 0.0001, 1e6),
};
inline constexpr RecordList radio_lists[] = {
    records<&RadioSpec::outages, &RadioSpec::outage_count>("outages", outage_keys),
    records<&RadioSpec::message_faults, &RadioSpec::message_fault_count>("script",
                                                                         message_fault_keys),
};

}  // namespace palmbots

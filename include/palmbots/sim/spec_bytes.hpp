// SPDX-License-Identifier: Apache-2.0
// A spec as bytes: every member that the table of keys names, as a little-endian double, one after
// the other, and then the recordings that it replays. Equal specs have equal bytes, on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "palmbots/sim/recorded_traces.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// The recording with this content, kept for as long as the program runs.
template <class Trace>
const Trace* keep(Trace trace) {
  static std::mutex mutex;
  static std::list<Trace> kept;
  const std::scoped_lock lock(mutex);
  for (const Trace& one : kept) {
    if (one == trace) return &one;
  }
  return &kept.emplace_back(std::move(trace));
}

namespace detail {

// Calls visit(key, record) for each member. `list` is called before the records of a list with the
// list and its owner; it returns their number.
template <class Visit, class List>
void for_each_member(Spec& spec, Visit&& visit, List&& list) {
  for (const Section& section : sections) {
    for (std::size_t holder = 0; holder < section.holder_count(); ++holder) {
      void* owner = section.at(spec, holder);
      for (const Key& key : section.keys) {
        if (key.get != nullptr) visit(key, owner);
      }
      for (const RecordList& records : section.lists) {
        if (records.member.empty()) continue;
        const std::size_t count = list(records, owner);
        for (std::size_t i = 0; i < count; ++i) {
          for (const Key& key : records.keys) {
            if (key.get != nullptr) visit(key, records.at(owner, i));
          }
        }
      }
    }
  }
}

// Visits the numbers of a recording, or 0 where there is none. `number(value)` may change the value;
// `count(size)` returns how many follow.
template <class Number, class Count>
void for_each_recorded(ErrorTrace& trace, Number&& number, Count&& count) {
  trace.segments.resize(count(trace.segments.size()));
  if (trace.segments.empty()) return;
  std::uint32_t first = 0;
  for (ErrorSegment& segment : trace.segments) {
    double ticks = segment.ticks;
    number(ticks);
    number(segment.gain);
    segment.first = first;
    segment.ticks = static_cast<std::uint32_t>(ticks);
    first += segment.ticks;
  }
  trace.speeds.resize(count(trace.speeds.size()));
  for (double& speed : trace.speeds) number(speed);
}
template <class Number, class Count>
void for_each_recorded(RadioTrace& trace, Number&& number, Count&& count) {
  trace.delays.resize(count(trace.delays.size()));
  if (trace.delays.empty()) return;
  double kind = trace.kind;
  number(kind);
  number(trace.interval);
  trace.kind = static_cast<std::uint32_t>(kind);
  for (double& delay : trace.delays) number(delay);
}

// Visits the recordings of a spec; returns those that the visits made.
template <class Trace, class Number, class Count>
const Trace* visit_recording(const Trace* trace, Number&& number, Count&& count) {
  Trace copy = trace == nullptr ? Trace{} : *trace;
  for_each_recorded(copy, number, count);
  return copy == Trace{} ? nullptr : keep(std::move(copy));
}
template <class Number, class Count>
void for_each_recorded(Spec& spec, Number&& number, Count&& count) {
  for (RobotSpec& robot : spec.robots) {
    robot.recorded = visit_recording(robot.recorded, number, count);
  }
  spec.fates = visit_recording(spec.fates, number, count);
}

}  // namespace detail

// Appends the bytes of a spec.
inline void append_bytes(const Spec& spec, std::vector<std::byte>& bytes) {
  const auto append = [&](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) bytes.push_back(std::byte(bits >> shift & 0xff));
  };
  Spec copy = spec;
  detail::for_each_member(
      copy, [&](const Key& key, const void* record) { append(key.get(record)); },
      [&](const RecordList& list, const void* owner) {
        append(double(list.count(owner)));
        return list.count(owner);
      });
  detail::for_each_recorded(
      copy, [&](double& value) { append(value); },
      [&](std::size_t size) {
        append(double(size));
        return size;
      });
}

// Takes a spec from the front of the bytes; nothing where they hold none.
inline std::optional<Spec> take_spec(std::span<const std::byte>& bytes) {
  bool is_whole = true;
  const auto take = [&]() -> double {
    if (bytes.size() < 8) {
      is_whole = false;
      return 0;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < 8; ++i) bits |= std::uint64_t(bytes[i]) << (8 * i);
    bytes = bytes.subspan(8);
    return std::bit_cast<double>(bits);
  };
  Spec spec;
  detail::for_each_member(
      spec, [&](const Key& key, void* record) { key.put(record, take()); },
      [&](const RecordList& list, void* owner) {
        const double count = take();
        is_whole = is_whole && count >= 0 && count <= double(list.most);
        if (is_whole) list.resize(owner, static_cast<std::size_t>(count));
        return list.count(owner);
      });
  detail::for_each_recorded(
      spec, [&](double& value) { value = take(); },
      [&](std::size_t) -> std::size_t {
        const double count = take();
        is_whole = is_whole && count >= 0 && count <= double(bytes.size()) / 8;
        return is_whole ? static_cast<std::size_t>(count) : 0;
      });
  if (!is_whole) return std::nullopt;
  return spec;
}

}  // namespace palmbots

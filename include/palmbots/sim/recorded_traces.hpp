// SPDX-License-Identifier: Apache-2.0
// Recordings that a carry replays: the speed errors of a real robot, and what became of the packets
// of a real radio.
//
// A spec points to its recordings, so that it remains plain numbers (`keep`, sim/spec_bytes.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "palmbots/base/philox.hpp"
#include "palmbots/sim/random_streams.hpp"

namespace palmbots {

// A recorded stretch on which a robot drove straight with a constant command.
struct ErrorSegment {
  std::uint32_t first = 0;  // its first tick, of those of all segments
  std::uint32_t ticks = 0;
  double gain = 1;  // actual speed per commanded speed, on average over the segment

  bool operator==(const ErrorSegment&) const = default;
};

// Rows of a recording: the displacement error beyond that of the gain.
struct RecordedErrors {
  std::span<const std::uint32_t> segments;  // number of the segment, which does not decrease
  std::span<const double> times;            // [s], increasing within a segment
  std::span<const double> errors;           // from any origin [m]
  std::span<const double> gains;            // the first of a segment counts
};

// The speed errors of one robot, tick by tick, segment after segment.
struct ErrorTrace {
  std::vector<ErrorSegment> segments;
  std::vector<double> speeds;  // the mean error in each tick, beyond that of the gain [m/s]

  bool operator==(const ErrorTrace&) const = default;

  // The errors in ticks of this period [s]. Between two rows the displacement is on a straight line.
  // A segment shorter than a tick is left out.
  static ErrorTrace of(const RecordedErrors& rows, double period) {
    ErrorTrace trace;
    std::size_t start = 0;
    for (std::size_t i = 1; i <= rows.times.size(); ++i) {
      if (i < rows.times.size() && rows.segments[i] == rows.segments[start]) continue;
      trace.add(rows, start, i, period);
      start = i;
    }
    return trace;
  }

 private:
  void add(const RecordedErrors& rows, std::size_t from, std::size_t to, double period) {
    const double lasts = rows.times[to - 1] - rows.times[from];
    const auto ticks = static_cast<std::uint32_t>(lasts / period + 1e-6);
    if (ticks == 0) return;
    segments.push_back({static_cast<std::uint32_t>(speeds.size()), ticks, rows.gains[from]});
    std::size_t row = from;
    const auto error_at = [&](double time) {
      while (row + 2 < to && rows.times[row + 1] < time) ++row;
      const double share = (time - rows.times[row]) / (rows.times[row + 1] - rows.times[row]);
      return rows.errors[row] + share * (rows.errors[row + 1] - rows.errors[row]);
    };
    double before = rows.errors[from];
    for (std::uint32_t k = 1; k <= ticks; ++k) {
      const double now = error_at(rows.times[from] + k * period);
      speeds.push_back((now - before) / period);
      before = now;
    }
  }
};

// What became of packets, one after the other, that were sent at equal times.
struct RadioTrace {
  enum Delays : std::uint32_t {
    none = 0,   // not recorded: those of the scene
    extra = 1,  // in addition to the latency of the scene
    whole = 2,  // in place of the delays of the scene
  };
  static constexpr double lost = -1;  // the delay of a lost packet

  double interval = 0;  // between packets [s]
  std::uint32_t kind = none;
  std::vector<double> delays;  // [s]

  bool operator==(const RadioTrace&) const = default;
};

// A part of a number, drawn by a word: below `count`.
constexpr std::uint32_t place_of(std::uint32_t word, std::size_t count) {
  return static_cast<std::uint32_t>(std::uint64_t{word} * count >> 32);
}

// Where in its recording a robot is. It begins anywhere in the recording, and after the end of a
// segment it continues with any other one, from its start. All are drawn by the seed.
class ErrorReplay {
 public:
  // The segment that a carry begins with.
  static const ErrorSegment& first(const ErrorTrace& trace, std::uint64_t seed,
                                   std::uint32_t lane) {
    return segment_at(trace, start(trace, seed, lane));
  }

  // The tick's segment, for ticks that do not decrease.
  const ErrorSegment& go_to(const ErrorTrace& trace, std::uint64_t seed, std::uint32_t lane,
                            std::uint32_t tick) {
    while (tick >= until_ || segment_ == nullptr) next(trace, seed, lane);
    return *segment_;
  }

  // The error in a tick to which it went [m/s].
  double speed(const ErrorTrace& trace, std::uint32_t tick) const {
    return trace.speeds[first_ + (tick - since_)];
  }

 private:
  static std::uint32_t start(const ErrorTrace& trace, std::uint64_t seed, std::uint32_t lane) {
    return place_of(draw(seed, 0, Stream::error_trace, lane)[0], trace.speeds.size());
  }

  static const ErrorSegment& segment_at(const ErrorTrace& trace, std::uint32_t place) {
    const auto after = std::ranges::upper_bound(trace.segments, place, {}, &ErrorSegment::first);
    return *(after - 1);
  }

  void next(const ErrorTrace& trace, std::uint64_t seed, std::uint32_t lane) {
    since_ = until_;
    if (count_ == 0) {
      first_ = start(trace, seed, lane);
      segment_ = &segment_at(trace, first_);
    } else {
      const Words words = draw(seed, count_, Stream::error_trace, lane);
      segment_ = &trace.segments[place_of(words[0], trace.segments.size())];
      first_ = segment_->first;
    }
    until_ = since_ + (segment_->first + segment_->ticks - first_);
    ++count_;
  }

  const ErrorSegment* segment_ = nullptr;
  std::uint32_t count_ = 0;  // of segments begun
  std::uint32_t first_ = 0;  // the place in the recording at the tick `since_`
  std::uint32_t since_ = 0;  // the tick from which on the segment is replayed
  std::uint32_t until_ = 0;  // and until before which
};

}  // namespace palmbots

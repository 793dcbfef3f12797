// SPDX-License-Identifier: Apache-2.0
// A spec as bytes: every member that the table of keys names, as a little-endian double, one after
// the other. Equal specs have equal bytes, on every machine.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "palmbots/sim/spec.hpp"

namespace palmbots {

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
  if (!is_whole) return std::nullopt;
  return spec;
}

}  // namespace palmbots

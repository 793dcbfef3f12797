// SPDX-License-Identifier: Apache-2.0
// What a board remembers over a boot: how often it has booted, whether its palm was up for the partner,
// whether a carry was under way or a stop in force, and, in a job on the floor or at a stand, whether the
// arms may be up and where the own one is.
//
// A record has three words: two of content, the second with a number that counts the records, and a check
// of both. The memory is worn out long before this number ends. Records are appended. After a power cut in any word of a write the check is wrong, or the word has not been
// begun, and the record before it counts. So a board finds the old or the new content, and a boot whose
// record is not complete has sent nothing.
//
// Two pages take turns. A page is erased only while the robot is disarmed, because that halts the
// processor for 88 ms.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../board/board.hpp"
#include "crc32.hpp"

namespace palmbots::app {

// Where an arm goes on after a boot (arm.hpp).
struct StoredArm {
  static constexpr int most_touched = 0x7F;
  std::uint8_t edge = 0;     // steps, at most 15
  std::uint8_t touched = 0;  // the height at which its palm touched an object on a stand
  bool ends = false;         // the steps count from the lowest height at the end of the job

  constexpr bool operator==(const StoredArm&) const = default;
};

// What is stored.
struct Stored {
  std::uint32_t epoch = 0;
  bool assists = false;
  bool carries = false;
  bool stop = false;
  bool holds = false;
  StoredArm arm{};

  constexpr bool operator==(const Stored&) const = default;
};

class Storage {
 public:
  // Looks for the newest record.
  void open() {
    std::uint32_t newest = 0;
    for (std::size_t page = 0; page < pages; ++page) {
      for (std::size_t slot = 0; slot < slots; ++slot) {
        const std::uint32_t* words = words_of(page, slot);
        if (is_blank(words)) continue;
        used_[page] = slot + 1;
        const std::uint32_t number = words[1] & most_records;
        if (words[2] != check_of(words) || number < newest) continue;
        newest = number;
        active_ = page;
        content_ = content_of(words);
      }
    }
    next_number_ = newest + 1;
  }

  const Stored& content() const { return content_; }
  // Everything could be written so far.
  bool works() const { return works_; }

  // Stores the content if it differs. Returns false if it could not be stored.
  bool keep(const Stored& content) {
    if (content == content_ && works_) return true;
    if (used_[active_] == slots) {
      const std::size_t other = 1 - active_;
      if (used_[other] != 0) return works_ = false;
      active_ = other;
    }
    const std::size_t slot = used_[active_]++;
    const std::uint32_t* words = words_of(active_, slot);
    std::uint32_t record[3] = {word_of(content), next_number_++ | arm_word_of(content.arm), 0};
    record[2] = check_of(record);
    for (std::size_t i = 0; i < 3; ++i) board::write_word(active_, slot * 3 + i, record[i]);
    works_ = words[0] == record[0] && words[1] == record[1] && words[2] == record[2];
    if (works_) content_ = content;
    return works_;
  }

  // The other page has to be erased, before this one is full.
  bool wants_erase() const { return used_[1 - active_] != 0 && used_[active_] >= slots / 2; }
  void erase() {
    board::erase_page(1 - active_);
    used_[1 - active_] = 0;
  }

 private:
  static constexpr std::uint32_t most_records = 0xFFFFFF;
  static constexpr std::size_t pages = 2;
  static constexpr std::size_t slots = board::words_per_page / 3;

  static const std::uint32_t* words_of(std::size_t page, std::size_t slot) {
    return board::page(page) + 3 * slot;
  }
  static bool is_blank(const std::uint32_t* words) {
    return (words[0] & words[1] & words[2]) == 0xFFFFFFFF;
  }
  static std::uint32_t check_of(const std::uint32_t* words) { return crc32(words, 8); }
  static std::uint32_t word_of(const Stored& s) {
    return s.epoch | std::uint32_t{s.assists} << 24 | std::uint32_t{s.carries} << 25 |
           std::uint32_t{s.stop} << 26 | std::uint32_t{s.holds} << 27 |
           std::uint32_t{s.arm.edge} << 28;
  }
  static std::uint32_t arm_word_of(const StoredArm& arm) {
    return std::uint32_t{arm.touched} << 24 | std::uint32_t{arm.ends} << 31;
  }
  static Stored content_of(const std::uint32_t* words) {
    const std::uint32_t word = words[0];
    const auto bit = [word](unsigned place) { return (word >> place & 1) != 0; };
    const StoredArm arm{static_cast<std::uint8_t>(word >> 28),
                        static_cast<std::uint8_t>(words[1] >> 24 & StoredArm::most_touched),
                        words[1] >> 31 != 0};
    return {word & 0xFFFFFF, bit(24), bit(25), bit(26), bit(27), arm};
  }

  Stored content_;
  std::size_t active_ = 0;
  std::size_t used_[pages]{};
  std::uint32_t next_number_ = 1;
  bool works_ = true;
};

}  // namespace palmbots::app

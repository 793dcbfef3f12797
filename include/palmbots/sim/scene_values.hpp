// SPDX-License-Identifier: Apache-2.0
// The values of a scene as given: in the units of its keys, before left and right are resolved.
//
// A key is addressed by its dotted name, without index and side: "radio.loss", "palm.friction",
// "radio.outages[].start_s", "object.vertices_m[][0]". A wrong name in the code does not compile.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "palmbots/sim/scene_sections.hpp"
#include "palmbots/sim/spec.hpp"

namespace palmbots {

// Where a value stands: in the table of all, or in that of the left or right robot or the station.
inline constexpr std::size_t common = 0;
constexpr std::size_t own(std::size_t holder) { return 1 + holder; }

namespace detail {

inline constexpr std::size_t no_key = ~std::size_t{0};

constexpr bool is_path(std::string_view path, std::string_view section, std::string_view name) {
  return !name.empty() && path.size() == section.size() + 1 + name.size() &&
         path.starts_with(section) && path[section.size()] == '.' && path.ends_with(name);
}

// The place of a key among those of all sections, or of a list, or no_key.
constexpr std::size_t find_key(std::string_view path) {
  std::size_t before = 0;
  for (const Section& section : scene_sections) {
    for (const Key& key : section.keys) {
      if (is_path(path, section.name, key.name)) return before;
      ++before;
    }
  }
  return no_key;
}

// The key for all senders that a key of one sender overrides, in a section before.
constexpr std::size_t common_key(const Section& section, const Key& key) {
  std::size_t before = 0;
  for (const Section& other : scene_sections) {
    for (const Key& one : other.keys) {
      if (other.name == section.name && one.name == key.name) return before;
      ++before;
    }
  }
  return no_key;
}

constexpr std::size_t find_list(std::string_view path) {
  std::size_t before = 0;
  for (const Section& section : scene_sections) {
    for (const RecordList& list : section.lists) {
      if (is_path(path, section.name, list.name)) return before;
      ++before;
    }
  }
  return no_key;
}

inline constexpr std::size_t key_count = [] {
  std::size_t n = 0;
  for (const Section& section : scene_sections) n += section.keys.size();
  return n;
}();
inline constexpr std::size_t list_count = [] {
  std::size_t n = 0;
  for (const Section& section : scene_sections) n += section.lists.size();
  return n;
}();

constexpr const Key& key_at(std::size_t index) {
  for (const Section& section : scene_sections) {
    if (index < section.keys.size()) return section.keys[index];
    index -= section.keys.size();
  }
  return scene_sections[0].keys[0];
}
constexpr const RecordList& list_at(std::size_t index) {
  for (const Section& section : scene_sections) {
    if (index < section.lists.size()) return section.lists[index];
    index -= section.lists.size();
  }
  return scene_sections[0].lists[0];
}

// Whether tables of single robots or senders stand in a section.
constexpr bool has_holders(std::string_view name) {
  for (const Section& section : scene_sections) {
    if (section.name == name && section.holders != Holders::one) return true;
  }
  return false;
}
// The number of a robot or sender, or no_key.
constexpr std::size_t holder_of(std::string_view name) {
  for (std::size_t k = 0; k < sender_choices.count; ++k) {
    if (sender_choices.names[k] == name) return k;
  }
  return no_key;
}

constexpr std::size_t find_in(const RecordList& list, std::string_view name) {
  for (std::size_t k = 0; k < list.keys.size(); ++k) {
    if (list.keys[k].name == name && !name.empty()) return k;
  }
  return no_key;
}

// A name in the code.
template <std::size_t N>
struct Name {
  char text[N]{};
  consteval Name(const char (&from)[N]) { std::copy_n(from, N, text); }
  constexpr std::string_view view() const { return {text, N - 1}; }
};

// The value of a name, or `unset`.
constexpr double number_of(const Key& key, std::string_view name) {
  for (std::size_t k = 0; key.choices != nullptr && k < key.choices->count; ++k) {
    if (key.choices->names[k] == name) return key.least + double(k);
  }
  return unset;
}

}  // namespace detail

class SceneValues {
  template <detail::Name path>
  static constexpr std::size_t key_index = [] {
    constexpr std::size_t found = detail::find_key(path.view());
    static_assert(found != detail::no_key);
    return found;
  }();
  template <detail::Name path>
  static constexpr std::size_t list_index = [] {
    constexpr std::size_t found = detail::find_list(path.view());
    static_assert(found != detail::no_key);
    return found;
  }();

 public:
  static constexpr std::size_t most_keys_of_record = 16;
  // The values of a record in the order of the keys of its list.
  using Record = std::array<double, most_keys_of_record>;

  SceneValues() {
    for (auto& places : numbers_) places.fill(unset);
    for (std::size_t k = 0; k < detail::list_count; ++k) {
      const RecordList& list = detail::list_at(k);
      std::size_t width = 0;
      for (const Key& key : list.keys) width += key.name.empty() ? 0U : 1U;
      for (std::size_t i = 0; i < list.initial.size(); i += width) {
        std::copy_n(list.initial.begin() + std::ptrdiff_t(i), width, add(k).begin());
      }
    }
  }

  // Gives a list so many records, none of whose keys are set.
  void begin_list(std::string_view path, std::size_t count) {
    const std::size_t list = detail::find_list(path);
    if (list == detail::no_key) return;
    lists_[list].is_given = true;
    lists_[list].records.clear();
    const std::size_t n = std::min(count, detail::list_at(list).most);
    for (std::size_t i = 0; i < n; ++i) add(list);
  }

  // Sets a key: of all or of one holder, or of the record `place` of a list. A number in place of a
  // list of numbers is a list of one. Keys that the core does not read are ignored.
  void set(std::string_view path, std::size_t place, double value) {
    const std::size_t list = detail::find_list(path);
    if (list != detail::no_key) {
      begin_list(path, 1);
      lists_[list].records[0][0] = value;
      return;
    }
    if (const Slot slot = find(path, place); slot.value != nullptr) *slot.value = value;
  }
  void set(std::string_view path, std::size_t place, std::string_view name) {
    const Slot slot = find(path, place);
    if (slot.value != nullptr) *slot.value = detail::number_of(*slot.key, name);
  }

  // The value in one place, or `unset`.
  double at(std::size_t key, std::size_t place) const { return numbers_[key][place]; }

  template <detail::Name path>
  bool has(std::size_t place = common) const {
    const double value = numbers_[key_index<path>][place];
    return value == value;
  }

  // The value that counts for a holder: its own, that of all, or the default.
  template <detail::Name path>
  double of(std::size_t place = common) const {
    return first_set(numbers_[key_index<path>], place, row<path>.initial);
  }

  template <detail::Name path>
  bool has_list() const {
    return lists_[list_index<path>].is_given;
  }
  template <detail::Name path>
  const std::vector<Record>& list() const {
    return lists_[list_index<path>].records;
  }
  const std::vector<Record>& list(std::size_t index) const { return lists_[index].records; }

  // The row of a key.
  template <detail::Name path>
  static constexpr const Key& row = detail::key_at(key_index<path>);

  // The place of a key within the records of its list.
  template <detail::Name path, detail::Name name>
  static constexpr std::size_t place_in_record = [] {
    constexpr std::size_t found = detail::find_in(detail::list_at(list_index<path>), name.view());
    static_assert(found != detail::no_key);
    return found;
  }();
  template <detail::Name path, detail::Name name>
  static constexpr const Key& row_in_record =
      detail::list_at(list_index<path>).keys[(place_in_record<path, name>)];

 private:
  struct Slot {
    double* value = nullptr;
    const Key* key = nullptr;
  };
  struct List {
    std::vector<Record> records;
    bool is_given = false;
  };

  static double first_set(const std::array<double, 4>& given, std::size_t place, double initial) {
    if (given[place] == given[place]) return given[place];
    return given[common] == given[common] ? given[common] : initial;
  }

  Record& add(std::size_t list) {
    Record& record = lists_[list].records.emplace_back();
    record.fill(unset);
    return record;
  }

  // A key of a list has brackets: "radio.outages[].start_s" is that of the record `place`. A number
  // in them is the place: "object.edge_radius_m[3]".
  Slot find(std::string_view path, std::size_t place) {
    const std::size_t open = path.find('[');
    const std::size_t list = detail::find_list(path.substr(0, open));
    if (list == detail::no_key) {
      const std::size_t k = detail::find_key(path);
      if (k == detail::no_key || place >= numbers_[k].size()) return {};
      return {&numbers_[k][place], &detail::key_at(k)};
    }
    const std::size_t close = path.find(']');
    if (close == path.npos) return {};
    const std::string_view digits = path.substr(open + 1, close - open - 1);
    if (!digits.empty()) place = 0;
    for (const char digit : digits) place = 10 * place + static_cast<std::size_t>(digit - '0');
    if (place >= lists_[list].records.size()) return {};
    std::string_view name = path.substr(close + 1);
    if (name.starts_with('.')) name.remove_prefix(1);
    const std::size_t k = detail::find_in(detail::list_at(list), name.empty() ? itself : name);
    if (k == detail::no_key) return {};
    return {&lists_[list].records[place][k], &detail::list_at(list).keys[k]};
  }

  std::array<std::array<double, 4>, detail::key_count> numbers_;
  std::array<List, detail::list_count> lists_;
};

}  // namespace palmbots

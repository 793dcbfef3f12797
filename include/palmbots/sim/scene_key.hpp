// SPDX-License-Identifier: Apache-2.0
// Rows of the table of scene keys: what a key is called in a scene file, its unit and limits, and
// the member of the spec that holds its value.
//
// A row stands below the structure whose member it names, so that one file states a key completely.
// The rows serve the bindings, the conversion of units, the page's input, the bytes of a spec, the
// checks and the documentation. A member's initial value is the default of its key. If it is outside
// the limits (NaN, for example), the key is optional and not set by default. In a record, every key
// whose initial value is within the limits is required.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <type_traits>

#include "palmbots/base/scalar.hpp"

namespace palmbots {

inline constexpr double unset = std::numeric_limits<double>::quiet_NaN();

// What a scene file contains as the value of a key.
enum class KeyKind : std::uint8_t { number, whole, flag, choice };

enum class Unit : std::uint8_t {
  none,
  m,
  s,
  kg,
  m_s,
  m_per_sqrt_s,
  m_s2,
  degrees,
  degrees_s,
  parts_per_million,
  bumps_per_metre,
  newton,
  newton_m
};
inline constexpr std::array<std::string_view, 13> unit_names = {"",
                                                                "m",
                                                                "s",
                                                                "kg",
                                                                "m/s",
                                                                "m/√s",
                                                                "m/s²",
                                                                "degrees",
                                                                "degrees/s",
                                                                "parts per million",
                                                                "bumps per metre",
                                                                "N",
                                                                "N m"};

// The size of a unit in SI units and radians.
constexpr double scale_of(Unit unit) {
  if (unit == Unit::degrees || unit == Unit::degrees_s) return radians_per_degree<double>;
  return unit == Unit::parts_per_million ? 1e-6 : 1;
}

// The name of the only key of a record that is a single number.
inline constexpr std::string_view itself = "itself";

// The names of which a key takes one.
struct Choices {
  std::array<std::string_view, 7> names{};
  std::size_t count = 0;
  int first = 0;  // number of the first name

  template <class... Name>
  explicit constexpr Choices(int number, Name... name)
      : names{name...}, count(sizeof...(name)), first(number) {}
  constexpr std::span<const std::string_view> all() const { return {names.data(), count}; }
};

// A key of a table or of a record. `record` points to the structure whose member it is.
struct Key {
  std::string_view name;    // as in a scene file; empty: the value is derived
  std::string_view member;  // of the structure; empty: only the derivation of others reads it
  const Choices* choices = nullptr;  // of a flag or a choice
  KeyKind kind = KeyKind::number;
  Unit unit = Unit::none;
  bool is_open = false;  // the limits themselves are excluded
  double least = 0;
  double most = 0;                              // infinite: no upper limit
  double initial = unset;                       // in the key's unit
  double (*get)(const void* record) = nullptr;  // in SI units and radians
  void (*put)(void* record, double value) = nullptr;

  constexpr bool allows(double value) const {
    return is_open ? value > least && value < most : value >= least && value <= most;
  }
};

// A list of records, which a structure holds as an array and the number of records in it.
struct RecordList {
  std::string_view name;
  std::string_view member;
  std::size_t most = 0;
  std::span<const Key> keys;
  std::span<const double> initial{};  // the numbers of the default records
  std::size_t (*count)(const void* owner) = nullptr;
  void (*resize)(void* owner, std::size_t count) = nullptr;
  void* (*at)(void* owner, std::size_t index) = nullptr;
};

inline constexpr Choices flag_choices(0, "false", "true");
inline constexpr Choices sign_choices(-1, "-", "0", "+");
inline constexpr Choices side_choices(0, "left", "right");
inline constexpr Choices sender_choices(0, "left", "right", "station");

namespace detail {

// The name of a member, as the compiler prints the type of this function.
template <auto Member>
consteval std::string_view printed_name() {
  const std::string_view text = __PRETTY_FUNCTION__;
  const std::size_t end = text.find_last_of(']');
  const std::size_t semicolon = text.find(';');
  const std::string_view head = text.substr(0, semicolon < end ? semicolon : end);
  return head.substr(head.rfind(':') + 1);
}

// A copy of the name alone: a view of the printed text would keep all of it in the program.
template <auto Member>
inline constexpr auto name_characters = [] {
  std::array<char, printed_name<Member>().size()> copy{};
  std::ranges::copy(printed_name<Member>(), copy.begin());
  return copy;
}();

template <auto Member>
constexpr std::string_view member_name() {
  return {name_characters<Member>.data(), name_characters<Member>.size()};
}

template <class Struct, class Value>
struct MemberTypes {
  using Owner = Struct;
  using Type = Value;
};
template <class Struct, class Value>
consteval MemberTypes<Struct, Value> types_of(Value Struct::*) {
  return {};
}

// A value in the unit of its key, free of the rounding of the conversion.
constexpr double rounded(double value) {
  constexpr double digits = 1e9;
  const double scaled = value * digits;
  if (!(scaled > -9e15 && scaled < 9e15)) return value;
  const auto whole = static_cast<std::int64_t>(scaled < 0 ? scaled - 0.5 : scaled + 0.5);
  return double(whole) / digits;
}

template <auto Member>
constexpr Key member_key(std::string_view name, KeyKind kind, Unit unit, double least,
                         double most) {
  using Types = decltype(types_of(Member));
  using Owner = typename Types::Owner;
  using Type = typename Types::Type;
  Key key;
  key.name = name;
  key.member = member_name<Member>();
  key.kind = kind;
  key.unit = unit;
  key.least = least;
  key.most = most;
  key.initial = double(Owner{}.*Member);
  if (scale_of(unit) != 1) key.initial = rounded(key.initial / scale_of(unit));
  key.get = [](const void* record) { return double(static_cast<const Owner*>(record)->*Member); };
  key.put = [](void* record, double value) {
    static_cast<Owner*>(record)->*Member = static_cast<Type>(value);
  };
  return key;
}

// The same key, of which the value is one of some names.
constexpr Key with_choices(Key key, const Choices& choices) {
  key.choices = &choices;
  key.least = choices.first;
  key.most = choices.first + double(choices.count) - 1;
  return key;
}

}  // namespace detail

// A number.
template <auto Member>
constexpr Key number(std::string_view name, Unit unit, double least, double most) {
  return detail::member_key<Member>(name, KeyKind::number, unit, least, most);
}

// A whole number.
template <auto Member>
constexpr Key whole(std::string_view name, double least, double most) {
  return detail::member_key<Member>(name, KeyKind::whole, Unit::none, least, most);
}

// A switch: false or true.
template <auto Member>
constexpr Key flag(std::string_view name) {
  return detail::with_choices(detail::member_key<Member>(name, KeyKind::flag, Unit::none, 0, 1),
                              flag_choices);
}

// One of some names.
template <auto Member>
constexpr Key choice(std::string_view name, const Choices& choices) {
  return detail::with_choices(detail::member_key<Member>(name, KeyKind::choice, Unit::none, 0, 0),
                              choices);
}

// A member that no key of a scene sets: it follows from others.
template <auto Member>
constexpr Key derived() {
  using Type = typename decltype(detail::types_of(Member))::Type;
  constexpr auto kind = std::is_floating_point_v<Type> ? KeyKind::number : KeyKind::whole;
  return detail::member_key<Member>("", kind, Unit::none, 0, 0);
}

// Keys that have no member of their own: other members follow from them.
constexpr Key source_number(std::string_view name, Unit unit, double least, double most,
                            double initial = unset) {
  Key key;
  key.name = name;
  key.unit = unit;
  key.least = least;
  key.most = most;
  key.initial = initial;
  return key;
}
constexpr Key source_whole(std::string_view name, double least, double most, double initial) {
  Key key = source_number(name, Unit::none, least, most, initial);
  key.kind = KeyKind::whole;
  return key;
}
constexpr Key source_choice(std::string_view name, const Choices& choices, double initial = unset,
                            KeyKind kind = KeyKind::choice) {
  Key key = detail::with_choices(source_number(name, Unit::none, 0, 0, initial), choices);
  key.kind = kind;
  return key;
}

// A list of numbers, from which members of other names follow.
constexpr RecordList source_list(std::string_view name, std::size_t most,
                                 std::span<const Key> keys) {
  return {name,
          {},
          most,
          keys,
          {},
          [](const void*) { return std::size_t{0}; },
          [](void*, std::size_t) {},
          [](void*, std::size_t) -> void* { return nullptr; }};
}

// The same key, with limits that are excluded themselves.
constexpr Key between(Key key) {
  key.is_open = true;
  return key;
}

// A list of records.
template <auto Items, auto Count>
constexpr RecordList records(std::string_view name, std::span<const Key> keys) {
  using Owner = typename decltype(detail::types_of(Items))::Owner;
  return {name,
          detail::member_name<Items>(),
          std::size((Owner{}.*Items)),
          keys,
          {},
          [](const void* owner) { return static_cast<const Owner*>(owner)->*Count; },
          [](void* owner, std::size_t count) { static_cast<Owner*>(owner)->*Count = count; },
          [](void* owner, std::size_t index) -> void* {
            return &(static_cast<Owner*>(owner)->*Items)[index];
          }};
}

}  // namespace palmbots

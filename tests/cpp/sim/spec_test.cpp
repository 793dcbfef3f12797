// SPDX-License-Identifier: Apache-2.0
// A spec is passed on as its numbers: the bytes give the same spec, and each member counts.
#include "palmbots/sim/spec_bytes.hpp"

#include <cstddef>
#include <span>
#include <vector>

#include "support/check.hpp"
#include "support/paper_spec.hpp"

using namespace palmbots;

namespace {

std::vector<std::byte> bytes_of(const Spec& spec) {
  std::vector<std::byte> bytes;
  append_bytes(spec, bytes);
  return bytes;
}

// A spec with a record in every list.
Spec full_spec() {
  Spec spec = paper_spec();
  spec.outage_count = spec.message_fault_count = spec.fault_count = 1;
  spec.bump_count = spec.push_count = 2;
  return spec;
}

void test_bytes_give_the_spec() {
  const auto bytes = bytes_of(full_spec());
  std::span<const std::byte> rest(bytes);
  const auto spec = take_spec(rest);
  CHECK(spec.has_value() && rest.empty());
  CHECK(bytes_of(*spec) == bytes);
  std::span<const std::byte> part = std::span(bytes).first(bytes.size() - 1);
  CHECK(!take_spec(part).has_value());
}

void test_every_member_is_in_the_bytes() {
  std::size_t members = 0;
  Spec spec = full_spec();
  const auto before = bytes_of(spec);
  detail::for_each_member(
      spec,
      [&](const Key& key, void* record) {
        const double value = key.get(record);
        const bool is_no_number = !(value + 1 > value);  // infinite, or not set
        key.put(record, key.kind == KeyKind::flag ? 1 - value : is_no_number ? 0 : value + 1);
        CHECK(bytes_of(spec) != before);
        key.put(record, value);
        CHECK(bytes_of(spec) == before);
        ++members;
      },
      [](const RecordList& list, const void* owner) { return list.count(owner); });
  CHECK(members > 120);
}

}  // namespace

int main() {
  test_bytes_give_the_spec();
  test_every_member_is_in_the_bytes();
  return 0;
}

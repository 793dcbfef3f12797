// SPDX-License-Identifier: Apache-2.0
// A spec is passed on as its bytes: equal specs have equal bytes, whatever the memory held before.
#include "palmbots/sim/spec.hpp"

#include <cstring>
#include <memory>
#include <new>

#include "support/check.hpp"

using namespace palmbots;

namespace {

struct Memory {
  alignas(Spec) unsigned char bytes[sizeof(Spec)];
};

// Puts a value where another was. `litter` is what its memory held before it was made.
template <class Value>
void put(Value& to, unsigned char litter) {
  alignas(Value) unsigned char room[sizeof(Value)];
  std::memset(room, litter, sizeof room);
  to = *new (room) Value{};
}

std::unique_ptr<Memory> spec_in(unsigned char litter) {
  auto memory = std::make_unique<Memory>();
  std::memset(memory->bytes, litter, sizeof memory->bytes);
  Spec& spec = *new (memory->bytes) Spec;
  for (auto& one : spec.outline.vertices) put(one, litter);
  for (auto& one : spec.palms) put(one, litter);
  for (auto& one : spec.robots) put(one, litter);
  for (auto& one : spec.zones) put(one, litter);
  for (auto& one : spec.outages) put(one, litter);
  for (auto& one : spec.message_faults) put(one, litter);
  for (auto& one : spec.faults) put(one, litter);
  for (auto& one : spec.bumps) put(one, litter);
  for (auto& one : spec.pushes) put(one, litter);
  for (auto& one : spec.directions) put(one, litter);
  return memory;
}

void test_equal_specs_have_equal_bytes() {
  const auto one = spec_in(0x00);
  const auto other = spec_in(0xff);
  for (std::size_t i = 0; i < sizeof(Spec); ++i) CHECK(one->bytes[i] == other->bytes[i]);
}

// The members of each part fill it: there is no room for padding between them, or behind.
static_assert(sizeof(ZoneSpec) == 3 * 8 && sizeof(PushSpec) == 4 * 8);
static_assert(sizeof(FaultSpec) == 6 * 8 && sizeof(OutageSpec) == 3 * 8);
static_assert(sizeof(MessageFaultSpec) == 3 * 8 && sizeof(BumpSpec) == 3 * 8);

}  // namespace

int main() {
  test_equal_specs_have_equal_bytes();
  return 0;
}

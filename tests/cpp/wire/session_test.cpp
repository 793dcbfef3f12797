// SPDX-License-Identifier: Apache-2.0
// What is new: the order of stamps, and what a session takes.
#include "palmbots/wire/endpoint.hpp"

#include <cstdint>

#include "support/check.hpp"

using palmbots::wire::SequenceNumber;
using palmbots::wire::Session;
using palmbots::wire::Verdict;

namespace {

bool takes(Session& session, const SequenceNumber& stamp) {
  return session.receive(stamp, {}) != Verdict::stale;
}

void test_a_session_takes_each_stamp_once_and_only_upwards() {
  Session session(1);
  CHECK(!takes(session, {0, 0}));
  CHECK(takes(session, {1, 1}));
  CHECK(!takes(session, {1, 1}));
  CHECK(takes(session, {1, 3}));
  CHECK(!takes(session, {1, 2}));
  CHECK(takes(session, {1, 0xFFFFFFFF}));
  CHECK(!takes(session, {1, 4}));
  // A boot later the sequence starts again, and what was sent before it is over.
  CHECK(takes(session, {2, 1}));
  CHECK(!takes(session, {1, 0xFFFFFFFF}));
  CHECK(!takes(session, {0, 0xFFFFFFFF}));
  CHECK((session.heard() == SequenceNumber{2, 1}));
}

// The definition: a number is new if it is greater than the greatest so far, epoch first.
void test_session_agrees_with_its_definition() {
  Session session(1);
  std::uint64_t greatest = 0;
  std::uint32_t random = 1;
  for (int i = 0; i < 100000; ++i) {
    random = random * 1664525 + 1013904223;
    const SequenceNumber stamp{random >> 28, random >> 8 & 0xff};
    const std::uint64_t number = std::uint64_t{stamp.epoch} << 32 | stamp.sequence;
    CHECK(takes(session, stamp) == (number > greatest));
    if (number > greatest) greatest = number;
    if (i % 1000 == 0) {
      session = Session(1);
      greatest = 0;
    }
  }
}

}  // namespace

int main() {
  test_a_session_takes_each_stamp_once_and_only_upwards();
  test_session_agrees_with_its_definition();
}

// SPDX-License-Identifier: Apache-2.0
// A list in place holds what was put into it, and a copy of it holds the same.
#include "palmbots/base/fixed_list.hpp"

#include <algorithm>

#include "support/check.hpp"

using namespace palmbots;

namespace {

using Few = FixedList<int, 4>;

bool has(const Few& list, std::initializer_list<int> items) {
  return std::equal(list.begin(), list.end(), items.begin(), items.end());
}

void test_items() {
  Few list;
  CHECK(list.empty() && list.begin() == list.end());
  for (const int item : {3, 1, 2}) list.push_back(item);
  CHECK(has(list, {3, 1, 2}) && list.size() == 3 && !list.full());
  CHECK(list[1] == 1 && list.contains(2) && !list.contains(4));
  list.push_back(4);
  CHECK(list.full() && list.contains(4));
  list.keep(1);
  CHECK(has(list, {3}) && !list.contains(4));
  list.clear();
  CHECK(list.empty());
}

void test_copies() {
  Few list{3, 1, 2};
  const Few copy = list;
  list[0] = 5;
  list.keep(2);
  CHECK(has(list, {5, 1}) && has(copy, {3, 1, 2}));
  list = copy;
  CHECK(has(list, {3, 1, 2}));
  list = {7};
  CHECK(has(list, {7}));
}

}  // namespace

int main() {
  test_items();
  test_copies();
}

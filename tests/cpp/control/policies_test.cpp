// SPDX-License-Identifier: Apache-2.0
// Controllers whose table is data: the rows of a policy, and a table of states, against a search
// through the rows; and the mailbox of their messages.
#include <algorithm>
#include <deque>
#include <random>
#include <vector>

#include "palmbots/control/distributed.hpp"
#include "palmbots/control/machine_table.hpp"
#include "palmbots/control/mailbox.hpp"
#include "palmbots/control/row_policy.hpp"
#include "palmbots/control/table_robot.hpp"
#include "support/check.hpp"

namespace {

using namespace palmbots;

constexpr Sign signs[] = {Sign::positive, Sign::zero, Sign::negative};

// The station commands the row of both signs. The robots drive only when both palms are there.
void rows_of_both_signs() {
  std::mt19937 chance(1);
  for (int again = 0; again < 50; ++again) {
    RowPolicy::Rows rows{};
    for (RowPolicy::Row& row : rows) {
      for (int i = 0; i < 2; ++i) {
        row.palms[i] = static_cast<Palm>(chance() % 2);
        row.drives[i] = static_cast<Move>(chance() % 3);
      }
    }
    RowPolicy policy(rows);
    std::size_t number = 0;  // (+, +), (+, 0), …, (−, −)
    for (const Sign l : signs) {
      for (const Sign r : signs) {
        const RowPolicy::Row& row = rows[number++];
        for (unsigned reports = 0; reports < 16; ++reports) {
          const auto report = [&](Sign sign, unsigned bits) {
            return Centralized::Report{sign, static_cast<Palm>(bits & 1), (bits & 2) != 0};
          };
          const Centralized::Report in[] = {report(l, reports), report(r, reports >> 2)};
          const bool left_is_there = in[0].palm == row.palms[0] && in[0].palm_at_target;
          const bool right_is_there = in[1].palm == row.palms[1] && in[1].palm_at_target;
          const bool drives = left_is_there && right_is_there;
          const Centralized::Output out = policy.step(in);
          for (int i = 0; i < 2; ++i) {
            CHECK(out.command[i].palm == row.palms[i] && !out.command[i].stop);
            CHECK(out.command[i].move == (drives ? row.drives[i] : Move::hold));
          }
          const bool is_centred = l == Sign::zero && r == Sign::zero;
          CHECK(policy.current() == (is_centred ? 0 : static_cast<int>(number)));
          CHECK(policy.sense(0) == static_cast<int>(l) && policy.sense(1) == static_cast<int>(r));
        }
      }
    }
  }
  CHECK(RowPolicy{}.current() == 0);  // before the first reports, nothing is to be corrected
}

bool holds_for(ContactCondition p, Sign sign) {
  switch (p) {
    case ContactCondition::any: return true;
    case ContactCondition::positive: return sign == Sign::positive;
    case ContactCondition::negative: return sign == Sign::negative;
    case ContactCondition::zero: return sign == Sign::zero;
    case ContactCondition::not_positive: return sign != Sign::positive;
    case ContactCondition::not_negative: return sign != Sign::negative;
  }
  return false;
}

// The first row that fits decides; if none does, the robot stays and keeps the message.
void machine_against_its_rows() {
  std::mt19937 chance(2);
  int stays = 0;
  int consumed = 0;
  for (int again = 0; again < 200; ++again) {
    MachineTable table;
    const auto states = static_cast<std::uint8_t>(1 + chance() % MachineTable::most_states);
    for (std::uint8_t s = 0; s < states; ++s) {
      CHECK(table.add(MachineTable::StateOutput{
          static_cast<char>('a' + s % 26),
          {static_cast<Palm>(chance() % 2), static_cast<Move>(chance() % 3)},
          false,
          MessageKind::none}));
    }
    std::vector<MachineTable::Row> rows(chance() % 60);
    for (MachineTable::Row& row : rows) {
      const auto heard = static_cast<MessageKind>(chance() % 4);
      row = {static_cast<std::uint8_t>(chance() % states),
             static_cast<ContactCondition>(chance() % 6),
             heard == MessageKind::none ? any_message : MessageSet(heard),
             chance() % 2 != 0 ? IfSet(If::turned) : IfSet{},
             static_cast<std::uint8_t>(chance() % states),
             static_cast<MessageKind>(chance() % 4)};
      CHECK(table.add(row));
    }
    const MachineTable::Row nowhere{std::uint8_t{0}, {}, any_message, {}, states, {}};
    CHECK(!table.add(nowhere) && table.states() == states);
    MachineRobot robot(&table);
    std::uint8_t state = 0;
    for (int step = 0; step < 200; ++step) {
      const RobotInput in{signs[chance() % 3], chance() % 2 != 0, 1,
                          static_cast<MessageKind>(chance() % 4)};
      const MachineTable::Row* first = nullptr;
      for (const MachineTable::Row& row : rows) {
        const bool turned = row.when == IfSet{} || in.palm_at_target;
        const bool heard = row.heard == any_message || row.heard == MessageSet(in.message);
        const bool fits = row.from == EnumSet<std::uint8_t>(state) && holds_for(row.p, in.sign) &&
                          heard && turned;
        if (fits && first == nullptr) first = &row;
      }
      const MessageKind send = first == nullptr ? MessageKind::none : first->send;
      const bool read = first != nullptr && first->heard != any_message;
      const std::uint8_t next = first == nullptr ? state : first->next;
      const bool quiet = next == state && send == MessageKind::none && !read;
      CHECK((robot.quiet(in.sign, in.palm_at_target, in.message) > 0) == quiet);
      const RobotOutput out = robot.step(in);
      state = next;
      CHECK(robot.state() == state && out.message == send && out.read == read);
      CHECK(out.command == table.output(state).command);
      stays += quiet;
      consumed += read;
    }
  }
  CHECK(stays > 1000 && consumed > 1000);
}

// A table that is known at run time, with the rows of one that the compiler knows, is the same robot.
void machine_of_known_rows() {
  using Known = TableRobot<Distributed>;
  MachineTable table;
  for (int s = 0; s < Distributed::states; ++s) {
    const TableOutput& output = Distributed::outputs[s];
    CHECK(table.add({output.name, output.command, output.waits,
                     awaited_in<Distributed>(static_cast<Distributed::State>(s))}));
  }
  for (const Known::Row& row : Distributed::rows) {
    EnumSet<std::uint8_t> from;
    from.bits = row.from.bits;
    CHECK(table.add(
        {from, row.p, row.heard, row.when, static_cast<std::uint8_t>(row.next), row.send}));
  }
  MachineRobot machine(&table);
  Known known;
  std::mt19937 chance(3);
  int sent = 0;
  for (int step = 0; step < 20000; ++step) {
    const RobotInput in{signs[chance() % 3], chance() % 2 != 0, 1,
                        static_cast<MessageKind>(chance() % 4)};
    const auto is_quiet = [&](const auto& robot) {
      return robot.quiet(in.sign, in.palm_at_target, in.message) > 0;
    };
    CHECK(is_quiet(machine) == is_quiet(known));
    const RobotOutput one = machine.step(in);
    const RobotOutput other = known.step(in);
    CHECK(one.command == other.command && one.message == other.message);
    CHECK(one.send == other.send && one.read == other.read);
    CHECK(one.send == (one.message != MessageKind::none));
    CHECK(machine.name() == known.name() && machine.waits() == known.waits());
    CHECK(machine.awaits() == known.awaits() && machine.stopped() == known.stopped());
    sent += one.send;
  }
  CHECK(sent > 1000);
}

// Messages are read in order of arrival. A full mailbox takes no more, and a boot empties it.
void mailbox_in_order() {
  std::mt19937 chance(4);
  Mailbox<Mail::queue> mailbox;
  std::deque<MessageKind> waiting;
  std::size_t most = 0;
  for (int again = 0; again < 50000; ++again) {
    const bool fills = again / 2000 % 2 == 0;
    if (chance() % 3 != 0 ? fills : !fills) {
      const auto message = static_cast<MessageKind>(1 + chance() % 3);
      const bool is_accepted = mailbox.accept(message);
      CHECK(is_accepted == (waiting.size() < 256));
      if (is_accepted) waiting.push_back(message);
    } else if (!waiting.empty()) {
      mailbox.read();
      waiting.pop_front();
    }
    if (chance() % 5000 == 0) {
      mailbox.boot(1);
      waiting.clear();
    }
    CHECK(mailbox.oldest() == (waiting.empty() ? MessageKind::none : waiting.front()));
    most = std::max(most, waiting.size());
  }
  CHECK(most == 256);
}

void full_table() {
  MachineTable table;
  for (std::size_t s = 0; s < MachineTable::most_states; ++s) {
    CHECK(table.add(MachineTable::StateOutput{' ', {}, false, MessageKind::none}));
  }
  CHECK(!table.add(MachineTable::StateOutput{' ', {}, false, MessageKind::none}));
  CHECK(table.states() == MachineTable::most_states);
}

}  // namespace

int main() {
  rows_of_both_signs();
  machine_against_its_rows();
  machine_of_known_rows();
  mailbox_in_order();
  full_table();
}

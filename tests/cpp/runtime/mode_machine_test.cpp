// SPDX-License-Identifier: Apache-2.0
#include "palmbots/runtime/mode_machine.hpp"

#include <cstdio>
#include <unordered_map>
#include "support/check.hpp"
#include "support/mode_world.hpp"
using namespace palmbots;
using namespace palmbots::test;
using namespace palmbots::runtime;
struct Search {
  const ModeWorld& w;
  struct H { size_t operator()(const std::array<std::uint64_t,2>&a) const { return (a[0]*0x9E3779B97F4A7C15ull) ^ (a[1]*0xC2B2AE3D27D4EB4Full>>7) ; } };
  static std::uint64_t packed(const Robot& r) {
    std::uint64_t n = 0; auto put=[&](unsigned v, unsigned bits){ n = n<<bits | v; };
    put((unsigned)r.mode,4); put(r.carried,3); put((unsigned)r.news,4); put(r.news_age,3); put(r.knows,1); put(r.stored_carry,1); put(r.stored_stop,1); put(r.needs,2); put(r.since_ready,3);
    for (auto& p : r.to) { put((unsigned)p.mode,4); put(p.age,3); put(p.answers,1); put(p.is_current,1);}
    return n;
  }
  std::unordered_map<std::array<std::uint64_t,2>, unsigned, H> seen;
  std::vector<Pair> states;
  const char* bad=nullptr;
  size_t trans=0;
  void add(const Pair& p) {
    auto k = std::array{packed(p.now)<<1 | p.reboots, packed(p.other)};
    if (seen.emplace(k, states.size()).second) states.push_back(p);
  }
  void run() {
    add(w.start());
    for (size_t i=0;i<states.size() && !bad;++i) {
      const Pair p = states[i]; if (i%200000==0) std::printf("%zu of %zu\n",i,states.size());
      if (p.now.mode==RobotMode::off) add(w.wait(p));
      if (p.reboots) add(w.reboot(p));
      w.each_turn(p,[&](const Turn& t){ auto s=w.step(p,t); ++trans; if (s.violates){bad=s.violates; std::printf("%s: mode %s needs %d news %s age %d op %d %s stop %d drv %d cov %d -> %s needs %d; other %s\n", bad, name_of(p.now.mode), p.now.needs, name_of(p.now.news), p.now.news_age, t.operates, name_of(t.operation), t.stop, t.driver_ok, t.covered, name_of(s.next.other.mode), s.next.other.needs, name_of(p.other.mode)); return;} add(s.next);});
    }
  }
};
int main() {
  ModeWorld w;
  w.settings.lease=2; w.settings.station_limit=0; w.settings.time_limit=1000; w.settings.watchdog=1; w.settings.most_overruns=0;
  Search s{w}; s.run();
  std::printf("%zu states %zu trans %s\n", s.states.size(), s.trans, s.bad?s.bad:"ok");
}

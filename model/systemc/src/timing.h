// Simulated time: picoseconds, the resolution of the kernel; and the clock of the engine without drift.
#ifndef VISTA_SYSTEM_TIMING_H
#define VISTA_SYSTEM_TIMING_H

#include <cmath>
#include <cstdint>
#include <deque>
#include <systemc>
#include <utility>

namespace vista {

inline sc_core::sc_time from_ps(int64_t ps) { return sc_core::sc_time::from_value(static_cast<uint64_t>(ps)); }
inline sc_core::sc_time from_ns(double ns) { return from_ps(std::llround(ns * 1e3)); }
inline int64_t now_ps() { return static_cast<int64_t>(sc_core::sc_time_stamp().value()); }

// Suspends the calling process until then; not at all when that has passed.
inline void wait_until(int64_t ps) {
  if (ps > now_ps()) sc_core::wait(from_ps(ps - now_ps()));
}

// Edges are numbered from the start of the simulation; each is rounded by itself.
class ClockEdges {
 public:
  explicit ClockEdges(double hz) : period_ps_(1e12 / hz) {}
  int64_t ps(int64_t edge) const { return static_cast<int64_t>(static_cast<double>(edge) * period_ps_ + 0.5); }
  int64_t at_or_after(int64_t ps_time) const {
    int64_t edge = static_cast<int64_t>(static_cast<double>(ps_time) / period_ps_);
    while (edge > 0 && ps(edge - 1) >= ps_time) --edge;
    while (ps(edge) < ps_time) ++edge;
    return edge;
  }

 private:
  double period_ps_;
};

// Hands items from one process to another, each at a time that may lie ahead of the kernel's: the engine runs ahead of it.
template <class Item>
class TimedQueue {
 public:
  void push(int64_t ps, const Item& item) {
    items_.emplace_back(ps, item);
    pushed_.notify(sc_core::SC_ZERO_TIME);
  }
  // Suspends until an item's time has come.
  Item pop() {
    while (items_.empty()) sc_core::wait(pushed_);
    wait_until(items_.front().first);
    Item item = items_.front().second;
    items_.pop_front();
    return item;
  }
  // Takes the items whose time has come.
  template <class Take>
  void drain(int64_t ps, Take take) {
    for (; !items_.empty() && items_.front().first <= ps; items_.pop_front()) take(items_.front().second);
  }

 private:
  std::deque<std::pair<int64_t, Item>> items_;
  sc_core::sc_event pushed_;
};

}  // namespace vista

#endif

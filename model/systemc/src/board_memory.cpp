#include "board_memory.h"

#include <algorithm>

namespace vista {

void BoardReader::read(int64_t address, int64_t words) {
  wanted_.push_back({address, words});
  coming_ += words;
}

int64_t BoardReader::next_address() {
  Range& range = wanted_.front();
  const int64_t address = range.address++;
  if (--range.words == 0) wanted_.pop_front();
  return address;
}

clocks::Sdram::Command BoardReader::command(int64_t now) {
  for (; !left_.empty() && left_.front() < now; left_.pop_front()) --held_;
  if (queue_ == 0 && addresses_.empty() && !wanted_.empty()) addresses_.emplace_back(-1, next_address());
  if (held_ >= ahead_ || addresses_.empty() || addresses_.front().first >= now) return {};
  return {true, false, addresses_.front().second};
}

void BoardReader::accepted(int64_t) {
  addresses_.pop_front();
  ++held_;
}

void BoardReader::served(int64_t clock) {
  --coming_;
  came_.push_back(memory_.edges.ps(clock + clocks::Sdram::kReadClocks + late_));
  if (!drains_) return;
  left_.push_back(came_.back());
  if (coming_ > 0) came_.pop_back();
}

void BoardReader::edge(int64_t now) {
  if (queue_ > 0 && !wanted_.empty() && addresses_.size() < queue_ && !(gives_way_to_ && gives_way_to_->bursts()))
    addresses_.emplace_back(now, next_address());
}

bool BoardReader::take(int64_t ps) {
  if (came_.empty()) memory_.advance(ps);
  if (came_.empty() || came_.front() > ps) return false;
  came_.pop_front();
  return true;
}

void BoardReader::wait_for_all() {
  while (coming_ > 0) memory_.pass(coming_);
  wait_until(came_.front());
  came_.clear();
}

bool BoardWriter::has_room(int64_t ps) {
  if (!addresses_.empty()) memory_.advance(ps);
  return addresses_.size() < queue_;
}

void BoardWriter::write(int64_t ps, int64_t address) { addresses_.emplace_back(ps, address); }

void BoardWriter::write_all(int64_t address, int64_t words) {
  next_address_ = address;
  words_left_ = words;
}

void BoardWriter::wait_until_idle() {
  flushes_ = true;
  while (!quiet()) memory_.pass(std::max<int64_t>(1, words_left_));
  flushes_ = false;
}

clocks::Sdram::Command BoardWriter::command(int64_t now) {
  for (; !leaving_.empty() && leaving_.front() < memory_.clock_; leaving_.pop_front()) --data_;
  bursts_ = !addresses_.empty() && (bursts_ || flushes_ || addresses_.size() >= burst_);
  if (!bursts_ || data_ >= kData || addresses_.front().first >= now) return {};
  return {true, true, addresses_.front().second};
}

void BoardWriter::accepted(int64_t) {
  if (follower_) follower_->read(addresses_.front().second, 1);
  addresses_.pop_front();
  ++data_;
}

void BoardWriter::edge(int64_t now) {
  if (words_left_ == 0 || addresses_.size() >= queue_) return;
  addresses_.emplace_back(now, next_address_++);
  --words_left_;
}

BoardMemory::BoardMemory(const sc_core::sc_module_name& name, const Configuration& c)
    : sc_module(name),
      store(*this, 16),
      levels(*this, 16 + 16, 0, 2, false),
      pixels(*this, 64, 2, 2, false),
      words(*this, 64, 32),
      to_host(*this, 32, 2, 1, true),
      from_host(*this, 2),
      edges(c.memory_clock_hz),
      sdram_(c.memory_clock_hz),
      ports_{&store, &levels, &pixels, &words, &to_host, &from_host} {
  store.follow(levels);
  if (c.board_cameras) to_host.give_way_to(words);
}

void BoardMemory::advance(int64_t ps) {
  if (ps > now_ps() && sc_core::sc_time_to_pending_activity() <= from_ps(ps - now_ps())) wait_until(ps);
  while (edges.ps(clock_ + 1) <= ps) {
    if (step() || !nobody_asks()) continue;
    const int64_t clocks = std::min(edges.at_or_after(ps) - 1 - clock_, sdram_.clocks_to_rest());
    if (clocks <= 0) continue;
    sdram_.rest(clocks);
    clock_ += clocks;
  }
}

void BoardMemory::pass(int64_t clocks) {
  const int64_t then = edges.ps(edges.at_or_after(now_ps()) + clocks);
  wait_until(then);
  advance(then);
}

bool BoardMemory::nobody_asks() const {
  return std::all_of(ports_.begin(), ports_.end(), [](const BoardPort* p) { return p->quiet(); });
}

bool BoardMemory::step() {
  const int64_t now = edges.ps(clock_);
  std::array<clocks::Sdram::Command, clocks::Sdram::kPorts> commands;
  bool works = false;
  for (size_t i = 0; i < commands.size(); ++i) {
    commands[i] = ports_[i]->command(now);
    works = works || commands[i].valid;
  }
  sdram_.edge(commands);
  for (size_t i = 0; i < commands.size(); ++i) {
    if (sdram_.accepted(static_cast<int>(i)))
      ports_[i]->accepted(now);
    else if (commands[i].valid)
      ++ports_[i]->waited_clocks_;
  }
  if (sdram_.served() >= 0) {
    BoardPort& port = *ports_[static_cast<size_t>(sdram_.served())];
    port.served(clock_);
    ++port.words_;
    ++busy_clocks_;
  }
  for (BoardPort* port : ports_) port->edge(now);
  ++clock_;
  return works || sdram_.served() >= 0;
}

std::deque<MasterCounts> BoardMemory::masters() const {
  static constexpr const char* kNames[] = {"store", "levels", "fetch0", "result0", "to_host", "from_host"};
  std::deque<MasterCounts> found;
  for (size_t i = 0; i < ports_.size(); ++i)
    found.push_back({kNames[i], 0, 4 * ports_[i]->words_, ports_[i]->words_, edges.ps(ports_[i]->waited_clocks_)});
  return found;
}

}  // namespace vista

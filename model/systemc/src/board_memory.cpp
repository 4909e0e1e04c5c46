#include "board_memory.h"

#include <algorithm>

namespace vista {

void BoardReader::read(int64_t address, int64_t words) {
  wanted_.push_back({address, words});
  memory_.wake();
}

int64_t BoardReader::next_address() {
  Range& range = wanted_.front();
  const int64_t address = range.address++;
  if (--range.words == 0) wanted_.pop_front();
  return address;
}

clocks::Sdram::Command BoardReader::command(int64_t now) {
  for (; !taken_.empty() && taken_.front() < now; taken_.pop_front()) --held_;
  if (queue_ == 0 && addresses_.empty() && !wanted_.empty()) addresses_.emplace_back(-1, next_address());
  if (held_ >= ahead_ || addresses_.empty() || addresses_.front().first >= now) return {};
  return {true, false, addresses_.front().second};
}

void BoardReader::accepted(int64_t) {
  addresses_.pop_front();
  ++held_;
}

void BoardReader::served(int64_t clock) {
  came_.push_back(memory_.edges.ps(clock + clocks::Sdram::kReadClocks + late_));
  arrival_.notify(sc_core::SC_ZERO_TIME);
}

void BoardReader::edge(int64_t now) {
  if (queue_ > 0 && !wanted_.empty() && addresses_.size() < queue_) addresses_.emplace_back(now, next_address());
}

bool BoardWriter::has_room(int64_t ps) {
  if (!addresses_.empty()) wait_until(ps);
  return addresses_.size() < queue_;
}

void BoardWriter::write(int64_t ps, int64_t address) {
  addresses_.emplace_back(ps, address);
  memory_.wake();
}

clocks::Sdram::Command BoardWriter::command(int64_t now) {
  for (; !leaving_.empty() && leaving_.front() < memory_.clock_; leaving_.pop_front()) --data_;
  if (data_ >= kData || addresses_.empty() || addresses_.front().first >= now) return {};
  return {true, true, addresses_.front().second};
}

void BoardWriter::accepted(int64_t) {
  if (follower_) follower_->read(addresses_.front().second, 1);
  addresses_.pop_front();
  ++data_;
  if (addresses_.empty()) emptied_.notify(sc_core::SC_ZERO_TIME);
}

BoardMemory::BoardMemory(const sc_core::sc_module_name& name, const Configuration& c)
    : sc_module(name),
      store(*this, 16),
      levels(*this, 16 + 16, 0, 2),
      pixels(*this, 64, 2, 2),
      words(*this, 2),
      to_host(*this, 32, 2, 1),
      from_host(*this, 2),
      edges(c.memory_clock_hz),
      sdram_(c.memory_clock_hz),
      ports_{&store, &levels, &pixels, &words, &to_host, &from_host} {
  store.follow(levels);
  SC_HAS_PROCESS(BoardMemory);
  SC_METHOD(step);
  dont_initialize();
  sensitive << tick_;
}

void BoardMemory::wake() {
  if (awake_) return;
  awake_ = true;
  const int64_t now = clock_now(), next = now_ps() <= middle_of(now) ? now : now + 1;
  if (next > clock_) {
    sdram_.rest(next - clock_);
    clock_ = next;
  }
  tick_.notify(from_ps(std::max<int64_t>(0, middle_of(clock_) - now_ps())));
}

void BoardMemory::step() {
  const int64_t now = edges.ps(clock_);
  std::array<clocks::Sdram::Command, clocks::Sdram::kPorts> commands;
  for (size_t i = 0; i < commands.size(); ++i) commands[i] = ports_[i]->command(now);
  sdram_.edge(commands);
  for (size_t i = 0; i < commands.size(); ++i) {
    if (sdram_.accepted(static_cast<int>(i)))
      ports_[i]->accepted(now);
    else if (commands[i].valid)
      ++ports_[i]->waited_clocks_;
  }
  bool quiet = sdram_.quiet();
  if (sdram_.served() >= 0) {
    BoardPort& port = *ports_[static_cast<size_t>(sdram_.served())];
    port.served(clock_);
    ++port.words_;
    ++busy_clocks_;
  }
  for (BoardPort* port : ports_) {
    port->edge(now);
    quiet = quiet && port->quiet();
  }
  ++clock_;
  awake_ = !quiet;
  if (awake_) tick_.notify(from_ps(middle_of(clock_) - now_ps()));
}

std::deque<MasterCounts> BoardMemory::masters() const {
  static constexpr const char* kNames[] = {"store", "levels", "fetch0", "result0", "to_host", "from_host"};
  std::deque<MasterCounts> found;
  for (size_t i = 0; i < ports_.size(); ++i)
    found.push_back({kNames[i], 0, 4 * ports_[i]->words_, ports_[i]->words_, edges.ps(ports_[i]->waited_clocks_)});
  return found;
}

}  // namespace vista

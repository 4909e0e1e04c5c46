// LiteDRAM 2024.12 as rtl/board/gateware/memory.py builds it, clock by clock and without its data: the crossbar, which
// gives each bank to one port until that port's commands are through; the bank machines with their queues and rows; the
// multiplexer, which turns between reads and writes; and the refresher. One command goes to the chip a clock. Names and
// rules are those of litedram/core: crossbar.py, bankmachine.py, multiplexer.py, refresher.py.
#ifndef VISTA_CLOCKS_SDRAM_H
#define VISTA_CLOCKS_SDRAM_H

#include <array>
#include <cmath>
#include <cstdint>

namespace vista::clocks {

// Timing of the M12L64322A, in clocks, each counted from one command to the next that may follow.
struct SdramTiming {
  explicit SdramTiming(double hz)
      : precharge(clocks(15, hz)),
        activate(clocks(15, hz)),
        refresh(clocks(55, hz)),
        refresh_interval(clocks(64e6 / 4096, hz)),
        activate_to_activate(clocks(55, hz)),
        activate_to_precharge(clocks(40, hz)),
        write_to_precharge(kWriteLatency + clocks(15, hz) + 1),
        write_to_read(kWriteLatency + 2 + 1) {}

  int precharge, activate, refresh, refresh_interval;
  int activate_to_activate, activate_to_precharge, write_to_precharge, write_to_read;

 private:
  static constexpr int kWriteLatency = 2;  // the CAS latency, which LiteDRAM takes for writes, too
  static int clocks(double ns, double hz) { return static_cast<int>(std::ceil(ns * hz / 1e9)); }
};

class Sdram {
 public:
  static constexpr int kPorts = 6, kBanks = 4, kRowWords = 256;
  // Clocks from a word's command to the word at its port; and until a port's word to write has left it.
  static constexpr int kReadClocks = 5, kWriteClocks = 1;

  // What a port asks for in a clock.
  struct Command {
    bool valid = false, writes = false;
    int64_t address = 0;  // of a word
  };

  explicit Sdram(double hz) : timing_(hz), until_refresh_(timing_.refresh_interval - 1) {}

  // A rising edge with the commands before it.
  void edge(const std::array<Command, kPorts>& commands);

  // What happened in the clock that this edge ended: the ports whose commands were taken, and the one whose word the
  // chip was told to read or to write; -1: none.
  bool accepted(int port) const { return accepted_[static_cast<size_t>(port)]; }
  int served() const { return served_; }

  // How many clocks without any command would only be counted, and to count them.
  int64_t clocks_to_rest() const;
  void rest(int64_t clocks);

 private:
  static constexpr int kQueue = 8, kReadTime = 32, kWriteTime = 16, kReadToWrite = 3;

  struct Entry {
    int64_t row = 0;
    bool writes = false;
  };
  enum class Kind { kNone, kRead, kWrite, kPrecharge, kActivate };
  struct Bank {
    enum class State { kRegular, kPrecharge, kAutoPrecharge, kActivate, kRefresh } state = State::kRegular;
    int port = 0;  // that has it
    std::array<Entry, kQueue> queue;
    int first = 0, queued = 0;
    bool buffered = false;  // `buffer`, the command under work, is one
    Entry buffer;
    bool opened = false;
    int64_t row = 0;
    int wait = 0;  // clocks until the next state
    int64_t precharge_from = 0, written_from = 0, activate_from = 0;  // clocks

    bool locked() const { return queued > 0 || buffered; }
    bool rests() const { return !locked() && state == State::kRegular && wait == 0; }
    const Entry& next() const { return queue[static_cast<size_t>(first)]; }
  };
  enum class Direction { kRead, kWrite, kReadToWrite, kWriteToRead, kRefresh };

  void route(const std::array<Command, kPorts>& commands, const std::array<bool, kBanks>& locked);
  Kind command_of(const Bank& bank) const;
  void advance(Bank& bank, Kind kind, bool done, bool refreshing);
  Direction turned(bool reads, bool writes) const;
  void advance_refresh();
  bool refreshing() const { return refresh_ == Refresh::kWait || (refresh_ == Refresh::kDo && refresh_clocks_ > 0); }
  bool may_precharge(const Bank& bank) const { return clock_ >= bank.precharge_from && clock_ >= bank.written_from; }
  template <class Wants>
  static int next_in_turn(int last, int count, Wants wants);

  SdramTiming timing_;
  int64_t clock_ = 0;
  std::array<Bank, kBanks> banks_;
  std::array<bool, kPorts> accepted_{};
  int served_ = -1, chosen_ = 0;
  Direction direction_ = Direction::kRead;
  int direction_clocks_ = 0;  // since it is that
  int64_t read_from_ = 0;  // after a write
  int until_refresh_;
  bool refresh_due_ = false;
  enum class Refresh { kIdle, kWait, kDo } refresh_ = Refresh::kIdle;
  int refresh_clocks_ = 0;
};

// The next after `last` that wants; `last` when no other does.
template <class Wants>
int Sdram::next_in_turn(int last, int count, Wants wants) {
  for (int turn = 1; turn < count; ++turn)
    if (wants((last + turn) % count)) return (last + turn) % count;
  return last;
}

inline int64_t Sdram::clocks_to_rest() const {
  for (const Bank& bank : banks_)
    if (!bank.rests()) return 0;
  const bool settled = direction_ == Direction::kRead || direction_ == Direction::kWrite;
  return settled && refresh_ == Refresh::kIdle && !refresh_due_ ? until_refresh_ : 0;
}

inline void Sdram::rest(int64_t clocks) {
  clock_ += clocks;
  direction_clocks_ += static_cast<int>(clocks);
  until_refresh_ -= static_cast<int>(clocks);
}

inline void Sdram::route(const std::array<Command, kPorts>& commands, const std::array<bool, kBanks>& locked) {
  accepted_.fill(false);
  std::array<unsigned, kBanks> wanting{};  // a bit for each port
  for (size_t port = 0; port < kPorts; ++port) {
    if (!commands[port].valid) continue;
    const size_t bank = static_cast<size_t>(commands[port].address / kRowWords % kBanks);
    // A port whose commands are still in one bank has to wait with those for another.
    bool waits = false;
    for (size_t other = 0; other < kBanks; ++other)
      waits = waits || (other != bank && locked[other] && banks_[other].port == static_cast<int>(port));
    if (!waits) wanting[bank] |= 1U << port;
  }
  for (size_t b = 0; b < kBanks; ++b) {
    Bank& bank = banks_[b];
    const bool wants = (wanting[b] >> bank.port & 1U) != 0;
    const bool enters = wants && bank.queued < kQueue;
    // The queue's oldest goes on into the buffer, unless that is taken; it is served, if at all, before.
    if (bank.queued > 0 && !bank.buffered) {
      bank.buffer = bank.next();
      bank.buffered = true;
      bank.first = (bank.first + 1) % kQueue;
      --bank.queued;
    }
    if (enters) {
      const Command& command = commands[static_cast<size_t>(bank.port)];
      accepted_[static_cast<size_t>(bank.port)] = true;
      bank.queue[static_cast<size_t>((bank.first + bank.queued) % kQueue)] = {command.address / (kRowWords * kBanks),
                                                                              command.writes};
      ++bank.queued;
    }
    if (!wants && !locked[b] && wanting[b] != 0)
      bank.port = next_in_turn(bank.port, kPorts, [&](int port) { return (wanting[b] >> port & 1U) != 0; });
  }
}

inline Sdram::Kind Sdram::command_of(const Bank& bank) const {
  using State = Bank::State;
  if (bank.wait > 0) return Kind::kNone;
  switch (bank.state) {
    case State::kRegular:
      if (refreshing() || !bank.buffered || !bank.opened || bank.row != bank.buffer.row) return Kind::kNone;
      return bank.buffer.writes ? Kind::kWrite : Kind::kRead;
    case State::kPrecharge:
      return may_precharge(bank) ? Kind::kPrecharge : Kind::kNone;
    case State::kActivate:
      return clock_ >= bank.activate_from ? Kind::kActivate : Kind::kNone;
    default:
      return Kind::kNone;
  }
}

inline void Sdram::advance(Bank& bank, Kind kind, bool done, bool refreshing) {
  using State = Bank::State;
  if (bank.wait > 0) {
    --bank.wait;
    return;
  }
  switch (bank.state) {
    case State::kRegular:
      if (refreshing) {
        bank.state = State::kRefresh;
      } else if (bank.buffered && !bank.opened) {
        bank.state = State::kActivate;
      } else if (bank.buffered && bank.row != bank.buffer.row) {
        bank.state = State::kPrecharge;
      } else if (done) {
        if (kind == Kind::kWrite) bank.written_from = clock_ + timing_.write_to_precharge;
        if (bank.queued > 0 && bank.next().row != bank.buffer.row) bank.state = State::kAutoPrecharge;
        bank.buffered = false;
      }
      break;
    case State::kPrecharge:
      bank.opened = false;
      if (!done) break;
      bank.state = State::kActivate;
      bank.wait = timing_.precharge - 1;
      break;
    case State::kAutoPrecharge:
      bank.opened = false;
      if (!may_precharge(bank)) break;
      bank.state = State::kActivate;
      bank.wait = timing_.precharge - 1;
      break;
    case State::kActivate:
      if (kind != Kind::kActivate) break;
      bank.opened = true;
      bank.row = bank.buffer.row;
      if (!done) break;
      bank.activate_from = clock_ + timing_.activate_to_activate;
      bank.precharge_from = clock_ + timing_.activate_to_precharge;
      bank.state = State::kRegular;
      bank.wait = timing_.activate - 1;
      break;
    case State::kRefresh:
      bank.opened = false;
      if (!refreshing) bank.state = State::kRegular;
      break;
  }
}

inline Sdram::Direction Sdram::turned(bool reads, bool writes) const {
  bool all_granted = true;
  for (const Bank& bank : banks_)
    all_granted = all_granted && bank.state == Bank::State::kRefresh && clock_ >= bank.written_from;
  switch (direction_) {
    case Direction::kRead:
      if (all_granted) return Direction::kRefresh;
      return writes && (!reads || direction_clocks_ >= kReadTime - 1) ? Direction::kReadToWrite : direction_;
    case Direction::kWrite:
      if (all_granted) return Direction::kRefresh;
      return reads && (!writes || direction_clocks_ >= kWriteTime - 1) ? Direction::kWriteToRead : direction_;
    case Direction::kReadToWrite:
      return direction_clocks_ == kReadToWrite - 1 ? Direction::kWrite : direction_;
    case Direction::kWriteToRead:
      return clock_ >= read_from_ ? Direction::kRead : direction_;
    case Direction::kRefresh:
      return refresh_ == Refresh::kDo && refresh_clocks_ == 0 ? Direction::kRead : direction_;
  }
  return direction_;
}

inline void Sdram::advance_refresh() {
  const bool due = refresh_due_;
  refresh_due_ = until_refresh_ == 0;
  until_refresh_ = refresh_due_ ? timing_.refresh_interval - 1 : until_refresh_ - 1;
  switch (refresh_) {
    case Refresh::kIdle:
      if (due) refresh_ = Refresh::kWait;
      break;
    case Refresh::kWait:
      if (direction_ != Direction::kRefresh) break;
      refresh_ = Refresh::kDo;
      refresh_clocks_ = timing_.precharge + timing_.refresh;
      break;
    case Refresh::kDo:
      if (refresh_clocks_ == 0) refresh_ = Refresh::kIdle;
      --refresh_clocks_;
      break;
  }
}

inline void Sdram::edge(const std::array<Command, kPorts>& commands) {
  std::array<Kind, kBanks> kinds;
  bool reads = false, writes = false;
  for (size_t b = 0; b < kBanks; ++b) {
    kinds[b] = banks_[b].rests() ? Kind::kNone : command_of(banks_[b]);
    reads = reads || kinds[b] == Kind::kRead;
    writes = writes || kinds[b] == Kind::kWrite;
  }
  // One command, of the bank that was chosen in the clock before.
  const bool moves = direction_ == Direction::kRead || direction_ == Direction::kWrite;
  const auto suits = [&](int bank) {
    switch (kinds[static_cast<size_t>(bank)]) {
      case Kind::kNone:
        return false;
      case Kind::kRead:
        return direction_ == Direction::kRead;
      case Kind::kWrite:
        return direction_ == Direction::kWrite;
      default:
        return true;
    }
  };
  const bool valid = suits(chosen_), done = valid && moves;
  const int working = chosen_;
  served_ = -1;
  if (done) {
    const Kind kind = kinds[static_cast<size_t>(working)];
    if (kind == Kind::kRead || kind == Kind::kWrite) served_ = banks_[static_cast<size_t>(working)].port;
    if (kind == Kind::kWrite) read_from_ = clock_ + timing_.write_to_read;
  }
  if (moves || !valid) chosen_ = next_in_turn(working, kBanks, suits);

  std::array<bool, kBanks> locked;
  for (size_t b = 0; b < kBanks; ++b) locked[b] = banks_[b].locked();
  const bool refreshing = this->refreshing();
  const Direction direction = turned(reads, writes);
  advance_refresh();
  direction_clocks_ = direction == direction_ ? direction_clocks_ + 1 : 0;
  direction_ = direction;
  for (size_t b = 0; b < kBanks; ++b)
    if (refreshing || !banks_[b].rests())
      advance(banks_[b], kinds[b], done && static_cast<int>(b) == working, refreshing);
  route(commands, locked);
  ++clock_;
}

}  // namespace vista::clocks

#endif

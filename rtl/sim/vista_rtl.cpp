// SPDX-License-Identifier: Apache-2.0
// Drives the Verilated engine at C++ speed: vista_rtl.h. Built by `make rtl-engine`, and by the benches with waves,
// coverage or mutants (tb/common/verilated.py). With the front end the buffer of its pyramid is here; without, its
// streams rest.

extern "C" {
#include "vista_rtl.h"
}

#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "Vvista_stereo.h"
#include "stall_pattern.h"
#include "verilated.h"
#ifdef VISTA_COVERAGE
#include "verilated_cov.h"
#endif
#ifdef VISTA_MUTANTS
#include "Vvista_stereo___024root.h"
#endif

#ifdef VISTA_UPSETS
#include "verilated_sym_props.h"
#include "verilated_syms.h"
#endif

#ifdef VISTA_WAVES
#include "verilated_vcd_c.h"
#endif

struct vista_rtl {
  VerilatedContext context;
#ifdef VISTA_WAVES
  VerilatedVcdC waves;  // closes its file when it goes
#endif
  std::unique_ptr<Vvista_stereo> top;
  int64_t clock = 0;
  struct Write {
    int64_t after, before;
    uint32_t address, data;
  };
  std::deque<Write> queued;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> record{nullptr, std::fclose};

  explicit vista_rtl(uint32_t seed) {
    context.randReset(2);
    context.fatalOnError(false);  // an assertion that fails is told by vista_rtl_failed
    context.randSeed(static_cast<int>(seed ? seed : 1));
#ifdef VISTA_WAVES
    context.traceEverOn(true);
#endif
    top = std::make_unique<Vvista_stereo>(&context);
#ifdef VISTA_WAVES
    top->trace(&waves, 99);
    waves.open(VISTA_WAVES);
#endif
    top->clk_i = 0;
    top->rst_ni = 0;
    top->s_axis_tvalid = top->m_axis_tready = 0;
    top->s_axil_awvalid = top->s_axil_wvalid = top->s_axil_arvalid = 0;
    top->s_axil_bready = top->s_axil_rready = 1;
    top->s_axil_wstrb = 15;
    top->store_axis_tready = 1;
    top->fetch_axis_tvalid = 0;
    top->eval();
    find_cells();
  }

  // Inputs were set: settle, then one rising edge.
  void edge() {
    top->eval();
    settled_edge();
  }

  // The same where eval() was called after the last input was set.
  void settled_edge() {
    Verilated::threadContextp(&context);  // there may be several engines; assertions fail in this one
    if (record) write_record();
    take_levels();
    const bool taken = top->s_axis_tvalid && top->s_axis_tready;
    top->clk_i = 1;
    top->eval();
#ifdef VISTA_WAVES
    waves.dump(static_cast<uint64_t>(10 * clock));
#endif
    top->clk_i = 0;
    offer_levels();
    top->eval();
#ifdef VISTA_WAVES
    waves.dump(static_cast<uint64_t>(10 * clock + 5));
#endif
    ++clock;
    if (clock == upset_clock) {
      *upset_byte = static_cast<uint8_t>(*upset_byte ^ upset_mask);
      top->eval();
    }
    if (left_over && taken) top->s_axis_tvalid = left_over = false;
  }

  // A register, or a memory of several entries.
  struct Cell {
    std::string name;
    uint8_t* data;
    uint32_t entries, bits, bytes;  // the last two of an entry
  };
  std::vector<Cell> cells;
  int64_t upset_clock = -1;
  uint8_t* upset_byte = nullptr;
  uint8_t upset_mask = 0;

  int32_t response = 0;    // to the last access
  bool left_over = false;  // a beat is still offered that the last stream could not send: a bus may not withdraw it

  // The first of the queued writes goes on by one clock, beside the streams, before the edge. The channels are free again
  // once its response has come.
  void step_writes(int64_t taken) {
    if (queued.empty() || (!writing_ && taken < queued.front().after)) return;
    if (!writing_) {
      top->s_axil_awaddr = queued.front().address;
      top->s_axil_wdata = queued.front().data;
      top->s_axil_awvalid = top->s_axil_wvalid = 1;
      writing_ = true;
    } else if (accepted_) {
      top->s_axil_awvalid = top->s_axil_wvalid = 0;
    }
    top->eval();
    accepted_ = top->s_axil_awvalid && top->s_axil_awready;  // the address together with the data
    if (top->s_axil_bvalid) {
      queued.pop_front();
      writing_ = false;
    }
  }

  // The beat may not be offered yet.
  bool waits_for_write(int64_t beat) const { return !queued.empty() && queued.front().before <= beat; }

  void reset(int clocks) {
    top->rst_ni = 0;
    top->s_axis_tvalid = left_over = false;
    for (int i = 0; i < clocks; ++i) edge();
    top->rst_ni = 1;
    edge();
  }

 private:
  // The buffer of the pyramid is as large as it has to be, and always prompt.
  struct Beat {
    uint16_t data;
    bool user, last;
  };
  std::deque<Beat> levels_;

  void take_levels() {
    auto& t = *top;
    if (t.fetch_axis_tvalid && t.fetch_axis_tready) levels_.pop_front();
    if (t.store_axis_tvalid) levels_.push_back({t.store_axis_tdata, t.store_axis_tuser != 0, t.store_axis_tlast != 0});
    if (!t.store_rst_no || !t.rst_ni) levels_.clear();
  }

  void offer_levels() {
    auto& t = *top;
    t.fetch_axis_tvalid = !levels_.empty();
    if (levels_.empty()) return;
    t.fetch_axis_tdata = levels_.front().data;
    t.fetch_axis_tuser = levels_.front().user;
    t.fetch_axis_tlast = levels_.front().last;
  }

  // Inputs and outputs just before an edge, as tb/icarus/replay.v reads them.
  void write_record() {
    const auto& t = *top;
    const bool word = t.m_axis_tvalid;
    std::fprintf(record.get(), "%d %d%d%d %04x %d %d %x %d %08x %d %d %x %d | %d%d%d%d%d%d%d%d%d%d %08x %08x\n",
                 t.rst_ni, t.s_axis_tvalid, t.s_axis_tuser, t.s_axis_tlast, t.s_axis_tdata, t.m_axis_tready,
                 t.s_axil_awvalid, t.s_axil_awaddr, t.s_axil_wvalid, t.s_axil_wdata, t.s_axil_bready, t.s_axil_arvalid,
                 t.s_axil_araddr, t.s_axil_rready, t.s_axis_tready, word, t.s_axil_awready, t.s_axil_wready,
                 t.s_axil_bvalid, t.s_axil_arready, t.s_axil_rvalid, word && t.m_axis_tuser, word && t.m_axis_tlast,
                 t.irq_o, t.m_axis_tdata, t.s_axil_rdata);
  }

  void find_cells() {
#ifdef VISTA_UPSETS
    for (const auto& [scope_name, scope] : *context.scopeNameMap()) {
      if (!scope->varsp()) continue;
      for (const auto& [name, variable] : *scope->varsp()) {
        if (variable.isParam() || variable.vltype() == VLVT_STRUCT) continue;  // its fields are variables too
        uint32_t entries = 1;
        for (const VerilatedRange& range : variable.unpackedRanges())
          entries *= static_cast<uint32_t>(range.elements());
        cells.push_back({std::string(scope_name) + "." + name, static_cast<uint8_t*>(variable.datap()), entries,
                         variable.entBits(), variable.entSize()});
      }
    }
#endif
  }

  bool writing_ = false, accepted_ = false;
};

extern "C" {

vista_rtl* vista_rtl_create(uint32_t seed) {
  auto* engine = new vista_rtl(seed);
  engine->reset(8);
  return engine;
}

void vista_rtl_destroy(vista_rtl* engine) {
  engine->top->final();
  delete engine;
}

void vista_rtl_reset(vista_rtl* engine, int32_t clocks) { engine->reset(clocks); }

void vista_rtl_write(vista_rtl* engine, uint32_t address, uint32_t data) {
  auto& e = *engine;
  auto& t = *e.top;
  t.s_axil_awaddr = address;
  t.s_axil_wdata = data;
  t.s_axil_awvalid = t.s_axil_wvalid = 1;
  while (t.s_axil_awvalid || t.s_axil_wvalid) {
    t.eval();
    const bool address_taken = t.s_axil_awready, data_taken = t.s_axil_wready;
    e.edge();
    if (address_taken) t.s_axil_awvalid = 0;
    if (data_taken) t.s_axil_wvalid = 0;
  }
  for (t.eval(); !t.s_axil_bvalid;) e.edge();
  e.response = t.s_axil_bresp;
  e.edge();
}

uint32_t vista_rtl_read(vista_rtl* engine, uint32_t address) {
  auto& e = *engine;
  auto& t = *e.top;
  t.s_axil_araddr = address;
  t.s_axil_arvalid = 1;
  for (bool taken = false; !taken;) {
    t.eval();
    taken = t.s_axil_arready;
    e.edge();
  }
  t.s_axil_arvalid = 0;
  for (t.eval(); !t.s_axil_rvalid;) e.edge();
  const uint32_t data = t.s_axil_rdata;
  e.response = t.s_axil_rresp;
  e.edge();
  return data;
}

int64_t vista_rtl_stream(vista_rtl* engine, const uint32_t* beats, int64_t num_in, const uint32_t* in_pace,
                         const uint32_t* out_pace, uint64_t seed, int64_t max_out, int64_t quiet, int64_t max_clocks,
                         uint32_t* out_data, uint8_t* out_flags, int64_t* in_clock, int64_t* out_clock,
                         int64_t* num_taken) {
  auto& e = *engine;
  auto& t = *e.top;
  vista::Random random(seed);
  vista::Pace in{in_pace[0], in_pace[1]}, out{out_pace[0], out_pace[1]};
  int64_t taken = 0, words = 0, idle = 0;
  bool offered = false;
  for (int64_t n = 0; n < max_clocks && (words < max_out || taken < num_in || !e.queued.empty()) && idle < quiet; ++n) {
    // A beat that waits for a write is offered in the clock of its response.
    e.step_writes(taken);
    if (!e.left_over && !offered && taken < num_in && !e.waits_for_write(taken) && in.step(random)) {
      offered = true;
      t.s_axis_tdata = beats[taken] & 0xFFFF;
      t.s_axis_tuser = beats[taken] >> 16 & 1;
      t.s_axis_tlast = beats[taken] >> 17 & 1;
    }
    t.s_axis_tvalid = offered || e.left_over;
    t.m_axis_tready = out.step(random) && words < max_out;
    t.eval();
    ++idle;
    if (offered && t.s_axis_tready) {
      if (in_clock) in_clock[taken] = e.clock;
      ++taken;
      offered = false;
      idle = 0;
    }
    if (t.m_axis_tvalid && t.m_axis_tready) {
      out_data[words] = t.m_axis_tdata;
      out_flags[words] = static_cast<uint8_t>(t.m_axis_tuser | t.m_axis_tlast << 1);
      if (out_clock) out_clock[words] = e.clock;
      ++words;
      idle = 0;
    }
    e.settled_edge();
  }
  e.left_over = offered || e.left_over;
  t.s_axis_tvalid = e.left_over;
  t.m_axis_tready = 0;
  t.eval();
  *num_taken = taken;
  return words;
}

void vista_rtl_queue_write(vista_rtl* engine, int64_t after, int64_t before, uint32_t address, uint32_t data) {
  engine->queued.push_back({after, before, address, data});
}

int32_t vista_rtl_response(const vista_rtl* engine) { return engine->response; }

int32_t vista_rtl_interrupt(const vista_rtl* engine) { return engine->top->irq_o; }

int32_t vista_rtl_failed(const vista_rtl* engine) { return engine->context.gotError(); }

int32_t vista_rtl_record(vista_rtl* engine, const char* path) {
  engine->record.reset(path ? std::fopen(path, "w") : nullptr);
  return !path || engine->record;
}

void vista_rtl_select_mutant(vista_rtl* engine, uint32_t number) {
#ifdef VISTA_MUTANTS
  engine->top->rootp->vista_stereo__DOT__u_core__DOT__mutsel = number;
#else
  (void)engine;
  (void)number;
#endif
}

int32_t vista_rtl_cell(vista_rtl* engine, uint32_t number, char* name, int32_t size, uint32_t* shape) {
  if (number >= engine->cells.size()) return 0;
  const auto& cell = engine->cells[number];
  std::snprintf(name, static_cast<size_t>(size), "%s", cell.name.c_str());
  shape[0] = cell.entries;
  shape[1] = cell.bits;
  return 1;
}

int64_t vista_rtl_clock(const vista_rtl* engine) { return engine->clock; }

void vista_rtl_upset(vista_rtl* engine, uint32_t cell, uint32_t entry, uint32_t bit, int64_t clocks) {
  const auto& hit = engine->cells[cell];
  engine->upset_byte = hit.data + static_cast<size_t>(entry) * hit.bytes + bit / 8;  // the host is little-endian
  engine->upset_mask = static_cast<uint8_t>(1u << bit % 8);
  engine->upset_clock = engine->clock + clocks;
}

void vista_rtl_write_coverage(vista_rtl* engine, const char* path) {
#ifdef VISTA_COVERAGE
  engine->context.coveragep()->write(path);
#else
  (void)engine;
  (void)path;
#endif
}
}

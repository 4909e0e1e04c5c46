# SPDX-License-Identifier: Apache-2.0
# Targets of the board, for the top Makefile.

BOARD_TOOLS := .venv/board.stamp $(RTL_TOOLS)
# Those of rtl/vista_camera.f that the engine has not.
CAMERA_SOURCES := $(filter-out %_pkg.sv %/vista_memory.sv,$(shell grep -sv "^//" rtl/vista_camera.f))
BOARD_SOURCES := $(wildcard rtl/board/*.py rtl/board/*.toml rtl/board/gateware/*.py)
BOARD_WIRE := $(addprefix rtl/board/sim/,simulation.cpp ethernet.cpp sensors.cpp simulation.h ethernet.h sensors.h)
comma := ,
BOARD_BUILD = d$(D)_b$(B)_w$(W)_r$(if $(filter-out 0,$(R)),$(R),64)

# For the Colorlight i9, unless others are given: what fits on its LFE5U-45F.
given = $(if $(filter command environment,$(firstword $(origin $(1)))),$($(1)),$(2))
PACKETS ?= 100000
SEED ?= 1
MHZ ?= 45
ADDRESS ?= 192.168.1.50
BITSTREAM = --disparities $(D) --block $(B) --width $(call given,W,640) --rows $(call given,R,32) \
  --points $(call given,P,1271) $(if $(CAMERAS),--cameras) --mhz $(MHZ) --address $(ADDRESS)

.PHONY: board-sim board-clocks bitstream soak-packets

.venv/board.stamp: $(REQUIREMENTS)/board.txt $(REQUIREMENTS)/litex_boards.txt $(SETUP) .venv/test.stamp
	@$(SETUP) board

bitstream: $(BOARD_TOOLS) ## build the bitstream for a Colorlight i9 with the given IPv4 ADDRESS, at MHZ; CAMERAS=1: with two sensors
	@$(RTL_PYTHON) rtl/flow/make_bitstream.py $(BITSTREAM)

board-sim: build/board/$(BOARD_BUILD)/board-sim ## build the simulated board for D disparities, block B, frames up to W pixels wide, and R rows of the rectification (0: 64)
	@echo "start it with: $< --port 22099"

board-clocks: build/board/$(BOARD_BUILD)/board-clocks ## build the simulated board together with its client, to count clocks; D, B, W and R as of board-sim
	@echo "start it with: $< WIDTH HEIGHT LEVELS FRAMES"

# The gateware as a library, and the programs around it. libvista is that of `make build`.
BOARD_GATEWARE = build/board/%/verilated/libVboard.a
.PRECIOUS: $(BOARD_GATEWARE)

$(BOARD_GATEWARE): $(BOARD_SOURCES) $(RTL_SOURCES) $(wildcard rtl/csr/*.sv rtl/*.f rtl/formal/*.svh) | $(BOARD_TOOLS)
	@echo "verilate build/board/$*"; rm -rf build/board/$*; mkdir -p build/board/$*
	@set -- $(subst _, ,$*); side=$$(( ($${3#w} + 15) / 16 + 1 )); \
	  PYTHONPATH=rtl/board $(RTL_PYTHON) -m gateware.simulated build/board/$* $${1#d} $${2#b} $${3#w} $${4#r} $$(( side * side ))
	@$(VERILATOR) --cc --build --quiet -j 1 -O3 --x-assign fast --x-initial unique --assert \
	  -Wno-fatal -Wno-lint -Werror-USERFATAL -DVISTA_ASSERT -Irtl/formal --top-module board --prefix Vboard \
	  --Mdir $(@D) -CFLAGS -std=c++17 -MAKEFLAGS "OPT_FAST=-O1" \
	  -f rtl/vista_stereo.f $(CAMERA_SOURCES) build/board/$*/board.v >build/board/$*/build.log 2>&1 || \
	  { tail -n 20 build/board/$*/build.log >&2; exit 1; }

compile_board = root=$$($(VERILATOR) --getenv VERILATOR_ROOT); $(CXX) -std=c++17 -O2 -Wall -Wextra -Werror -o $@ \
  -Irtl/board/sim -Isw/include -Imodel/c/include -isystem $(@D)/verilated -isystem $$root/include -isystem $$root/include/vltstd \
  $(filter %.cpp,$^) $(@D)/verilated/libVboard.a $(@D)/verilated/libverilated.a -pthread

build/board/%/board-sim: rtl/board/sim/main.cpp $(BOARD_WIRE) $(BOARD_GATEWARE)
	@$(compile_board)

build/board/%/board-clocks: sw/bench/board_clocks.cpp $(BOARD_WIRE) $(BOARD_GATEWARE) build/lib/libvista.a
	@$(compile_board) build/lib/libvista.a -lm $(addprefix -Wl$(comma)--wrap=,clock_gettime nanosleep poll recv send)

# The server by itself, for more packets than the whole board gets through.
build/board/server/server.v: $(BOARD_SOURCES) | $(BOARD_TOOLS)
	@mkdir -p $(@D)
	@PYTHONPATH=rtl/board $(RTL_PYTHON) -m gateware.server_alone $(@D)

build/board/%/libserver.so: rtl/board/sim/server_alone.cpp build/board/%/server.v
	@rm -rf $(@D)/verilated
	@$(VERILATOR) --cc --build --quiet -j 1 -O3 --x-assign fast --x-initial fast -Wno-fatal -Wno-lint --top-module server \
	  --prefix Vserver --Mdir $(@D)/verilated -CFLAGS -fPIC -MAKEFLAGS "OPT_FAST=-O2" $(@D)/server.v >$(@D)/build.log 2>&1 || \
	  { tail -n 20 $(@D)/build.log >&2; exit 1; }
	@root=$$($(VERILATOR) --getenv VERILATOR_ROOT); $(CXX) -std=c++17 -O2 -Wall -Wextra -Werror -fPIC -shared -o $@ $< \
	  -isystem $(@D)/verilated -isystem $$root/include -isystem $$root/include/vltstd \
	  $(@D)/verilated/libVserver.a $(@D)/verilated/libverilated.a -pthread

soak-packets: build/board/server/libserver.so ## send PACKETS packets that a board must not obey to its Verilated server, and compare the words of the frames between them
	@$(RTL_PYTHON) rtl/flow/soak_packets.py --packets $(PACKETS) --seed $(SEED)

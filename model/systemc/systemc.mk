# Targets of the SystemC model, for the top Makefile.

SYSTEMC := build/tools/systemc
SYSTEMC_STAMP := $(SYSTEMC)/ldflags
SYSTEMC_CXXFLAGS := -O3 -std=c++17 -Wall -Wextra -Werror
SYSTEMC_SOURCES := $(wildcard model/systemc/src/*.cpp)
SYSTEMC_OBJECTS := $(SYSTEMC_SOURCES:%.cpp=$(BUILD)/obj/%.o)
SYSTEMC_LATENCY := $(BUILD)/include/vista_stereo_latency.h
SYSTEMC_TRACE := $(BUILD)/bin/vista_engine_trace# its engine alone, for tb/top/test_system_model.py
SYSTEMC_SDRAM_TRACE := $(BUILD)/bin/vista_sdram_trace# the memory of its board, for tb/top/test_sdram_model.py

.PHONY: systemc systemc-tests

systemc: $(BUILD)/bin/vista_system ## build the SystemC model of a whole system, build/bin/vista_system

systemc-tests: systemc $(SYSTEMC_TRACE) $(SYSTEMC_SDRAM_TRACE)

$(SYSTEMC_STAMP): scripts/setup_systemc.sh scripts/requirements/systemc.txt
	@$(call need,g++)scripts/setup_systemc.sh

# The latencies of the RTL are written in one place, its package.
$(SYSTEMC_LATENCY): rtl/src/vista_stereo_pkg.sv
	@mkdir -p $(@D); { echo 'namespace vista::clocks {'; sed -nE \
	  -e 's/^ *parameter int unsigned ([A-Za-z]+Latency) = ([0-9]+);.*/constexpr int k\1 = \2;/p' \
	  -e 's/.*\(num_disparities - 1\) \+ ([0-9]+);.*/constexpr int kInFlightMargin = \1;/p' $<; echo '}'; } > $@

define SYSTEMC_COMPILE
@echo "c++ $<"; mkdir -p $(@D)
@g++ $(SYSTEMC_CXXFLAGS) $(SANITIZE) $$(cat $(SYSTEMC)/cflags) -Imodel/systemc/src -Imodel/c/include -Irtl/sim -Irtl/board -I$(BUILD)/include -MMD -MP -c $< -o $@
endef

define SYSTEMC_LINK
@echo "ld $@"; mkdir -p $(@D)
@g++ $(SANITIZE) $^ $$(cat $(SYSTEMC)/ldflags) -lsystemc -pthread -Wl,-rpath,'$$ORIGIN/../lib' -o $@
endef

$(BUILD)/obj/model/systemc/%.o: model/systemc/%.cpp $(SYSTEMC_STAMP) | $(SYSTEMC_LATENCY)
	$(SYSTEMC_COMPILE)

$(BUILD)/obj/tb/systemc/%.o: tb/systemc/%.cpp $(SYSTEMC_STAMP) | $(SYSTEMC_LATENCY)
	$(SYSTEMC_COMPILE)

$(BUILD)/bin/vista_system: $(BUILD)/obj/model/systemc/apps/vista_system.o $(SYSTEMC_OBJECTS) $(BUILD)/lib/libvista_engine.so
	$(SYSTEMC_LINK)

$(SYSTEMC_TRACE): $(BUILD)/obj/tb/systemc/vista_engine_trace.o $(SYSTEMC_OBJECTS) $(BUILD)/lib/libvista_engine.so
	$(SYSTEMC_LINK)

$(SYSTEMC_SDRAM_TRACE): $(BUILD)/obj/tb/systemc/vista_sdram_trace.o
	@echo "ld $@"; mkdir -p $(@D)
	@g++ $(SANITIZE) $^ -o $@

.SECONDARY: # keep the objects of the programs
-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)

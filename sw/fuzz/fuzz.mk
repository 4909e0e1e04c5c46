# Fuzz targets of the C libraries, for the top Makefile: libFuzzer where there is a clang, else gcc over the corpus.

FUZZ_TARGETS := engine pipeline mavlink fly
FUZZ_SECONDS ?= 600
FUZZ := build/fuzz
FUZZ_CLANG := build/tools/clang/command# an empty file: there is none
FUZZ_CC = $(or $(strip $(shell cat $(FUZZ_CLANG))),gcc)
FUZZ_HAS_CLANG = $(findstring clang,$(FUZZ_CC))
FUZZ_CFLAGS = -g -O1 -std=c17 -fno-omit-frame-pointer -fno-sanitize-recover=all \
  -fsanitize=address,undefined,float-cast-overflow$(if $(FUZZ_HAS_CLANG),$(comma)fuzzer-no-link)
FUZZ_DRIVER = $(if $(FUZZ_HAS_CLANG),-fsanitize=fuzzer,sw/fuzz/run_corpus.c)
FUZZ_ENGINE := $(patsubst %.c,$(FUZZ)/obj/%.o,$(wildcard model/c/src/*.c))
FUZZ_VISTA := $(patsubst %.c,$(FUZZ)/obj/%.o,sw/fuzz/arena.c \
  $(filter-out sw/src/common/arena.c,$(shell find sw/src -name '*.c' 2>/dev/null)))
# What a link needs; of all of libvista the fuzzer would see a small part only.
FUZZ_MAVLINK := $(patsubst %.c,$(FUZZ)/obj/%.o,$(wildcard sw/src/link/mavlink/*.c) \
  sw/src/common/parameters.c sw/src/common/status.c sw/src/common/frame.c sw/src/common/median.c \
  sw/src/common/disc.c sw/src/common/flight_path.c sw/src/health/health.c sw/src/plan/trajectory.c)
# The engine has a target of its own: in the others it is neither checked nor counted as reached.
FUZZ_PLAIN_ENGINE := $(patsubst %.c,$(FUZZ)/plain/%.o,$(wildcard model/c/src/*.c))
comma := ,

.PHONY: fuzz fuzz-targets

fuzz: fuzz-targets .venv/test.stamp ## fuzz the engine, the pipeline, MAVLink and what vista-fly reads for FUZZ_SECONDS=600 each
	@$(PYTHON) scripts/run_fuzz.py --seconds $(FUZZ_SECONDS) $(FUZZ_TARGETS)

fuzz-targets: $(FUZZ_TARGETS:%=$(FUZZ)/%)

$(FUZZ_CLANG): scripts/setup_clang.sh scripts/debian_packages.sh scripts/requirements/clang.txt
	@scripts/setup_clang.sh

# make does not see that flags have changed: they are in this file.
$(FUZZ)/obj/%.o: %.c $(FUZZ_CLANG) sw/fuzz/fuzz.mk
	@mkdir -p $(@D); $(FUZZ_CC) $(FUZZ_CFLAGS) -Isw/include -Isw/src -Imodel/c/include -Irtl/csr -Irtl/board -MMD -MP -c $< -o $@

$(FUZZ)/plain/%.o: %.c $(FUZZ_CLANG) sw/fuzz/fuzz.mk
	@mkdir -p $(@D); $(FUZZ_CC) -g -O2 -std=c17 -Imodel/c/include -MMD -MP -c $< -o $@

# With all checks, their inlined kernels take clang a minute each.
$(FUZZ)/obj/model/c/src/rows_avx%.o: FUZZ_CFLAGS += -fno-sanitize=undefined,float-cast-overflow

$(FUZZ)/obj/sw/apps/fly/%.o: FUZZ_CFLAGS += -D_GNU_SOURCE

# To tell the fuzzer of each comparison took two thirds of the time of a frame, and what it tells, the numbers that a byte
# is compared with, is of use only where bytes are parsed.
FUZZ_FAST = -O2 $(if $(FUZZ_HAS_CLANG),-fno-sanitize-coverage=trace-cmp)
$(FUZZ)/obj/sw/src/%.o $(FUZZ)/obj/model/c/src/%.o: FUZZ_CFLAGS += $(FUZZ_FAST)
$(FUZZ)/obj/sw/src/link/mavlink/%.o: FUZZ_FAST =
# What draws the scenes is not what is looked at.
$(FUZZ)/obj/sw/fuzz/fuzz_pipeline.o: FUZZ_CFLAGS += $(FUZZ_FAST) -fno-sanitize=undefined,float-cast-overflow

$(FUZZ)/engine: $(FUZZ_ENGINE)
$(FUZZ)/fly: $(FUZZ_PLAIN_ENGINE) $(FUZZ_VISTA) $(patsubst %,$(FUZZ)/obj/sw/apps/fly/%.o,container problem)
$(FUZZ)/pipeline: $(FUZZ_PLAIN_ENGINE) $(FUZZ_VISTA)
$(FUZZ)/mavlink: $(FUZZ_MAVLINK)
$(FUZZ_TARGETS:%=$(FUZZ)/%): $(FUZZ)/%: $(FUZZ)/obj/sw/fuzz/fuzz_%.o sw/fuzz/run_corpus.c
	@echo "ld $@"; $(FUZZ_CC) $(FUZZ_CFLAGS) $(filter %.o,$^) $(FUZZ_DRIVER) -lm -o $@

-include $(shell find $(FUZZ)/obj $(FUZZ)/plain -name '*.d' 2>/dev/null)

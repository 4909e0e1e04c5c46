# Fuzz targets of the C libraries, for the top Makefile: libFuzzer where there is a clang, else gcc over the corpus.

FUZZ_TARGETS := engine pipeline recording
FUZZ_SECONDS ?= 600
FUZZ := build/fuzz
FUZZ_CLANG := build/tools/clang/command# an empty file: there is none
FUZZ_CC = $(or $(strip $(shell cat $(FUZZ_CLANG))),gcc)
FUZZ_HAS_CLANG = $(findstring clang,$(FUZZ_CC))
FUZZ_CFLAGS = -g -O1 -std=c17 -fno-omit-frame-pointer -fno-sanitize-recover=all \
  -fsanitize=address,undefined,float-cast-overflow$(if $(FUZZ_HAS_CLANG),$(comma)fuzzer-no-link)
FUZZ_DRIVER = $(if $(FUZZ_HAS_CLANG),-fsanitize=fuzzer,sw/fuzz/run_corpus.c)
FUZZ_ENGINE := $(ENGINE_SOURCES:%.c=$(FUZZ)/obj/%.o)
FUZZ_VISTA := $(VISTA_SOURCES:%.c=$(FUZZ)/obj/%.o)
comma := ,

.PHONY: fuzz fuzz-targets

fuzz: fuzz-targets .venv/test.stamp ## fuzz the engine, the pipeline and the reader of recordings, FUZZ_SECONDS=600 each
	@$(PYTHON) scripts/run_fuzz.py --seconds $(FUZZ_SECONDS) $(FUZZ_TARGETS)

fuzz-targets: $(FUZZ_TARGETS:%=$(FUZZ)/%)

$(FUZZ_CLANG): scripts/setup_clang.sh scripts/debian_packages.sh scripts/requirements/clang.txt
	@scripts/setup_clang.sh

$(FUZZ)/obj/%.o: %.c $(FUZZ_CLANG) | $(FUZZ)/parameter_list.h
	@mkdir -p $(@D); $(FUZZ_CC) $(FUZZ_CFLAGS) -Isw/include -Isw/src -Imodel/c/include -I$(FUZZ) -MMD -MP -c $< -o $@

# With all checks, their inlined kernels take clang a minute each.
$(FUZZ)/obj/model/c/src/rows_avx%.o: FUZZ_CFLAGS += -fno-sanitize=undefined,float-cast-overflow
$(FUZZ)/obj/sw/apps/replay.o: FUZZ_CFLAGS += -Dmain=replay_main

$(FUZZ)/engine: $(FUZZ_ENGINE)
$(FUZZ)/pipeline: $(FUZZ_VISTA)
$(FUZZ)/recording: $(FUZZ_VISTA) $(FUZZ)/obj/sw/apps/replay.o
$(FUZZ_TARGETS:%=$(FUZZ)/%): $(FUZZ)/%: $(FUZZ)/obj/sw/fuzz/fuzz_%.o sw/fuzz/run_corpus.c
	@echo "ld $@"; $(FUZZ_CC) $(FUZZ_CFLAGS) $(filter %.o,$^) $(FUZZ_DRIVER) -lm -o $@

# Name and range of every parameter that is a number.
$(FUZZ)/parameter_list.h: sw/parameters.toml
	@mkdir -p $(@D); { echo 'static const struct { const char *name; double low, high; int whole; } fuzz_parameters[] = {'; \
	awk -F ' = ' '/^\[.*\./ { name = substr($$0, 2, length($$0) - 2) } /^type/ { whole = $$2 == "\"int\"" } /^min =/ { low = $$2 } \
	  /^max =/ { printf "{\"%s\", %s, %s, %d},\n", name, low, $$2, whole }' $<; echo '};'; } > $@

-include $(shell find $(FUZZ)/obj -name '*.d' 2>/dev/null)

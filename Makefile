# VISTA: one entry point for set-up, build, tests, benches and the demo. `make help` lists the targets.
# Whatever is generated lands in build/ and .venv/; deleting both (make distclean) is always safe.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
MAKEFLAGS += --no-builtin-rules

BUILD ?= build
CC := gcc
CFLAGS := -O3 -std=c17 -Wall -Wextra -Werror -fPIC
SANITIZE :=
PYTHON := .venv/bin/python
SETUP := scripts/setup.sh
REQUIREMENTS := scripts/requirements

# One library a folder: public headers in include/, everything in src/ is compiled and linked.
ENGINE_SOURCES := $(wildcard model/c/src/*.c)
VISTA_SOURCES := $(wildcard sw/src/*.c sw/src/*/*.c sw/src/stages/parts/*.c)
APPS := $(patsubst sw/apps/%.c,$(BUILD)/bin/%,$(wildcard sw/apps/*.c))
ENGINE_OBJECTS := $(ENGINE_SOURCES:%.c=$(BUILD)/obj/%.o)
VISTA_OBJECTS := $(VISTA_SOURCES:%.c=$(BUILD)/obj/%.o)
ENGINE_HEADERS := $(wildcard model/c/include/*.h model/c/include/*/*.h)
VISTA_HEADERS := $(wildcard sw/include/vista/*.h sw/src/stages/*.h) $(patsubst %,sw/src/common/%.h,arena graph assignment disc ellipse)
LIBRARIES := $(if $(ENGINE_SOURCES),$(BUILD)/lib/libvista_engine.so) $(BUILD)/lib/libvista.so
BINDINGS := $(if $(ENGINE_SOURCES),build/python/vista_engine_abi.py) build/python/vista_abi.py

DEMO_PAIRS := build/demo/oak-d
DEMO_FLIGHT := build/demo/flight

.PHONY: help setup native build generate test test-python test-asan drift docs bench lint lint-python demo flights lock clean distclean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

include rtl/rtl.mk
include model/systemc/systemc.mk

# ---- set-up ----

setup: .venv/run.stamp ## pinned Python packages into .venv, `vista` on .venv/bin

.venv/run.stamp: $(REQUIREMENTS)/run.txt pyproject.toml $(SETUP)
	@$(SETUP) run

.venv/test.stamp: $(REQUIREMENTS)/test.txt .venv/run.stamp
	@$(SETUP) test

.venv/bench.stamp: $(REQUIREMENTS)/bench.txt .venv/test.stamp
	@$(SETUP) bench

.venv/docs.stamp: $(REQUIREMENTS)/docs.txt .venv/run.stamp
	@$(SETUP) docs

lock: ## pin the packages of scripts/requirements/*.in anew, with hashes
	@scripts/lock.sh

# ---- build ----

build: native $(BINDINGS) ## native libraries, C programs and their Python bindings

native: $(LIBRARIES) $(APPS) ## native libraries and C programs only

$(BUILD)/obj/model/%.o: model/%.c
	@echo "cc $<"; mkdir -p $(@D)
	@$(CC) $(CFLAGS) $(SANITIZE) -pthread -Imodel/c/include -MMD -MP -c $< -o $@

$(BUILD)/obj/sw/%.o: sw/%.c
	@echo "cc $<"; mkdir -p $(@D)
	@$(CC) $(CFLAGS) $(SANITIZE) -pthread -Isw/include -Isw/src -Imodel/c/include -MMD -MP -c $< -o $@

# A library does not outlive a source that was removed: the list of its objects is a prerequisite too.
$(BUILD)/obj/%.list: FORCE
	@mkdir -p $(@D); echo '$($*_OBJECTS)' | cmp -s - $@ || echo '$($*_OBJECTS)' > $@

$(BUILD)/lib/libvista_engine.so: $(ENGINE_OBJECTS) $(BUILD)/obj/ENGINE.list
	@echo "ld $@"; mkdir -p $(@D)
	@$(CC) $(SANITIZE) -shared -pthread -Wl,-z,defs $(ENGINE_OBJECTS) -o $@

$(BUILD)/lib/libvista.so: $(VISTA_OBJECTS) $(BUILD)/obj/VISTA.list
	@echo "ld $@"; mkdir -p $(@D)
	@$(CC) $(SANITIZE) -shared -Wl,-z,defs $(VISTA_OBJECTS) -lm -o $@

$(BUILD)/bin/%: $(BUILD)/obj/sw/apps/%.o $(LIBRARIES)
	@echo "ld $@"; mkdir -p $(@D)
	@$(CC) $(SANITIZE) -pthread $< $(LIBRARIES) -lm -Wl,-rpath,'$$ORIGIN/../lib' -o $@

build/python/vista_engine_abi.py: $(ENGINE_HEADERS)
build/python/vista_abi.py: $(VISTA_HEADERS)
build/python/%_abi.py: scripts/make_binding.py | .venv/run.stamp
	@mkdir -p $(@D); $(PYTHON) scripts/make_binding.py $(@:build/python/%.py=%) $(filter %.h,$^) --out $@

.SECONDARY: # keep the objects of the programs
.PHONY: FORCE
-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)

generate: .venv/run.stamp ## write generated sources and tables anew, after a change of sw/parameters.toml or of measured figures
	@$(PYTHON) scripts/make_parameters.py sw/parameters.toml sw/include/vista/parameters.h sw/src/parameters.c
	@$(PYTHON) scripts/make_tables.py

# ---- checks ----

# The two runs of the tests share nothing but sources and take a core each.
test: lint drift build systemc-tests .venv/test.stamp $(RTL_TOOLS) ## everything that has to pass: lint, tests, sanitizers
	@echo "beside the tests: the same under sanitizers, $(BUILD)/test-asan.log"; \
	scripts/test_sanitized.sh >$(BUILD)/test-asan.log 2>&1 & sanitized=$$!; \
	status=0; $(PYTHON) -m pytest || status=$$?; \
	wait $$sanitized || { status=$$?; cat $(BUILD)/test-asan.log; }; \
	tail -n 1 $(BUILD)/test-asan.log; exit $$status

test-python: build systemc-tests .venv/test.stamp $(RTL_TOOLS)
	@$(PYTHON) -m pytest

drift: .venv/run.stamp ## check that generated sources and tables equal what their generators write
	@$(PYTHON) scripts/make_parameters.py sw/parameters.toml sw/include/vista/parameters.h sw/src/parameters.c --check
	@$(PYTHON) scripts/make_tables.py --check

lint: lint-python lint-rtl ## ruff, Verilator -Wall, Verible

lint-python: .venv/test.stamp
	@.venv/bin/ruff check --quiet .

test-asan: build .venv/test.stamp ## the tests of the C code again, under ASan and UBSan
	@scripts/test_sanitized.sh

docs: build .venv/docs.stamp ## build the documentation site into build/doc/html; warnings are errors
	@.venv/bin/sphinx-build --quiet --fail-on-warning --keep-going -b html -d build/doc/cache doc build/doc/html
	@echo "documentation: $(CURDIR)/build/doc/html/index.html"

bench: build .venv/bench.stamp ## timings on this machine: tables, and build/bench.json
	@$(PYTHON) scripts/run_benches.py model/bench sw/bench --out build/bench.json

# ---- demo ----

demo: build ## the whole chain on real pairs and on a rendered flight, with reports
	@$(PYTHON) scripts/fetch_demo.py $(DEMO_PAIRS)
	@.venv/bin/vista run $(DEMO_PAIRS) --out build/demo/oak-d-out
	@$(PYTHON) -m vista_eval.worlds.demo $(DEMO_FLIGHT)
	@.venv/bin/vista run $(DEMO_FLIGHT) --out build/demo/flight-out
	@printf '%s\n' 'Reports, to be opened in a browser:' \
	  "  real pairs       $(CURDIR)/build/demo/oak-d-out/report.html" \
	  "  rendered flight  $(CURDIR)/build/demo/flight-out/report.html"

QUALITY ?= quick

flights: build ## render, fly and score the flights, draw the paper's figures (QUALITY=full: overnight)
	@.venv/bin/vista flights build/flights --quality $(QUALITY) --pose-noise
	@.venv/bin/vista figures build/figures --flights build/flights

# ---- tidy ----

clean: ## remove what was built, keep .venv
	rm -rf build

distclean: clean ## remove everything generated
	rm -rf .venv *.egg-info

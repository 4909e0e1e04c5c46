# Targets of the SystemC model, for the top Makefile.

SYSTEMC := build/tools/systemc
SYSTEMC_STAMP := $(SYSTEMC)/ldflags
SYSTEMC_CXXFLAGS := -O3 -std=c++17 -Wall -Wextra -Werror
SYSTEMC_SOURCES := $(wildcard model/systemc/src/*.cpp)
SYSTEMC_OBJECTS := $(SYSTEMC_SOURCES:%.cpp=build/obj/%.o)
SYSTEMC_APPS := $(patsubst model/systemc/apps/%.cpp,build/bin/%,$(wildcard model/systemc/apps/*.cpp))

.PHONY: systemc

systemc: $(SYSTEMC_APPS) ## the model of the whole system in time: build/bin/vista_system

$(SYSTEMC_STAMP): scripts/setup_systemc.sh scripts/requirements/systemc.txt
	@scripts/setup_systemc.sh

build/obj/model/systemc/%.o: model/systemc/%.cpp $(SYSTEMC_STAMP)
	@echo "c++ $<"; mkdir -p $(@D)
	@g++ $(SYSTEMC_CXXFLAGS) $$(cat $(SYSTEMC)/cflags) -Imodel/systemc/src -Imodel/c/include -MMD -MP -c $< -o $@

build/bin/vista_%: build/obj/model/systemc/apps/vista_%.o $(SYSTEMC_OBJECTS) build/lib/libvista_engine.so
	@echo "ld $@"; mkdir -p $(@D)
	@g++ $^ $$(cat $(SYSTEMC)/ldflags) -lsystemc -pthread -Wl,-rpath,'$$ORIGIN/../lib' -o $@

# SPDX-License-Identifier: Apache-2.0
# spantex: every entry point. `make help` lists the targets.
MAKEFLAGS += --no-builtin-rules
.DEFAULT_GOAL := all
B        ?= build
CXX      ?= g++
ifeq ($(origin CXX),default)
CXX      := g++
endif
OPT      ?= -O2
EVALUATIONS ?= 1000000000
WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
STD      := -std=c++20
INCLUDES := -I. -Ifirmware
# Libraries that are not ours come in as system headers: no warnings of theirs.
SYSTEM   := -isystem /usr/include/stb
CXXFLAGS ?=
# gcc for x86 clears and copies what is some hundred bytes by instructions that take longer to begin than they save (docs/TRIED.md): the C library's functions instead.
STRINGS  := $(if $(shell echo 1 | $(CXX) -mstringop-strategy=libcall -E - 2>/dev/null),-mstringop-strategy=libcall)
FLAGS     = $(STD) $(OPT) $(STRINGS) $(WARN) $(INCLUDES) $(SYSTEM) $(CXXFLAGS) -MMD -MP -pthread
JOBS     ?= $(shell nproc)

# The bench's GPIO lines need libgpiod, 1.6 or 2; without it the command says so. Version 2 is tested everywhere, against its interface in tests/gpiod2.
GPIOD_VERSION := $(shell pkg-config --modversion libgpiod 2>/dev/null | cut -d. -f1)
GPIOD_LIBS    := $(if $(GPIOD_VERSION),$(shell pkg-config --libs libgpiod))
HOST_SOURCES := $(wildcard sim/*.cpp) $(filter-out hal/gpiod_lines$(if $(GPIOD_VERSION),_absent).cpp,$(wildcard hal/*.cpp)) $(wildcard hal/kernels/*.cpp)
TOOL_SOURCES := $(wildcard tools/spantex/*.cpp)
UNIT_SOURCES := $(filter-out $(if $(filter 1,$(GPIOD_VERSION)),,tests/unit/gpiod_lines.cpp),$(wildcard tests/unit/*.cpp))
HOST_OBJECTS := $(HOST_SOURCES:%.cpp=$(B)/%.o)
TOOL_OBJECTS := $(TOOL_SOURCES:%.cpp=$(B)/%.o)
UNIT_TESTS   := $(UNIT_SOURCES:tests/unit/%.cpp=$(B)/tests/%)

# Peers of `spantex bench`: a shared object each, where its library is installed. Debian's smaller OpenCV packages bring no .pc file.
peer_flags    = $(subst -I,-isystem ,$(shell pkg-config --cflags --libs $(1) 2>/dev/null))
PEER_pixman  := $(call peer_flags,pixman-1)
PEER_mesa    := $(call peer_flags,osmesa)
PEER_opencv  := $(or $(call peer_flags,opencv4),$(if $(wildcard /usr/include/opencv4/opencv2/imgproc.hpp),-isystem /usr/include/opencv4 -lopencv_imgproc -lopencv_core))
PEERS        := $(foreach p,pixman opencv mesa,$(if $(strip $(PEER_$(p))),$(B)/peers/$(p).so))

.PHONY: all demo demo-m4 demo-drawing compare bench bench-levels sweep report check-report install uninstall amalgamation arduino test targets sizes stress stress-bench test-gpio fuzz sanitize check-gates count-arm64 unit-tests clean help setup-build setup-install setup-test setup-demo setup-compare setup-devices setup-report setup-browser setup-levels setup-arm64

# Where `make install` puts the command, headers, the CMake package, spantex.pc and the man page; DESTDIR comes before all of them, as packagers expect.
PREFIX   ?= /usr/local
DESTDIR  ?=

all: setup-build ## build the command: build/spantex
	@$(MAKE) --no-print-directory -j$(JOBS) $(B)/spantex

demo: setup-build setup-demo all ## render the demo pictures into build/demo and print one table
	@$(B)/spantex demo --out $(B)/demo

compare: setup-build setup-compare all ## docs/METHODS-COMPARED.md made anew, with pictures: build/compare/index.html, tables, plot
	@tools/compare_methods --build $(B) --out $(B)/compare

BENCH ?= --repeat 9
bench: setup-build setup-bench setup-demo setup-compare ## time against error, ours and installed peers, and how cost grows: build/bench/{table.txt,bench.json,pareto.png,growth.png}
	@$(MAKE) --no-print-directory -j$(JOBS) $(B)/spantex peers
	@mkdir -p $(B)/bench
	@$(B)/spantex bench --growth $(BENCH) --json $(B)/bench/bench.json > $(B)/bench/table.txt; code=$$?; cat $(B)/bench/table.txt; exit $$code
	@tools/plot_bench $(B)/bench/bench.json --out $(B)/bench

# Debian's packages of OpenArena: data for this target alone, which no test installs.
LEVELS       ?= oa_dm3 oa_rpg3dm2 czest1dm
LEVEL_FRAMES ?= 120
LEVEL_VIEW   ?= --size 640x480 --fov 60 --repeat 5
LEVEL_MAPS   ?= /usr/share/games/openarena/baseoa/pak1-maps.pk3
bench-levels: setup-build setup-bench setup-levels all peers ## walks through OpenArena's levels: time a frame against pixels, overdraw, polygons, and installed peers: build/levels/{table.txt,levels.json,levels.png,peers}, a folder of pictures a level
	@rm -rf $(B)/levels/stats $(B)/levels/peers
	@mkdir -p $(B)/levels/stats $(LEVELS:%=$(B)/levels/%)
	@for l in $(LEVELS); do $(B)/spantex render $(LEVEL_MAPS) --map $$l $(LEVEL_VIEW) --frames $(LEVEL_FRAMES) --out $(B)/levels/$$l/%04d.png --stats $(B)/levels/stats/$$l.json || exit 1; done
	@tools/plot_levels $(B)/levels/stats/*.json --out $(B)/levels > $(B)/levels/table.txt
	@mkdir -p $(B)/levels/peers
	@for l in $(LEVELS); do $(B)/spantex bench --model $(LEVEL_MAPS) --map $$l $(LEVEL_VIEW) --filters nearest,bilinear,trilinear,aniso --kernels avx512,avx2,sse41,neon,words --json $(B)/levels/peers/$$l.json || exit 1; done >> $(B)/levels/table.txt
	@cat $(B)/levels/table.txt

sweep: setup-build all ## the standard study of precision against quality (tools/sweeps/standard.json), minutes; an ended one goes on: build/sweeps/standard.csv
	@mkdir -p $(B)/sweeps
	@$(B)/spantex sweep tools/sweeps/standard.json --threads $(JOBS) --out $(B)/sweeps/standard.csv

report: sweep setup-report ## plots and tables of the standard study: build/report/index.html
	@tools/report --record $(B)/sweeps/standard.csv --build $(B) --out $(B)/report

check-report: report setup-browser ## the report in headless Chromium, light and dark: build/report/light.png, dark.png
	@tools/check_report --report $(B)/report/index.html --out $(B)/report

install: setup-build setup-install all ## install the command, headers, CMake package, spantex.pc and man page into PREFIX (/usr/local), below DESTDIR
	@cmake -S . -B $(B)/install -DCMAKE_INSTALL_PREFIX="$(abspath $(PREFIX))" -DSPANTEX_COMMAND="$(abspath $(B)/spantex)" >/dev/null
	@cmake --build $(B)/install >/dev/null
	@DESTDIR="$(DESTDIR)" cmake --install $(B)/install >/dev/null
	@echo "installed: $(DESTDIR)$(abspath $(PREFIX))"

uninstall: ## remove what the last `make install` put there
	@test -f $(B)/install/install_manifest.txt || { echo "nothing was installed from $(B)" >&2; exit 2; }
	@sed "s|^|$(DESTDIR)|" $(B)/install/install_manifest.txt | tr '\n' '\0' | xargs -0 rm -f
	@cd "$(DESTDIR)$(abspath $(PREFIX))" && find include/spantex share/doc/spantex lib/cmake/spantex -depth -type d -empty -delete 2>/dev/null || true

amalgamation: ## the device library in one header: build/amalgamation/spantex.hpp
	@tools/amalgamate --out $(B)/amalgamation

arduino: ## the device library as an Arduino library, to be zipped or published as it is: build/arduino/spantex
	@rm -rf $(B)/arduino/spantex
	@tools/amalgamate --arduino --out $(B)/arduino/spantex

test: setup-build setup-test setup-demo ## run every test; T=suite.case runs one
	@$(MAKE) --no-print-directory -j$(JOBS) $(if $(T),$(or $(TESTS_OF_T),$(B)/spantex peers),$(B)/spantex peers unit-tests)
	@CXX="$(CXX)" python3 tests/run.py --build $(B) $(if $(T),--only '$(T)')

TESTS_OF_T = $(filter $(B)/tests/$(subst *,%,$(firstword $(subst ., ,$(T)))),$(UNIT_TESTS))
unit-tests: $(UNIT_TESTS)

targets: setup-devices ## every core under emulation: the host's pictures bit for bit, instructions a pixel against the baseline, code sizes
	@tools/count_instructions --build $(B)
	@tools/size_report --build $(B)
	@tools/device_pictures --build $(B)
	@tools/device_drawing --build $(B)
	@tools/device_loading --build $(B)

sizes: setup-devices ## code, state and stack of the device library on Cortex-M0+ against their limits; forbidden symbols
	@tools/size_report --build $(B)

demo-m4: setup-devices setup-build ## a picture drawn by an emulated Cortex-M4: build/demo-m4.png
	@tools/demo_m4 --build $(B)

stress: setup-build all ## every stage of the numerics against exact arithmetic, 10^9 evaluations a profile; tables in build/stress
	@mkdir -p $(B)/stress
	@for p in exact default compact seed; do \
	  $(B)/spantex stress --profile $$p --evaluations $(EVALUATIONS) --threads $(JOBS) --json $(B)/stress/$$p.json > $(B)/stress/$$p.txt; \
	  code=$$?; cat $(B)/stress/$$p.txt; test $$code = 0 || exit 1; done

stress-bench: setup-build setup-test ## every fault of the bench's wires at every call of the lines, and 10^6 random schedules of faults
	@$(MAKE) --no-print-directory -j$(JOBS) $(B)/tests/bench_faults
	@SPANTEX_LONG=1 $(B)/tests/bench_faults

GPIO_SIZE ?= 64x48
test-gpio: setup-build setup-test ## the bench on Debian's kernel with gpio-sim, under emulation: real libgpiod, a device in a second process
	@tools/setup gpio
	@$(MAKE) --no-print-directory -j$(JOBS) $(B)/spantex $(B)/gpio/device
	@tests/gpio/run.py --build $(B) --size $(GPIO_SIZE)

$(B)/gpio/device: tests/gpio/device.cpp
	@mkdir -p $(@D)
	@$(CXX) $(FLAGS) -static $< -o $@

# Parsers of the bench's frames, and a device with its engine, under libFuzzer: the committed corpus, then FUZZ_RUNS inputs each from FUZZ_SEED on.
FUZZ_RUNS ?= 10000000
FUZZ_SEED ?= 1
# Comparisons are not traced: no checksum is guessed by them, and runs take half the time.
FUZZ      := -O2 -g -DSPANTEX_CHECK_TRUST -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -fno-sanitize-coverage=trace-cmp,indirect-calls
FUZZED    := bench_request bench_answer bench_coefficients
fuzz: setup-build setup-test ## fuzz both frame parsers of the bench and the device's checks of coefficients, FUZZ_RUNS inputs each
	@mkdir -p $(B)/fuzz/found
	@for t in $(FUZZED); do \
	  clang++ $(STD) $(FUZZ) $(WARN) $(INCLUDES) tests/fuzz/$$t.cpp hal/bench_engine.cpp hal/bench_link.cpp -o $(B)/fuzz/$$t || exit 1; \
	  mkdir -p $(B)/fuzz/found/$$t; \
	  $(B)/fuzz/$$t -runs=$(FUZZ_RUNS) -seed=$(FUZZ_SEED) -entropic=0 -max_len=400 -timeout=120 -verbosity=0 -print_final_stats=1 -artifact_prefix=$(B)/fuzz/ $(B)/fuzz/found/$$t tests/fuzz/corpus/$$t || exit 1; done

SANITIZE := -gline-tables-only -fsanitize=address,undefined,unsigned-integer-overflow -fno-sanitize-recover=all \
            -fsanitize-ignorelist=tests/sanitize.ignore -DSPANTEX_CHECK_TRUST
SUITES ?= $(UNIT_SOURCES:tests/unit/%.cpp=%)
sanitize: setup-build setup-test ## unit tests (SUITES), command, stress and identity pictures under clang's address, undefined-behaviour and unsigned-overflow sanitizers
	@$(MAKE) --no-print-directory -j$(JOBS) B=$(B)/sanitize CXX=clang++ OPT=-O1 KERNEL_OPT= CXXFLAGS="$(SANITIZE)" $(SUITES:%=$(B)/sanitize/tests/%) $(B)/sanitize/spantex $(B)/sanitize/picture_hashes
	@tests/sanitized.py --build $(B)/sanitize --suites $(SUITES)

check-gates: setup-build setup-test ## break the code on purpose, one line at a time: a named test must notice each
	@$(MAKE) --no-print-directory -j$(JOBS) unit-tests $(B)/build.txt
	@SPANTEX_BUILD=$(B) tests/gates.py

count-arm64: setup-build setup-arm64 ## instructions a pixel on arm64 under emulation, ours, pixman's, OpenCV's and llvmpipe's (Debian's, 70 MB): build/arm64/table.md
	@$(MAKE) --no-print-directory -j$(JOBS) $(B)/arm64/judge_pictures
	@tools/count_arm64 --build $(B) --jobs $(JOBS)

demo-drawing: setup-build ## what a program in C draws through spantex.h: build/demo-drawing.png
	@tools/demo_drawing --build $(B)

clean: ## remove everything built
	@rm -rf $(B)

help: ## list the targets
	@sed -n 's/^\([a-z][a-z0-9-]*\):.*## \(.*\)/  make \1\t\2/p' $(MAKEFILE_LIST) | expand -t 24

setup-build: ; @tools/setup build
setup-install: ; @tools/setup install
setup-test: ; @tools/setup test cross emulate devices packages bench
setup-demo: ; @tools/setup demo
setup-devices: ; @tools/setup devices
setup-compare: ; @tools/setup compare
setup-bench: ; @tools/setup bench
setup-arm64: ; @tools/setup build emulate
setup-levels: ; @tools/setup levels

setup-report: ; @tools/setup report
setup-browser: ; @tools/setup browser

.PHONY: peers force setup-bench
peers: $(PEERS)

$(B)/peers/%.so: tools/peers/%.cpp tools/peers/peer.hpp Makefile
	@mkdir -p $(@D)
	@echo "  peer    $@"
	@$(CXX) $(STD) -O2 $(WARN) -fPIC -shared $< -o $@ $(PEER_$*)

$(B)/spantex: $(TOOL_OBJECTS) $(HOST_OBJECTS)
	@echo "  link    $@"
	@$(CXX) $(FLAGS) $^ -o $@ -lassimp -lzip -ldeflate -lpng -ldl $(GPIOD_LIBS)

$(B)/arm64/judge_pictures: $(B)/tools/arm64/judge_pictures.o $(HOST_OBJECTS)
	@mkdir -p $(@D)
	@echo "  link    $@"
	@$(CXX) $(FLAGS) $^ -o $@ -lassimp -lzip -ldeflate -lpng $(GPIOD_LIBS)

$(B)/picture_hashes: $(B)/tests/identity/picture_hashes.o
	@mkdir -p $(@D)
	@echo "  link    $@"
	@$(CXX) $(FLAGS) $^ -o $@

$(B)/%.o: %.cpp Makefile
	@mkdir -p $(@D)
	@echo "  compile $<"
	@$(CXX) $(FLAGS) -c $< -o $@

# Kernels are unrolled by the compiler, and their functions begin at lines of the caches (docs/TRIED.md); gcc's own intrinsics warn of the undefined lanes they
# mean, and of vectors passed between functions that melt into one.
KERNEL_OPT ?= -O3
$(B)/hal/kernels/%.o: FLAGS += $(KERNEL_OPT) -falign-functions=64 -Wno-unknown-warning-option -Wno-uninitialized -Wno-maybe-uninitialized -Wno-psabi

# PNG's filters by vectors.
$(B)/sim/image.o: FLAGS += $(KERNEL_OPT)

$(B)/tests/%: $(B)/tests/unit/%.o $(HOST_OBJECTS)
	@mkdir -p $(@D)
	@echo "  link    $@"
	@$(CXX) $(FLAGS) $^ -o $@ -lcmocka -lassimp -lzip -ldeflate -lpng $(GPIOD_LIBS) $(LIBRARIES) -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

$(B)/tests/bc: LIBRARIES := -lsquish
$(B)/tests/c_interface: $(B)/firmware/spantex/spantex_c.o
# What `spantex bench` says it is, and what the objects are made by; written anew only when that changes.
COMMIT := $(shell git describe --always --dirty 2>/dev/null || echo unknown)
MADE_BY := $(strip $(STD) $(OPT) $(STRINGS) $(CXXFLAGS)), kernels $(KERNEL_OPT), $(shell $(CXX) --version | head -n 1)
$(B)/build.txt: force
	@mkdir -p $(@D)
	@printf '%s\n' '$(COMMIT)' '$(MADE_BY)' | cmp -s - $@ || printf '%s\n' '$(COMMIT)' '$(MADE_BY)' > $@
$(B)/tools/spantex/bench_machine.o: $(B)/build.txt
$(B)/tools/spantex/bench_machine.o: FLAGS += -DSPANTEX_COMMIT='"$(COMMIT)"' -DSPANTEX_FLAGS='"$(strip $(STD) $(OPT) $(STRINGS) $(CXXFLAGS))"'
$(B)/hal/gpiod_lines.o: FLAGS += -DSPANTEX_GPIOD_VERSION=$(GPIOD_VERSION)
GPIOD_MOCKS := chip_open_lookup chip_close chip_get_line chip_find_line line_is_used line_consumer line_request_bulk line_release_bulk \
               line_set_direction_input_bulk line_set_direction_output_bulk line_set_value_bulk line_get_value_bulk line_event_wait_bulk line_event_read
$(B)/tests/gpiod_lines: LIBRARIES := $(GPIOD_MOCKS:%=-Wl,--wrap=gpiod_%)

$(B)/gpiod2/gpiod_lines.o: hal/gpiod_lines.cpp tests/gpiod2/gpiod.h
	@mkdir -p $(@D)
	@echo "  compile $< for libgpiod 2"
	@$(CXX) -Itests/gpiod2 $(FLAGS) -DSPANTEX_GPIOD_VERSION=2 -c $< -o $@
$(B)/tests/unit/gpiod2_lines.o: FLAGS := -Itests/gpiod2 $(FLAGS)
$(B)/tests/gpiod2_lines: $(B)/tests/unit/gpiod2_lines.o $(B)/gpiod2/gpiod_lines.o $(filter-out $(B)/hal/gpiod_lines%.o,$(HOST_OBJECTS))
	@mkdir -p $(@D)
	@echo "  link    $@"
	@$(CXX) $(FLAGS) $^ -o $@ -lcmocka -lassimp -lzip -ldeflate -lpng -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc

.PRECIOUS: $(B)/tests/unit/%.o
-include $(HOST_OBJECTS:.o=.d) $(B)/firmware/spantex/spantex_c.d $(TOOL_OBJECTS:.o=.d) $(UNIT_SOURCES:%.cpp=$(B)/%.d) $(B)/tests/identity/picture_hashes.d $(B)/gpio/device.d $(B)/tools/arm64/judge_pictures.d

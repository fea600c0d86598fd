# pms: build, test, install.  `make help` lists the goals.

# --- what you may want to set ------------------------------------------------
MODE    ?= release
PREFIX  ?= /usr/local
DESTDIR ?=
MARCH   ?= native
WERROR  ?=
CC      ?= cc
CXX     ?= c++
# -----------------------------------------------------------------------------

VERSION := 0.1.0
B       := build/$(MODE)
Q       := $(if $(V),,@)

PACKAGES := build-essential pkg-config libembree-dev libopenexr-dev libopencolorio-dev \
            libpng-dev libjpeg-dev libtiff-dev libgif-dev libfreetype-dev libcmocka-dev libnanoflann-dev povray povray-includes \
            povray-examples mandoc gnuplot-nox
FLOORS   := $(shell sed 's/:.*//' src/FLOORS)
CSRC     := $(foreach f,$(FLOORS),$(wildcard src/$(f)/*.c))
CXXSRC   := $(wildcard src/image/*.cpp)
LIBSRC   := $(filter-out src/cli/main.c,$(CSRC))
LIBOBJ   := $(LIBSRC:%.c=$(B)/%.o) $(CXXSRC:%.cpp=$(B)/%.o)
QUICK    := csg_showpiece macros_loops mesh_vase
UNIT     := $(patsubst %.c,$(B)/%,$(wildcard tests/unit/*_test.c tests/physics/*_test.c \
            tests/hard/*_test.c tests/fault/*_test.c))
HARD     := $(filter $(B)/tests/hard/%,$(UNIT))
PHYSICS  := $(filter $(B)/tests/physics/%,$(UNIT))
BENCH    := $(patsubst %.cpp,$(B)/%,$(wildcard tests/bench/*_bench.cpp)) \
            $(patsubst %.c,$(B)/%,$(wildcard tests/bench/*_bench.c))
SHTESTS   = $(wildcard tests/house/*.t tests/cli/*.t tests/image/*.t)

PKGS     := OpenEXR OpenColorIO libpng libjpeg libtiff-4 freetype2
PKGCF    := $(shell pkg-config --cflags $(PKGS) 2>/dev/null | sed 's/-I/-isystem /g')
PKGLIB   := $(shell pkg-config --libs $(PKGS) 2>/dev/null) -lembree3 -lgif

WARN     := -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wvla $(if $(WERROR),-Werror)
CWARN    := -Wstrict-prototypes -Wmissing-prototypes
OPT_release := -O3 -g -march=$(MARCH)
OPT_debug   := -O0 -g
OPT_asan    := -O1 -g -fno-omit-frame-pointer -fsanitize=address,undefined -fno-sanitize-recover=undefined -DARENA_PARANOID
OPT_tsan    := -O1 -g -fsanitize=thread
OPT_cover   := -O0 -g --coverage
OPT      := $(OPT_$(MODE))
BASEFLAGS := -Isrc $(PKGCF) -DPMS_VERSION='"$(VERSION)"' -DPMS_DATA_DIR='"$(PREFIX)/share/pms"' \
            -ffp-contract=off -fno-math-errno -fno-trapping-math -pthread $(OPT)
ALLCFLAGS := -std=c17 -D_POSIX_C_SOURCE=200809L -D_XOPEN_SOURCE=700 $(BASEFLAGS) $(WARN) $(CWARN) $(CFLAGS)
ALLCXXFLAGS := -std=c++17 $(BASEFLAGS) $(WARN) $(CXXFLAGS)
LIBS     := $(PKGLIB) -lm -lstdc++ -lpthread

.PHONY: all help deps demo check check-all check-kill check-study parity parity-shapes bench bench-accuracy bench-shapes fuzz gallery floors headers install uninstall clean
.DEFAULT_GOAL := all
.SECONDARY:

all: $(B)/pms ## build the program (build/$(MODE)/pms)

help: ## list the goals
	@grep -hE '^[a-z-]+:.*##' Makefile | sed -E 's/:.*## /\t/' | expand -t 14

deps: ## install the libraries the build needs (Debian), or name them
	$(Q)tests/house/deps.sh $(PACKAGES)

# Goals that set up a fresh machine build in a second make, so that pkg-config is
# asked only after the packages are there.
demo: deps ## build and render the show scene to out/
	$(Q)$(MAKE) --no-print-directory $(B)/pms
	$(Q)mkdir -p out
	$(Q)$(B)/pms scenes/caustic_glass.pms -o out/caustic_glass.exr -o out/caustic_glass.png
	@echo "  wrote   out/caustic_glass.png and out/caustic_glass.exr"

check: deps ## build and run the tests (a few minutes)
	$(Q)$(MAKE) --no-print-directory check-built

.PHONY: check-built unit
check-built: $(B)/pms $(UNIT) headers
	$(Q)CMOCKA_MESSAGE_OUTPUT=TAP PMS=$(B)/pms MODE=$(MODE) prove -j2 --merge $(UNIT) $(SHTESTS)

unit: $(UNIT)
	$(Q)CMOCKA_MESSAGE_OUTPUT=TAP prove -j2 --merge $(UNIT)

check-all: deps ## the tests under sanitizers, and the long ones
	$(Q)$(MAKE) --no-print-directory check
	$(Q)$(MAKE) --no-print-directory check MODE=asan
	$(Q)$(MAKE) --no-print-directory check-kill

check-kill: deps ## kill progressive renders 20 times at random moments, and resume them
	$(Q)$(MAKE) --no-print-directory $(B)/pms
	$(Q)KILLS=20 PMS=$(B)/pms prove -v tests/cli/kill.t

check-study: deps ## show the page of a study in a browser (installs chromium); out/study.png
	$(Q)tests/house/deps.sh $(PACKAGES) chromium
	$(Q)$(MAKE) --no-print-directory $(B)/pms
	$(Q)mkdir -p out
	$(Q)SHOT=out/study.png PMS=$(B)/pms prove -v tests/cli/study_page.t

check-physics: deps ## print what the tests of light measure, what is expected, and the error
	$(Q)$(MAKE) --no-print-directory check-physics-built
.PHONY: check-physics check-physics-built
check-physics-built: $(PHYSICS)
	$(Q)tests/physics/table.sh $(PHYSICS)

check-hard: deps ## run the hard cases, with povray beside, into tests/hard/README.md (a quarter of an hour)
	$(Q)$(MAKE) --no-print-directory check-hard-built
.PHONY: check-hard check-hard-built
check-hard-built: $(HARD)
	$(Q)tests/hard/table.sh $(HARD)

parity: deps ## compare pictures and times with the installed povray
	$(Q)$(MAKE) --no-print-directory $(B)/pms
	$(Q)PMS=$(B)/pms tests/parity/run.sh

parity-shapes: deps ## compare the pictures of povray's own examples of shapes
	$(Q)$(MAKE) --no-print-directory $(B)/pms
	$(Q)PMS=$(B)/pms tests/parity/examples.sh

bench: deps ## ratios against nanoflann, Embree and povray, measured in one run
	$(Q)$(MAKE) --no-print-directory bench-built
.PHONY: bench-built
bench-built: $(B)/pms $(BENCH)
	$(Q)PMS=$(B)/pms BUILD=$(B) tests/bench/run.sh

bench-shapes: deps ## time every shape, and big scenes, against povray (ten minutes)
	$(Q)$(MAKE) --no-print-directory $(B)/pms $(B)/tests/bench/roots_bench
	$(Q)$(B)/tests/bench/roots_bench
	$(Q)PMS=$(B)/pms tests/bench/shapes.pl

bench-accuracy: deps ## estimated errors against true ones, for every scene (two hours)
	$(Q)$(MAKE) --no-print-directory $(B)/tests/bench/accuracy_bench
	$(Q)mkdir -p $(B)/truth
	$(Q)$(B)/tests/bench/accuracy_bench -k $(B)/truth scenes/*.pms
	$(Q)$(B)/tests/bench/accuracy_bench -k $(B)/truth -r 100 -w 80 -e 2 -n 10 $(QUICK:%=scenes/%.pms)

fuzz: deps ## fuzz the scene reader for a minute (needs clang with libFuzzer)
	$(Q)tests/fuzz/run.sh

gallery: all ## render the pictures of the README
	$(Q)PMS=$(B)/pms tests/house/gallery.sh

floors: ## check that folders include only what src/FLOORS allows
	$(Q)tests/house/floors.t

HEADERS := $(wildcard src/*/*.h)
headers: $(HEADERS:%.h=$(B)/%.h.ok) ## check that every header compiles alone
$(B)/%.h.ok: %.h
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(ALLCFLAGS) -Wno-unused-macros -fsyntax-only -x c $< && touch $@

$(B)/pms: $(B)/src/cli/main.o $(B)/libpms.a
	@echo "  link    $@"
	$(Q)$(CC) $(OPT) -pthread $(LDFLAGS) -o $@ $^ $(LIBS)

$(B)/libpms.a: $(LIBOBJ)
	@echo "  archive $@"
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(B)/%.o: %.c
	@echo "  cc      $<"
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(ALLCFLAGS) -MMD -MP -c -o $@ $<

# OpenColorIO's configuration is compiled in, as a string literal.
$(B)/src/image/ocio.o: $(B)/gen/pms_ocio.inc
$(B)/src/image/ocio.o: ALLCXXFLAGS += -I$(B)/gen
$(B)/gen/pms_ocio.inc: stdlib/pms.ocio
	$(Q)mkdir -p $(@D)
	$(Q)(printf 'R"ocio('; cat $<; printf ')ocio"\n') > $@

$(B)/%.o: %.cpp
	@echo "  c++     $<"
	$(Q)mkdir -p $(@D)
	$(Q)$(CXX) $(ALLCXXFLAGS) -MMD -MP -c -o $@ $<

# The photon bench listens in on the rays of the pass.
$(B)/tests/bench/photon_bench: private OPT += -Wl,--wrap=trace_closest

$(B)/tests/bench/%_bench: $(B)/tests/bench/%_bench.o $(B)/libpms.a
	@echo "  link    $@"
	$(Q)$(CXX) $(OPT) -pthread $(LDFLAGS) -o $@ $^ $(LIBS)

$(B)/tests/%_test: $(B)/tests/%_test.o $(B)/libpms.a
	@echo "  link    $@"
	$(Q)$(CC) $(OPT) -pthread $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBS) -lcmocka

# The geometry a second time, in quad precision: one object, of which only its table of functions is
# seen from outside (tests/hard/quad_world.h).
QUADBOTH := $(addprefix tests/hard/,quad_world.c quad_shapes.c quad_solids.c quad_facets.c quad_csg.c)
QUADSRC  := $(wildcard src/math/*.c src/accel/*.c src/shape/*.c) $(QUADBOTH)
QUADOBJ  := $(QUADSRC:%.c=$(B)/quad/%.o)
QUADFLAGS = -std=c17 -D_POSIX_C_SOURCE=200809L -Isrc -include tests/hard/quad_real.h -O2 -g -pthread \
            -ffp-contract=off -fno-math-errno -fno-trapping-math \
            -Wall -Wextra -Wconversion -Wno-psabi $(if $(WERROR),-Werror)

$(B)/quad/%.o: %.c
	@echo "  quad    $<"
	$(Q)mkdir -p $(@D)
	$(Q)$(CC) $(QUADFLAGS) -MMD -MP -c -o $@ $<

$(B)/quad_geometry.o: $(QUADOBJ)
	@echo "  link    $@"
	$(Q)$(LD) -r -o $@ $^ && objcopy --keep-global-symbol=quad_world $@

$(B)/tests/hard/quad_test: $(QUADBOTH:%.c=$(B)/%.o) $(B)/tests/hard/quad_rays.o \
            $(B)/tests/hard/quad_lists.o $(B)/quad_geometry.o

TARGET    = $(DESTDIR)$(PREFIX)
INSTALLED = $(TARGET)/bin/pms $(patsubst stdlib/%,$(TARGET)/share/pms/%,$(wildcard stdlib/*)) \
            $(patsubst man/%,$(TARGET)/share/man/man1/%,$(wildcard man/*.1)) \
            $(patsubst man/%,$(TARGET)/share/man/man5/%,$(wildcard man/*.5))

install: all ## install program, materials and man pages under $(PREFIX)
	install -D -m 755 $(B)/pms $(TARGET)/bin/pms
	install -d $(TARGET)/share/pms $(TARGET)/share/man/man1 $(TARGET)/share/man/man5
	install -m 644 $(wildcard stdlib/*) $(TARGET)/share/pms
	install -m 644 man/*.1 $(TARGET)/share/man/man1
	install -m 644 man/*.5 $(TARGET)/share/man/man5

uninstall: ## remove what install put there
	rm -f $(INSTALLED)
	@if [ -d $(TARGET)/share/pms ]; then rmdir $(TARGET)/share/pms || true; fi

clean: ## remove what was built
	rm -rf build out

-include $(shell find build -name '*.d' 2>/dev/null)

# kage: make render | bench | test | install | clean | help
#
#   REAL=float|double     the number type of the tracer (double: for verification)
#   CC=gcc|clang          the compiler
#   SANITIZE=address,undefined
#   CLONES=no             without the AVX2 copies of the stages
#   OPENMP=no             one thread a render, without OpenMP: for SANITIZE=thread, which does not see the barriers of
#                         its library (CLONES=no, too: functions that choose their copy run before it is ready)
#   BVH=brute             every ray is tested with every box, which is slow: for tests/random
#   VIEW=yes|no           kage view, the window; it needs SDL2, SDL2_ttf and fontconfig (yes where they are here)
#   BUILD=DIR             where the objects and the program go
#   PYTHON=PROGRAM        the Python for which the package is built (with cffi and numpy)
#   V=1                   print the whole commands

REAL     ?= float
SANITIZE ?=
CLONES   ?= yes
OPENMP   ?= yes
BUILD    ?= build/$(REAL)
BVH      ?= embree
BENCH    ?= normal
SPEED    ?= normal
OBJCOPY  ?= objcopy
PREFIX   ?= /usr/local
LIBDIR   ?= $(PREFIX)/lib
LIBEXEC  ?= $(PREFIX)/libexec/kage
SHARE    ?= $(PREFIX)/share
PYTHON   ?= scripts/venv python
Q         = $(if $(V),,@)
comma    := ,
# As many jobs as processors, unless make was told how many.
JOBS      = $(if $(findstring jobserver,$(MAKEFLAGS)),,-j$(shell nproc 2>/dev/null || echo 1))

# OpenEXR 3.2 brought libdeflate along; an older one is given it by us.
DEFLATE  := $(shell pkg-config --exists 'OpenEXR >= 3.2' || echo libdeflate)
PKGS      = libpng libfyaml OpenEXR $(DEFLATE)
WARNINGS  = -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wdouble-promotion -Wmissing-prototypes \
            -Wstrict-prototypes -Wwrite-strings -Wundef
# No -ffast-math: these three keep sums as written (the same bytes on every processor), while loops vectorise.
OPTIMISE ?= -O3 -fno-math-errno -fno-trapping-math -ffp-contract=off
STANDARD  = -std=c99 -D_POSIX_C_SOURCE=200809L
ifeq ($(REAL),double)
DEFINES  += -DKAGE_DOUBLE
else ifneq ($(REAL),float)
$(error REAL=$(REAL): expected float or double)
endif
ifeq ($(CLONES),no)
DEFINES  += -DKAGE_NO_CLONES
endif
ifeq ($(OPENMP),no)
THREADS   = -pthread -Wno-unknown-pragmas
else
THREADS   = -pthread -fopenmp
endif
ifneq ($(findstring thread,$(SANITIZE)),)
ifneq ($(CLONES),no)
$(error SANITIZE=thread needs CLONES=no: functions that choose their copy run before the sanitizer is ready)
endif
endif
# Names of files with spaces would be two for make.
$(foreach v,BUILD PREFIX LIBDIR LIBEXEC SHARE DESTDIR,$(if $(word 2,$($v)),\
    $(error $v=$($v): a name with spaces, expected one without)))
ifneq ($(SANITIZE),)
SANITIZER = -fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer -g
endif

# The libraries' headers as system headers: their warnings are not ours.
PKG_CFLAGS := $(patsubst -I%,-isystem %,$(shell pkg-config --cflags $(PKGS) assimp libjpeg 2>/dev/null))
# Embree 4 or 3, whichever has its headers here: it need not have a pkg-config file.
EMBREE     := $(firstword $(foreach v,4 3,$(shell printf '\043include <embree$(v)/rtcore.h>\n' | \
                  $(CC) -fsyntax-only -x c - 2>/dev/null && echo $(v))))
DEFINES    += -DKAGE_EMBREE=$(or $(EMBREE),0)
PKG_LIBS   := $(shell pkg-config --libs-only-L OpenEXR 2>/dev/null) -lOpenEXRCore \
              $(shell pkg-config --libs libpng libfyaml $(DEFLATE) 2>/dev/null)
# All objects can go into the shared library, and only what kage.h declares can be seen from outside.
VISIBILITY = -fPIC -fvisibility=hidden
override CFLAGS  += -Iinclude -Isrc $(STANDARD) $(OPTIMISE) $(VISIBILITY) $(THREADS) $(WARNINGS) $(DEFINES) \
                    $(SANITIZER) $(PKG_CFLAGS) -MMD -MP
override LDFLAGS += $(THREADS) $(SANITIZER)
LIBS       = $(PKG_LIBS) -lembree$(or $(EMBREE),3) -ldl -lm
VIEW_PKGS   = sdl2 SDL2_ttf fontconfig
ifndef VIEW
VIEW       := $(shell pkg-config --exists $(VIEW_PKGS) && echo yes || echo no)
else ifeq ($(filter yes no,$(VIEW)),)
$(error VIEW=$(VIEW): expected yes or no)
endif
VIEW_CFLAGS := $(patsubst -I%,-isystem %,$(shell pkg-config --cflags $(VIEW_PKGS) 2>/dev/null))
VIEW_LIBS   := $(shell pkg-config --libs $(VIEW_PKGS) 2>/dev/null)
IMPORT_LIBS := $(shell pkg-config --libs assimp libpng libjpeg 2>/dev/null) -lm

SOURCES   = $(patsubst src/%.c,%,$(wildcard src/*/*.c))
PROGRAM   = $(filter cli/%,$(SOURCES))
IMPORT    = $(filter import/%,$(SOURCES)) # kage-import, which alone links assimp and libjpeg
WINDOW    = $(filter view/% look/%,$(SOURCES)) # kage-view, which alone links SDL2; look/ does without
LIBRARY   = $(filter-out cli/% import/% view/% look/% $(if $(BRUTE),bvh/embree bvh/wide%),$(SOURCES)) $(BRUTE)
BRUTE     = $(if $(filter brute,$(BVH)),random/brute)
VERSION  := $(shell sed -n 's/.*define KAGE_VERSION "\(.*\)".*/\1/p' include/kage.h)
SONAME    = libkage.so.$(firstword $(subst ., ,$(VERSION)))
UNITS     = $(patsubst tests/%.c,%,$(wildcard tests/unit/*/test_*.c))

FIGURES   = figure4 figure5 figure6 figure7 figure8-none figure8 terrain-none terrain
PICTURES  = $(FIGURES:%=out/%.png)
SHOWN     = wall teapot shell
GALLERY   = $(patsubst scenes/gallery/%.yaml,%,$(wildcard scenes/gallery/*.yaml))

# What `make format` and `make lint` look at. The yardsticks in bench/limits are compiled by themselves.
C_FILES   = $(wildcard include/*.h src/*/*.[ch] examples/*.c python/*.[ch] tests/support/*.h tests/unit/*/*.[ch] \
                       tests/fuzz/*.[ch] tests/random/*.c bench/limits/*.c)
TIDY      = $(filter-out bench/limits/% $(if $(filter yes,$(VIEW)),,src/view/%),$(filter %.c,$(C_FILES)))

.PHONY: all render bench speed readme reference accept counts test unit-tests program-tests programs sanitize format
.PHONY: dist docs manuals lint tidy same python wheel install install-files uninstall clean help bootstrap FORCE
.PHONY: fuzz fuzz-program fuzz-replay verify tested-programs
all: bootstrap
	@$(MAKE) --no-print-directory $(JOBS) programs

programs: $(BUILD)/kage $(BUILD)/kage-import $(if $(filter yes,$(VIEW)),$(BUILD)/kage-view)
programs: $(BUILD)/libkage.a $(BUILD)/libkage.so

help:
	@echo 'make            build the program, $(BUILD)/kage, and the library'
	@echo 'make render     pictures of the paper, and a gallery: out/index.html'
	@echo 'make bench      measure cost and accuracy of each method, with'
	@echo '                BENCH=quick|normal|full: out/bench/index.html;'
	@echo '                SCHEDULER=tcp://HOST:PORT or local:N: all but times by Dask'
	@echo 'make speed      measure what kage demands of its speed, with'
	@echo '                SPEED=quick|normal|full: out/speed/index.html'
	@echo 'make readme     the same as bench, then the tables of README and docs'
	@echo 'make python     the Python package, to import from $(BUILD)/python'
	@echo 'make wheel      its wheel, with all libraries in it, into out/wheel'
	@echo 'make test       all tests'
	@echo 'make accept     show regression pictures that have changed, keep them if you'
	@echo '                confirm'
	@echo 'make counts     count the instructions of eight renders again, for the test'
	@echo 'make reference  render stale reference pictures with POV-Ray: reference/'
	@echo 'make sanitize   unit and some program tests under ASan, UBSan and TSan, then'
	@echo '                make fuzz'
	@echo 'make fuzz       fuzz the targets of tests/fuzz, FUZZ_SECONDS=30 each;'
	@echo '                make fuzz-replay runs its finds'
	@echo 'make verify     the checks that take hours, VERIFY="fuzz load ...", into the'
	@echo '                table of docs/reliability.md'
	@echo 'make lint       check style, likely mistakes and types; make format applies'
	@echo '                the style'
	@echo 'make same       compare all pictures with another commit: REV=COMMIT,'
	@echo '                ONLY=TEXT in their names'
	@echo 'make dist       the source archive of HEAD, out/kage-$(VERSION).tar.gz;'
	@echo '                scripts/deb makes Debian packages'
	@echo 'make docs       the documentation as pages: out/docs/index.html'
	@echo 'make manuals    the manual pages and docs/kage.md again, from their sources'
	@echo 'make install    install program, library and headers to PREFIX,'
	@echo '                $(PREFIX), under DESTDIR'
	@echo 'make uninstall  remove what install has put there'
	@echo 'make clean      remove build/ and out/'
	@echo 'Settings: REAL=float|double CC=gcc|clang CLONES=no BOOTSTRAP=no V=1'
	@echo '          SANITIZE=address,undefined'
	@echo 'scripts/bootstrap --help tells what may be installed, and how to do without.'

# What is missing is installed (scripts/bootstrap); where nothing is, this costs a quarter of a second.
bootstrap:
	@CC='$(CC)' scripts/bootstrap build

# ---- pictures ----

render: all
	@CC='$(CC)' scripts/bootstrap python
	@$(MAKE) --no-print-directory $(PICTURES) out/figures.png out/gallery.png $(GALLERY:%=out/gallery/%.png)
	@$(MAKE) --no-print-directory -j1 out/gallery/index.html out/relief.png # when nothing else runs, as they are timed
	@scripts/venv python -m scripts.start_page
	@echo 'The pictures are in out/, those of the paper side by side in out/figures.png, with the truth in out/relief.png,'
	@echo 'the gallery in out/gallery/index.html and out/gallery.png; out/index.html leads to all:'
	@ls $(PICTURES) $(PICTURES:.png=.exr) out/figures.png $(GALLERY:%=out/gallery/%.png)

# A picture is a scene and a method; its EXR is written along with it.
out/figure4.png: SCENE = cube --shadow none
out/figure5.png: SCENE = cube --shadow 0
out/figure6.png: SCENE = cube --shadow 1
out/figure7.png: SCENE = cube --shadow 2
out/figure8-none.png: SCENE = sphere --shadow none
out/figure8.png: SCENE = sphere --shadow 0
out/terrain.png: SCENE = terrain --shadow 0
out/terrain-none.png: SCENE = terrain --shadow none

$(PICTURES): $(BUILD)/kage $(wildcard scenes/*.yaml scenes/data/*)
	@mkdir -p out
	$(BUILD)/kage render scenes/$(firstword $(SCENE)).yaml $(wordlist 2,9,$(SCENE)) --aa 3 -o $@ -o $(@:.png=.exr)

out/figures.png: $(PICTURES) scripts/contact_sheet.py
	scripts/venv python scripts/contact_sheet.py -o $@ --columns 4 \
	    --title "Shadows on bump-mapped surfaces: Sumi and Noma's figures 4 to 8" \
	    out/figure4.png="Figure 4: bump mapping only" out/figure5.png="Figure 5: order 0" \
	    out/figure6.png="Figure 6: order 1" out/figure7.png="Figure 7: order 2" \
	    out/figure8-none.png="On a sphere: bump mapping only" out/figure8.png="Figure 8: on a sphere, order 0" \
	    out/terrain-none.png="Observed data: bump mapping only" \
	    out/terrain.png="Observed data: order 0"

# Bump mapping, the paper, kage and the truth, each with its time: nothing else should run meanwhile.
out/relief.png: $(BUILD)/kage $(wildcard scenes/*.yaml scenes/data/*) scripts/relief_sheet.py scripts/contact_sheet.py
	scripts/venv python -m scripts.relief_sheet --kage $(BUILD)/kage -o $@

# Each scene of the gallery by bump mapping only, and by the method that it says itself.
out/gallery/%-none.png: scenes/gallery/%.yaml $(BUILD)/kage
	@mkdir -p out/gallery
	$(BUILD)/kage render $< --shadow none --shade smooth --bump-shadow none --aa 3 -o $@

out/gallery/%.png: scenes/gallery/%.yaml $(BUILD)/kage
	@mkdir -p out/gallery
	$(BUILD)/kage render $< --aa 3 -o $@

out/gallery.png: $(SHOWN:%=out/gallery/%-none.png) $(SHOWN:%=out/gallery/%.png) scripts/contact_sheet.py
	scripts/venv python scripts/contact_sheet.py -o $@ --columns 3 \
	    --title "Above, bump mapping only; below, the same scenes by their best method" \
	    $(foreach s,$(SHOWN),out/gallery/$(s)-none.png="$(s): bump mapping only") \
	    $(foreach s,$(SHOWN),out/gallery/$(s).png="$(s): kage")

out/gallery/index.html: $(GALLERY:%=out/gallery/%-none.png) $(GALLERY:%=out/gallery/%.png) scripts/gallery.py
out/gallery/index.html: scripts/page_of.py $(wildcard bench/templates/*)
	scripts/venv python -m scripts.gallery --kage $(BUILD)/kage -o $@ $(GALLERY:%=scenes/gallery/%.yaml)

# ---- the program ----

# It knows the library by kage.h alone, and how words are spelled. Models are read by kage-import, which it finds beside
# itself.
$(BUILD)/kage: $(PROGRAM:%=$(BUILD)/%.o) $(BUILD)/base/spelling.o $(BUILD)/libkage.a | $(BUILD)/kage-import
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/kage-import: $(IMPORT:%=$(BUILD)/%.o) $(BUILD)/base/files.o
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(IMPORT_LIBS)

$(BUILD)/kage-view: $(WINDOW:%=$(BUILD)/%.o) $(BUILD)/libkage.a
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(VIEW_LIBS) $(LIBS)

$(patsubst %,$(BUILD)/%.o,$(filter view/%,$(WINDOW))): private override CFLAGS += $(VIEW_CFLAGS)

# ---- the library ----

# One object, in which what is hidden is local: only kage_... can be seen by a program that it is linked to.
$(BUILD)/libkage.o: $(LIBRARY:%=$(BUILD)/%.o)
	@echo '  LD  $@'
	$(Q)$(LD) -r -o $@ $^ && $(OBJCOPY) --localize-hidden $@

$(BUILD)/libkage.a: $(BUILD)/libkage.o
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(BUILD)/$(SONAME): $(LIBRARY:%=$(BUILD)/%.o)
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -shared -Wl,-soname,$(SONAME) $(if $(SANITIZE),,-Wl$(comma)--no-undefined) -o $@ $^ $(LIBS)

$(BUILD)/libkage.so: $(BUILD)/$(SONAME)
	$(Q)ln -sf $(SONAME) $@

$(BUILD)/kage.pc: src/api/kage.pc.in include/kage.h FORCE
	$(Q)sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIBDIR@|$(LIBDIR)|' -e 's|@VERSION@|$(VERSION)|' \
	    -e 's|@LIBS@|$(strip $(THREADS) $(LIBS))|' $< > $@

# Objects depend on the flags that made them.
$(BUILD)/flags: FORCE
	@mkdir -p $(BUILD)
	@echo '$(CC) $(CFLAGS) $(LDFLAGS)' | cmp -s - $@ || echo '$(CC) $(CFLAGS) $(LDFLAGS)' > $@

$(BUILD)/mesh/reader.o $(BUILD)/cli/view.o: private DEFINES += -DKAGE_LIBEXEC='"$(LIBEXEC)"'
$(BUILD)/mesh/reader.o $(BUILD)/cli/view.o: $(BUILD)/libexec

$(BUILD)/libexec: FORCE
	@mkdir -p $(BUILD)
	@echo '$(LIBEXEC)' | cmp -s - $@ || echo '$(LIBEXEC)' > $@

$(BUILD)/%.o: src/%.c $(BUILD)/flags
	@echo '  CC  $@'
	@mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) -c -o $@ $<

$(BUILD)/%.o: tests/%.c $(BUILD)/flags
	@echo '  CC  $@'
	@mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) -Itests -DKAGE_TESTS_DIR='"tests"' -c -o $@ $<

# All objects of the library: for the program and the unit tests, which look inside.
$(BUILD)/internal.a: $(LIBRARY:%=$(BUILD)/%.o)
	$(Q)rm -f $@ && $(AR) rcs $@ $^

$(UNITS:%=$(BUILD)/%): $(BUILD)/%: $(BUILD)/%.o $(BUILD)/internal.a
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) -lcmocka $(LIBS)

$(filter $(BUILD)/unit/look/%,$(UNITS:%=$(BUILD)/%)): $(patsubst %,$(BUILD)/%.o,$(filter look/%,$(WINDOW)))

# A test in which memory runs out: our own objects ask its functions.
WRAPPED   = malloc calloc realloc posix_memalign strdup free fy_node_build_from_malloc_string
$(BUILD)/unit/api/test_memory: private override LDFLAGS += $(WRAPPED:%=-Wl,--wrap=%)

# ---- fuzzing ----

# All targets in one program, which runs that of its name: with libFuzzer (clang), or over files with a plain main.
FUZZED    = $(filter-out fuzz/engine fuzz/replay fuzz/letters,$(patsubst tests/%.c,%,$(wildcard tests/fuzz/*.c)))
FUZZ_CC  ?= clang
FUZZ_INPUTS = tests/fuzz/finds

$(BUILD)/fuzz/kage-fuzz: $(FUZZED:%=$(BUILD)/%.o) $(BUILD)/fuzz/engine.o $(BUILD)/internal.a | $(BUILD)/fuzz/letters
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -fsanitize=fuzzer -o $@ $^ $(LIBS)

$(BUILD)/fuzz/replay: $(FUZZED:%=$(BUILD)/%.o) $(BUILD)/fuzz/replay.o $(BUILD)/internal.a | $(BUILD)/fuzz/letters
	@echo '  LD  $@'
	$(Q)$(CC) $(LDFLAGS) -o $@ $^ $(LIBS)

# It is started anew for each input, so without what a sanitizer does first.
$(BUILD)/fuzz/letters: tests/fuzz/letters.c src/mesh/letter.h
	@echo '  LD  $@'
	@mkdir -p $(@D)
	$(Q)$(CC) -Iinclude -Isrc $(STANDARD) -O1 -o $@ $<

fuzz-program:
	@scripts/bootstrap build fuzz
	@$(MAKE) --no-print-directory $(JOBS) $(SANE) CC='$(FUZZ_CC)' OPENMP=no BUILD=build/fuzz \
	    SANITIZE=fuzzer-no-link,address,undefined CFLAGS=-DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION \
	    build/fuzz/fuzz/kage-fuzz

# Each target for so long; scripts/fuzz has more options.
FUZZ_SECONDS = 30
fuzz:
	scripts/fuzz --seconds $(FUZZ_SECONDS)

# The finds that are kept as tests; or FUZZ_INPUTS='TARGET FILE...'
fuzz-replay: bootstrap
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/fuzz/replay
	$(BUILD)/fuzz/replay $(FUZZ_INPUTS)

# ---- the Python package ----

# In $(BUILD)/python, to import from there: links to python/kage, and the modules in C for Python's stable ABI, 3.11 on.
PACKAGE   = $(BUILD)/python/kage
PY_CFLAGS = -Iinclude -Ipython -DPy_LIMITED_API=0x030b0000 -fPIC -O2 \
            -isystem $$($(PYTHON) -c 'import sysconfig; print(sysconfig.get_path("include"))')
MODULES   = $(PACKAGE)/_kage.abi3.so $(PACKAGE)/_methods.abi3.so
# What a module takes from libkage.a is its own.
PY_LINK   = $(CC) $(LDFLAGS) -shared -Wl,--exclude-libs,ALL

python: $(MODULES) $(BUILD)/kage-import FORCE
	@find $(PACKAGE) -type l -delete
	@ln -s $(abspath $(wildcard python/kage/*.py python/kage/*.pyi python/kage/py.typed) $(BUILD)/kage-import \
	    $(patsubst %/__init__.py,%,$(wildcard python/kage/*/__init__.py))) $(PACKAGE)

# With it python/kage/structs.py, which is under version control as others read it, too.
$(BUILD)/python/_kage.c: python/build_ext.py python/structs.py include/kage.h python/methods.h
	@echo '  PY  $@'
	$(Q)$(PYTHON) python/structs.py && $(PYTHON) python/build_ext.py $(@D) >/dev/null

$(BUILD)/python/_methods.c: $(BUILD)/python/_kage.c

$(PACKAGE)/_kage.abi3.so: $(BUILD)/python/_kage.c python/progress.h $(BUILD)/libkage.a
	@echo '  LD  $@'
	@mkdir -p $(@D)
	$(Q)$(PY_LINK) $(PY_CFLAGS) -o $@ $< $(BUILD)/libkage.a $(LIBS)

$(BUILD)/python/%.o: python/%.c python/methods_loops.h python/methods.h include/bumpshadow.h $(BUILD)/flags
	@echo '  CC  $@'
	@mkdir -p $(@D)
	$(Q)$(CC) $(CFLAGS) -Ipython -c -o $@ $<

$(PACKAGE)/_methods.abi3.so: $(BUILD)/python/_methods.c $(BUILD)/python/methods.o $(BUILD)/python/methods_double.o
	@echo '  LD  $@'
	@mkdir -p $(@D)
	$(Q)$(PY_LINK) $(PY_CFLAGS) -o $@ $^ -lm

# For machines that have none of the libraries; out/wheel has it.
wheel: all
	@CC='$(CC)' scripts/bootstrap python package
	@$(MAKE) --no-print-directory $(JOBS) python
	scripts/venv python -m scripts.wheel --build $(BUILD)

# ---- tests ----

# The units in C, in float and in double; then the program and the scripts, in Python.
test: all
	@CC='$(CC)' scripts/bootstrap test python package valgrind
	@$(MAKE) --no-print-directory $(JOBS) unit-tests REAL=float
	@$(MAKE) --no-print-directory $(JOBS) unit-tests REAL=double
	@$(MAKE) --no-print-directory program-tests

unit-tests: $(UNITS:%=$(BUILD)/%)
	@$(MAKE) --no-print-directory --keep-going --output-sync=target $(UNITS:%=run-%)

# All run, side by side; one that fails shows what it printed, and its name.
$(UNITS:%=run-%): run-%: $(BUILD)/% $(BUILD)/kage-import
	@KAGE_IMPORT=$(BUILD)/kage-import $< >$<.log 2>&1 && echo '  OK  $<' || { cat $<.log; echo '  FAILED  $<'; exit 1; }

program-tests: tested-programs
	scripts/venv python -m pytest -q -n auto --dist loadfile tests # a file's tests share what they make

# All that the tests in Python need.
tested-programs: programs python $(BUILD)/fuzz/replay
	@$(MAKE) --no-print-directory $(JOBS) REAL=double build/double/kage python

# What POV-Ray, valgrind or a Python package would tell is left out where they are missing and can't be installed.
bench: all
	@CC='$(CC)' scripts/bootstrap python povray valgrind || echo 'bench: going on without what is missing' >&2
	@$(MAKE) --no-print-directory $(JOBS) python || echo 'bench: going on without the package, which is slower' >&2
	@python=.venv/bin/python; scripts/venv || python=python3; \
	    $$python -m bench --level $(BENCH) --kage $(BUILD)/kage $(SCHEDULER:%=--scheduler %) || [ $$? -eq 3 ]
	@scripts/venv python -m scripts.start_page || echo "bench: out/index.html is left out" >&2

# Each bound of docs/performance.md, with the peers, in one table; SPEED=quick|normal|full.
speed: all
	@CC='$(CC)' scripts/bootstrap python povray valgrind || echo 'speed: going on without what is missing' >&2
	scripts/venv python -m bench.speed --level $(SPEED) --kage $(BUILD)/kage || [ $$? -eq 3 ]
	@scripts/venv python -m scripts.start_page

# The README's tables and pictures, and those of docs/.
readme: render bench
	scripts/venv python -m bench.readme

# Only what is stale is made again.
reference: all
	@CC='$(CC)' scripts/bootstrap python povray
	scripts/venv python reference/render.py --kage $(BUILD)/kage

accept: all
	@CC='$(CC)' scripts/bootstrap python
	@KAGE=$(BUILD)/kage scripts/venv python -m tests.regression.accept

# The instructions of eight renders, which a test compares.
counts: all
	@CC='$(CC)' scripts/bootstrap python valgrind
	@KAGE=$(BUILD)/kage scripts/venv python -m tests.support.instructions

# ---- sanitizers ----

# The clones' resolvers run before a sanitizer is ready; and stages in AVX2 have no other accesses than those in SSE2.
SANE      = CLONES=no OPTIMISE='-O1 -fno-math-errno -fno-trapping-math -ffp-contract=off'
# Those that read every kind of input, right and wrong; tests/verify/sanitizers.py has all.
SANE_TESTS = $(addprefix tests/program/test_,input.py import.py fuzz.py)

# Threads of one process on libkage, without OpenMP, whose barriers ThreadSanitizer does not see (see tsan.supp).
TSAN      = $(SANE) OPENMP=no BUILD=build/tsan SANITIZE=thread

sanitize: all
	@CC='$(CC)' scripts/bootstrap test python
	@LSAN_OPTIONS=suppressions=tests/support/lsan.supp:print_suppressions=0 $(MAKE) --no-print-directory $(JOBS) \
	    $(SANE) BUILD=build/asan SANITIZE=address,undefined unit-tests programs build/asan/fuzz/replay
	@TSAN_OPTIONS=suppressions=tests/support/tsan.supp \
	    $(MAKE) --no-print-directory $(JOBS) $(TSAN) run-unit/api/test_threads
	KAGE=build/asan/kage scripts/venv python -m pytest -q -n auto --dist loadfile $(SANE_TESTS)
	@$(MAKE) --no-print-directory fuzz

# What takes hours (docs/reliability.md). All run, also after one that fails.
VERIFY    = allocations files kills stops numbers scenes slow sanitizers dist deb load fuzz

verify: programs python
	@CC='$(CC)' scripts/bootstrap test python package povray valgrind browser view display shaders shells fuzz debian
	@command -v stress-ng >/dev/null || { echo 'make verify: stress-ng is missing' >&2; exit 1; }
	@for check in $(VERIFY); do scripts/venv python -m tests.verify.$$check || failed="$$failed $$check"; done; \
	    scripts/venv python -m tests.verify.table --write; \
	    [ -z "$$failed" ] || { echo "make verify: failed:$$failed" >&2; exit 1; }

# ---- style ----

format:
	@CC='$(CC)' scripts/bootstrap lint python
	clang-format -i $(C_FILES)
	scripts/venv ruff check --fix-only --quiet

# Layout, likely mistakes, and the types of the Python code.
lint:
	@CC='$(CC)' scripts/bootstrap build test lint python
	clang-format --dry-run -Werror $(C_FILES)
	@$(MAKE) --no-print-directory $(JOBS) --output-sync=target tidy
	scripts/venv ruff check
	scripts/venv mypy

tidy: $(TIDY:%=tidy-%)

$(TIDY:%=tidy-%): tidy-%: %
	@clang-tidy --quiet $< -- \
	    -Iinclude -Isrc -Itests -DKAGE_TESTS_DIR='"tests"' $(STANDARD) $(DEFINES) $(PKG_CFLAGS) $(VIEW_CFLAGS) 2>&1 | \
	    { grep -v ' warnings\{0,1\} .*generated\.$$' && exit 1 || exit 0; }

# Does this tree make the same pictures as another commit? make same REV=main
same: all
	@CC='$(CC)' scripts/bootstrap python valgrind
	scripts/venv python -m scripts.same $(or $(REV),HEAD) --real $(REAL) $(ONLY:%=--only %)

# ---- to give away ----

dist:
	@python3 -m scripts.dist

# Manual pages and docs/kage.md, after a change of options, docs/scene.md or the headers.
manuals: all
	@CC='$(CC)' scripts/bootstrap python
	scripts/venv python -m scripts.man --kage $(BUILD)/kage

docs:
	@CC='$(CC)' scripts/bootstrap python
	scripts/venv python -m mkdocs build --strict --quiet
	@echo "the pages are in out/docs/index.html"

# LIBDIR, LIBEXEC, SHARE: of the library, of kage-import, and of manuals and completions, where they are not in
# PREFIX/lib, PREFIX/libexec/kage and PREFIX/share.
install: all
	@$(MAKE) --no-print-directory install-files

# Manuals, and the completions of shells: a file, and where it goes below SHARE.
MANUALS   = man1/kage.1 man3/kage.3 man3/bumpshadow.3 man5/kage-scene.5
SHELLS    = kage.bash:bash-completion/completions/kage _kage:zsh/site-functions/_kage \
            kage.fish:fish/vendor_completions.d/kage.fish

# The same of what is built already.
install-files: $(BUILD)/kage.pc
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/include $(DESTDIR)$(LIBDIR)/pkgconfig $(DESTDIR)$(LIBEXEC)
	install -m 755 $(BUILD)/kage $(DESTDIR)$(PREFIX)/bin/kage
	install -m 755 $(BUILD)/kage-import $(DESTDIR)$(LIBEXEC)/kage-import
	$(if $(filter yes,$(VIEW)),install -m 755 $(BUILD)/kage-view $(DESTDIR)$(LIBEXEC)/kage-view)
	install -m 644 include/kage.h include/bumpshadow.h include/bumpshadow.glsl $(DESTDIR)$(PREFIX)/include
	install -m 644 $(BUILD)/libkage.a $(DESTDIR)$(LIBDIR)/libkage.a
	install -m 755 $(BUILD)/$(SONAME) $(DESTDIR)$(LIBDIR)/$(SONAME)
	ln -sf $(SONAME) $(DESTDIR)$(LIBDIR)/libkage.so
	install -m 644 $(BUILD)/kage.pc $(DESTDIR)$(LIBDIR)/pkgconfig/kage.pc
	$(foreach m,$(MANUALS),install -D -m 644 man/$(notdir $(m)) $(DESTDIR)$(SHARE)/man/$(m) &&) true
	$(foreach s,$(SHELLS),install -D -m 644 completions/$(subst :, $(DESTDIR)$(SHARE)/,$(s)) &&) true

uninstall:
	rm -f $(MANUALS:%=$(DESTDIR)$(SHARE)/man/%) $(foreach s,$(SHELLS),$(DESTDIR)$(SHARE)/$(lastword $(subst :, ,$(s))))
	rm -f $(DESTDIR)$(PREFIX)/bin/kage $(DESTDIR)$(LIBEXEC)/kage-import $(DESTDIR)$(LIBEXEC)/kage-view \
	    $(DESTDIR)$(PREFIX)/include/kage.h \
	    $(DESTDIR)$(PREFIX)/include/bumpshadow.h $(DESTDIR)$(PREFIX)/include/bumpshadow.glsl \
	    $(DESTDIR)$(LIBDIR)/libkage.a $(DESTDIR)$(LIBDIR)/$(SONAME) $(DESTDIR)$(LIBDIR)/libkage.so \
	    $(DESTDIR)$(LIBDIR)/pkgconfig/kage.pc
	rmdir $(DESTDIR)$(LIBEXEC) 2>/dev/null || true

clean:
	rm -rf build out

.PRECIOUS: $(BUILD)/%.o

-include $(wildcard $(BUILD)/*/*.d $(BUILD)/unit/*/*.d)

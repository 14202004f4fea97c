# kage: make render | test | bench | reference | install | clean | help
#
#   REAL=float|double     the number type of the tracer (double: for verification)
#   CC=gcc|clang          the compiler
#   SANITIZE=address,undefined
#   CLONES=no             without the AVX2 copies of the stages
#   BUILD=DIR             where the objects and the program go

REAL     ?= float
SANITIZE ?=
CLONES   ?= yes
BUILD    ?= build/$(REAL)

PKGS      = libpng libfyaml OpenEXR
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
ifneq ($(SANITIZE),)
SANITIZER = -fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer -g
endif

# The libraries' headers as system headers: their warnings are not ours.
PKG_CFLAGS := $(patsubst -I%,-isystem %,$(shell pkg-config --cflags $(PKGS) 2>/dev/null))
PKG_LIBS   := $(shell pkg-config --libs-only-L OpenEXR 2>/dev/null) -lOpenEXRCore $(shell pkg-config --libs libpng libfyaml 2>/dev/null)
override CFLAGS  += $(STANDARD) $(OPTIMISE) -fopenmp $(WARNINGS) $(DEFINES) $(SANITIZER) $(PKG_CFLAGS) -MMD -MP
override LDFLAGS += -fopenmp $(SANITIZER)
LIBS       = $(PKG_LIBS) -lm

PROGRAM   = main arguments progress command_render command_check command_pixel
SOURCES   = $(patsubst src/%.c,%,$(wildcard src/*.c))
LIBRARY   = $(filter-out $(PROGRAM),$(SOURCES))
UNITS     = $(patsubst tests/%.c,%,$(wildcard tests/test_*.c))

.PHONY: all render test install clean help bootstrap tests
all: bootstrap $(BUILD)/kage

bootstrap:
	@CC='$(CC)' scripts/bootstrap build

$(BUILD)/kage: $(PROGRAM:%=$(BUILD)/%.o) $(LIBRARY:%=$(BUILD)/%.o)
	$(CC) $(LDFLAGS) -o $@ $^ $(LIBS)

# Objects depend on the flags that made them.
$(BUILD)/flags: FORCE
	@mkdir -p $(BUILD)
	@echo '$(CC) $(CFLAGS) $(LDFLAGS)' | cmp -s - $@ || echo '$(CC) $(CFLAGS) $(LDFLAGS)' > $@
FORCE:

$(BUILD)/%.o: src/%.c $(BUILD)/flags
	$(CC) $(CFLAGS) -c -o $@ $<

$(BUILD)/%.o: tests/%.c $(BUILD)/flags
	$(CC) $(CFLAGS) -Isrc -Itests -DKAGE_TESTS_DIR='"tests"' -c -o $@ $<

$(BUILD)/test_%: $(BUILD)/test_%.o $(LIBRARY:%=$(BUILD)/%.o)
	$(CC) $(LDFLAGS) -o $@ $^ -lcmocka $(LIBS)

-include $(wildcard $(BUILD)/*.d)

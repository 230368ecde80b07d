# Everything a checkout can do. A virtual environment in .venv is made on first use.

PYTHON ?= $(shell for p in python3 python3.13 python3.12 python3.11; do \
	$$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && { echo $$p; exit; }; done; echo python3)
BIN := .venv/bin
READY := .venv/.ready
OUT ?= out
CHECKS ?= yes
# A pack of compiled kernels (`fixedpipe cache pack`), which `make setup` takes where it lies here.
KERNELS ?= kernels.pack
LEVELS := x86-64-v4 x86-64-v3 x86-64
MACHINES ?=
# Tests run in a process per processor (eight at most: each has every kernel in memory). A process that has none left
# takes half of those that another has before it, so most of a file's tests stay together, with what they share.
# Measured with two processes: 2 % longer than if the work were shared out evenly; by whole files, 28 %.
# `make test WORKERS=` runs them in one process, one after the other.
WORKERS ?= --numprocesses auto --maxprocesses 8 --dist worksteal
# The folders under the name by which they are imported: mypy does not follow an editable install's hook.
NAMED := .cache/types/fixedpipe
# Hundreds of processes import the same modules. Where bytecode is not written, each of them compiles these anew.
unexport PYTHONDONTWRITEBYTECODE
CAPTURES := $(abspath ../shared/silicon/golden/results)
ifneq ($(wildcard $(CAPTURES)),)
export FIXEDPIPE_CAPTURES ?= $(CAPTURES)
endif

.PHONY: help setup figures conformance machines instructions arithmetic techniques layers docs docs-check notebooks site test \
	test-all check bench accept \
	accept-conformance accept-selftest matrix wheel clean

help:
	@echo "make figures            render and check every figure into $(OUT)/; $(OUT)/index.html is a gallery"
	@echo "                        (CHECKS=no: without checks; MACHINES='paper NV2A': on these alone, paper being each"
	@echo "                        figure's own)"
	@echo "make conformance        redraw the captures of FIXEDPIPE_CAPTURES; $(OUT)/conformance.html shows the rest"
	@echo "make test               prove it: everything that takes seconds (make test-all: minutes as well)"
	@echo "make check              style: ruff check, ruff format --check; types of what users call: mypy"
	@echo "make bench              measure; BENCH='--peer llvmpipe' compares with Mesa"
	@echo "make machines           write docs/machines.md: which machine has which feature"
	@echo "make instructions       write docs/program-instructions.md: what programs' instructions become, and round"
	@echo "make arithmetic         write docs/arithmetic-for-emulators.md: the NV2A's rules with formulas and vectors"
	@echo "make techniques         write docs/papers/index.md: which technique, figure or study an id is"
	@echo "make layers             write into docs/architecture.md which package imports which (tests/layers.py)"
	@echo "make docs               write into the pages what commands measure (ONLY='F004-2 P9': these alone): 5 minutes"
	@echo "make docs-check         measure the pages' numbers again, and print those that differ, with page and line"
	@echo "make notebooks          run the notebooks of docs/examples, and save what they show"
	@echo "make accept FIGURE=ID   accept a figure's digest (PROFILE=NAME: on that machine) once it was looked at"
	@echo "make accept-conformance accept how many pixels agree with the captures (WORSE=yes: fewer too)"
	@echo "make accept-selftest    accept the self-test's digests, once its picture was looked at"
	@echo "make matrix             the self-test under every Python here, with the oldest and the newest packages allowed"
	@echo "                        (MATRIX='--python 3.12 --packages oldest --cpus'): 5 minutes each"
	@echo "make site               build the pages as a site, out/site/index.html, which a browser opens without a server"
	@echo "make setup              make the virtual environment, .venv, as all of these do on first use"
	@echo "make wheel              a wheel in dist/ with compiled kernels in it (LEVELS=x86-64-v3: for these processors)"
	@echo "make clean              remove what is made here, but .venv"

setup: $(READY)

$(READY): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; v = sys.version_info; sys.exit(v < (3, 11) and "fixedpipe needs Python 3.11 or newer; \
	$(PYTHON) is %d.%d. Install a newer one, or name it: make PYTHON=/path/to/python3.11" % v[:2])'
	@[ -x $(BIN)/python ] || { echo "making a virtual environment in .venv"; $(PYTHON) -m venv .venv; }
	@echo "installing the pinned packages of constraints.txt"
	@said=$$($(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt \
	--editable '.[dev,bench]' 2>&1) || { status=$$?; printf '%s\n' "$$said" >&2; exit $$status; }
	@[ ! -f "$(KERNELS)" ] || $(BIN)/fixedpipe cache unpack "$(KERNELS)" || echo "Kernels are compiled when they are needed."
	@touch $@

# A wheel with compiled kernels for this Python and each level of processors that this one has.
wheel: $(READY)
	@mkdir -p raster/packs
	for level in $(LEVELS); do $(BIN)/fixedpipe cache pack raster/packs/$$level.pack --level $$level || exit; done
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .

# With CHECKS=no nothing is checked; MACHINES names those that draw, of which `paper` is the one of a figure's paper.
figures: $(READY)
	$(BIN)/fixedpipe figures $(if $(filter no,$(CHECKS)),,--check) $(MACHINES:%=--profile %) --out $(OUT)

conformance: $(READY)
	$(BIN)/fixedpipe conformance --html $(OUT)/conformance.html --json $(OUT)/conformance.json

# Options of the suite's own have their values in one word: pytest takes a word apart for a path, and where that file
# exists, as after the first run, it looks for conftest.py beside it alone.
test: $(READY)
	$(BIN)/python -m pytest $(WORKERS) -m "not slow" --examples=3 -rs --times=$(OUT)/test-times.json

test-all: $(READY)
	$(BIN)/python -m pytest $(WORKERS) -rs --times=$(OUT)/test-all-times.json

check: $(READY) $(NAMED)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

$(NAMED):
	@mkdir -p $@
	@ln -s ../../../raster ../../../pipeline ../../../effects $@

bench: $(READY)
	$(BIN)/python -m bench $(BENCH)

machines: $(READY)
	$(BIN)/python -m tests.machines

instructions: $(READY)
	$(BIN)/python -m tests.instructions

arithmetic: $(READY)
	$(BIN)/python -m tests.arithmetic
	$(BIN)/python -m tests.open_questions

techniques: $(READY)
	$(BIN)/python -m tests.techniques

layers: $(READY)
	$(BIN)/python -m tests.layers

docs: $(READY)
	$(BIN)/python -m tests.documents $(ONLY)

docs-check: $(READY)
	$(BIN)/python -m tests.documents --check $(ONLY)

site: $(READY)
	$(BIN)/python -m docs.site $(OUT)/site

notebooks: $(READY)
	$(BIN)/python -m tests.notebooks

accept: $(READY)
	@[ -n "$(FIGURE)" ] || { echo "Say which figure: make accept FIGURE=ID (fixedpipe figures --list names them)."; exit 2; }
	$(BIN)/python -m tests.accept $(FIGURE) $(PROFILE) $(if $(filter yes,$(LOOKED)),--looked)

accept-conformance: $(READY)
	$(BIN)/python -m tests.accept_conformance $(if $(filter yes,$(WORSE)),--worse)

accept-selftest: $(READY)
	$(BIN)/python -m tests.accept_selftest $(if $(filter yes,$(LOOKED)),--looked)

matrix: $(READY)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[matrix]'
	$(BIN)/python -m tests.matrix $(MATRIX)

clean:
	rm -rf .cache raster/packs .hypothesis .pytest_cache .ruff_cache build dist $(OUT) *.egg-info

# make demo: the paper's panel, from nothing to figures. make test: linter, types and tests but the long ones, in some
# minutes; make test-all: everything the project checks, as continuous integration does. Needs Python 3.11 or later, make
# and pip. PYTHON=... chooses the interpreter, VENV=... the place of the environment.
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
# Where the surroundings forbid it, every process of the tests would compile the package, and every run the tests.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: demo test lint docs clean
.DELETE_ON_ERROR:

$(BIN)/python:
	$(PYTHON) -c "import sys; sys.exit(sys.version_info < (3, 11) and 'concio needs Python 3.11 or later')"
	$(PYTHON) -m venv $(VENV)

$(VENV)/.installed: pyproject.toml | $(BIN)/python
	$(PIP) install --quiet --editable .
	touch $@

$(VENV)/.installed-dev: pyproject.toml | $(BIN)/python
	$(PIP) install --quiet --editable '.[dev]'
	touch $@ $(VENV)/.installed

$(VENV)/.installed-docs: pyproject.toml | $(BIN)/python
	$(PIP) install --quiet --editable '.[docs]'
	touch $@ $(VENV)/.installed

demo: $(VENV)/.installed
	@echo "1. The paper's panel, hung between two walls: the arch carries everything into them."
	@$(BIN)/concio run examples/ercolano_panel.toml --out demo/no-base
	@echo
	@echo "2. The same panel on a full base: the load goes straight down."
	@$(BIN)/concio run examples/ercolano_panel_full_base.toml --out demo/full-base
	@echo
	@echo "Compare demo/no-base/figures/principal.png with demo/full-base/figures/principal.png."
	@echo "The reports open in a browser: $(BIN)/concio view demo/no-base"

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/mypy

# Everything runs even where something fails, so that one run tells all; the tests come last and close with their count.
SELECT ?= not long
test: $(VENV)/.installed-dev
	@status=0; \
	$(BIN)/ruff check . || status=1; \
	$(BIN)/mypy || status=1; \
	OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal -m "$(SELECT)" || status=1; \
	exit $$status

.PHONY: test-all
test-all:
	$(MAKE) test SELECT="long or not long"

# As test-all, with every random case: the whole ensembles, of which test-all draws a part (tests/samples.py). About an hour.
.PHONY: test-ensembles
test-ensembles:
	CONCIO_CASES=all $(MAKE) test-all

# The window in a real browser: Chromium is installed from Debian's package where it is missing and apt is there.
.PHONY: journeys
journeys: $(VENV)/.installed-dev
	@tests/journeys/run.sh $(BIN)/python

# The properties with cases drawn afresh, as many as in test-ensembles; the other runs draw the same ones every time, so
# that they judge the code alone.
.PHONY: fresh
fresh: $(VENV)/.installed-dev
	CONCIO_CASES=fresh OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal tests

# Small faults put into the core on purpose: those that once passed unseen must be seen, a new sample is printed.
.PHONY: mutants
mutants: $(VENV)/.installed-dev
	OMP_NUM_THREADS=1 $(BIN)/python tests/mutants.py --named --minutes $(or $(MINUTES),inf)
	-OMP_NUM_THREADS=1 $(BIN)/python tests/mutants.py --count $(or $(COUNT),60) --minutes $(or $(MINUTES),inf)

# The tests with the lowest versions that pyproject.toml allows, and with the newest Python there is (NEWEST=python3.14).
NEWEST ?= $(shell for v in 15 14 13 12; do python3.$$v -c "import sys; print(sys.executable)" 2>/dev/null && break; done)
.PHONY: lowest newest
lowest:
	$(PYTHON) -m venv $(VENV)-lowest
	$(PYTHON) tests/lowest.py > $(VENV)-lowest/requirements.txt
	$(VENV)-lowest/bin/python -m pip install --quiet --requirement $(VENV)-lowest/requirements.txt --editable .
	OMP_NUM_THREADS=1 $(VENV)-lowest/bin/python -m pytest -n 2 --dist worksteal

newest:
	@test -n "$(NEWEST)" || { echo "no other Python was found: make newest NEWEST=/path/to/python"; exit 1; }
	$(MAKE) test-all PYTHON=$(NEWEST) VENV=$(VENV)-newest

# The tests with the linear algebra kernels of an older processor (CORE), with one thread and with two: nothing that is
# tested may hold by the rounding of one kernel.
CORE ?= Nehalem
.PHONY: older
older: $(VENV)/.installed-dev
	@status=0; for threads in 1 2; do \
	OPENBLAS_CORETYPE=$(CORE) OMP_NUM_THREADS=$$threads $(BIN)/python -m pytest -n 2 --dist worksteal -m "$(SELECT)" \
	|| status=1; done; exit $$status

docs: $(VENV)/.installed-docs
	$(BIN)/sphinx-build -E -W --keep-going -b html docs docs/_build/html
	$(BIN)/python docs/check_links.py docs/_build/html

# Runs every validation case and every gallery example again and rewrites their pages in docs/.
.PHONY: book
book: $(VENV)/.installed-docs
	OMP_NUM_THREADS=1 $(BIN)/python docs/make_validation.py
	OMP_NUM_THREADS=1 $(BIN)/python docs/make_gallery.py
	OMP_NUM_THREADS=1 $(BIN)/python docs/make_pictures.py

clean:
	rm -rf $(VENV) $(VENV)-lowest $(VENV)-newest build dist demo docs/_build .pytest_cache .mypy_cache .ruff_cache .hypothesis

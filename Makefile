# Everything sets itself up: `make demo` and `make test` need python3 (3.11 or newer), make and a
# C library, and create .venv with pip. Another interpreter: `make PYTHON=python3.12 test`.

PYTHON ?= python3
JOBS ?= 2
SECONDS ?= 60
export NO_MKDOCS_2_WARNING = 1

VENV := .venv
BIN := $(VENV)/bin
PY := $(BIN)/python
PIP := $(PY) -m pip --disable-pip-version-check --no-input
PYTEST := $(PY) -m pytest -n $(JOBS) --doctest-modules tests src

# Stamps: a rule runs again only when what it depends on is newer.
MADE := $(VENV)/.made
CORE := $(VENV)/.core
DEV := $(VENV)/.dev
NODE := node_modules/.package-lock.json

.PHONY: help venv demo test test-all clients check bench docs fuzz clean
.DELETE_ON_ERROR:

help:
	@echo 'make demo      a 5 m walk into demo/ (installs what the library needs, nothing else)'
	@echo 'make test      the fast tests and the examples in docstrings: under three minutes'
	@echo 'make test-all  the slow tests too'
	@echo 'make clients   our files in the programs of others; needs node and npm, skips without'
	@echo 'make check     format, lint, types, import contract, docs, index of papers'
	@echo 'make fuzz      broken files for the readers, SECONDS=60 of them; needs the network for atheris'
	@echo 'make bench     speed, as ratios within one run'
	@echo 'make docs      the index of papers and the site in site/'
	@echo 'make venv      .venv with all that the above need'
	@echo 'make clean     remove what these made, but .venv'

$(MADE):
	@command -v $(PYTHON) >/dev/null 2>&1 || { \
	  echo 'gaitsmith needs Python 3.11 or newer; there is no "$(PYTHON)" here.' \
	       'Name another: make PYTHON=python3.12 ...' >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "gaitsmith needs Python 3.11 or newer; $(PYTHON) is $$($(PYTHON) --version 2>&1)." \
	       'Name another: make PYTHON=python3.12 ...' >&2; exit 1; }
	@echo 'making $(VENV)'
	@$(PYTHON) -m venv --clear $(VENV) || { \
	  echo '"$(PYTHON) -m venv" failed; on Debian and Ubuntu it needs: apt install python3-venv' >&2; exit 1; }
	@$(PIP) install --quiet --upgrade 'pip>=25.1'
	@touch $@

$(CORE): $(MADE) pyproject.toml constraints.txt
	@echo 'installing gaitsmith into $(VENV)'
	@$(PIP) install --quiet --editable . --constraint constraints.txt
	@touch $@

$(DEV): $(MADE) pyproject.toml constraints.txt
	@echo 'installing gaitsmith and its development tools into $(VENV)'
	@$(PIP) install --quiet --editable . --group dev --constraint constraints.txt
	@touch $(CORE) $@

venv: $(DEV)

demo: $(CORE)
	$(BIN)/gaitsmith demo -o demo
	@ls -l demo

test: $(DEV)
	$(PYTEST) -m 'not slow and not clients'

test-all: $(DEV)
	$(PYTEST) -m 'not clients'

clients: $(DEV) $(NODE)
	$(PY) -m pytest -m clients -rs tests

$(NODE): package.json package-lock.json .npmrc
	@if command -v node >/dev/null 2>&1 && command -v npm >/dev/null 2>&1; then \
	  echo 'installing programs of others into node_modules' && \
	  npm ci --no-audit --no-fund --loglevel=error && touch $@; \
	else echo 'node or npm is absent: what needs them is skipped'; fi

check: $(DEV)
	$(PY) -m ruff format --check .
	$(PY) -m ruff check .
	$(BIN)/pyright --pythonpath $(PY)
	$(BIN)/lint-imports
	$(PY) tools/paper_index.py --check
	$(PY) -m mkdocs build --strict --quiet

fuzz: $(DEV)
	@$(PY) -c 'import atheris' 2>/dev/null || $(PIP) install --quiet atheris || \
	  echo 'atheris cannot be installed here: mutations are random instead of guided'
	$(PY) tests/fuzz/fuzz_readers.py --seconds $(SECONDS)

bench: $(DEV)
	$(PY) benchmarks/run.py

docs: $(DEV)
	$(PY) tools/paper_index.py
	$(PY) -m mkdocs build --strict
	@echo 'open site/index.html'

clean:
	rm -rf site demo build dist .pytest_cache .ruff_cache .hypothesis .import_linter_cache .benchmarks
	find src tests tools benchmarks examples -name __pycache__ -type d -prune -exec rm -rf {} +

# Two commands do everything: `make run` and `make test`.  Both set up .venv on first use, with
# python3 alone or with uv when it is there.  `make help` lists the rest.

CASE ?= cases/poisson/annulus.yaml
JOBS ?= 2
VENV := .venv
PEERS := .venv-peers
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
UV := $(shell command -v uv 2>/dev/null)
RUN_DIR = runs/$(basename $(notdir $(CASE)))

# One thread a process: the tests run in $(JOBS) processes, and times of small matrices are steadier.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 MKL_NUM_THREADS=1
export MPLBACKEND ?= Agg
export PYVISTA_OFF_SCREEN ?= true

.PHONY: help run test test-slow lint format types layers notebooks pair bench bench-peers bench-large gallery figures lock clean
.DEFAULT_GOAL := help

help:  ## list the commands
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## */\1\t/' | expand -t 12

run: $(STAMP)  ## run a case: make run [CASE=cases/poisson/annulus.yaml]
	@$(BIN)/rfm run $(CASE) --out $(RUN_DIR)

test: $(STAMP)  ## the tests, except the slow ones
	$(ONE_THREAD) $(BIN)/python -m pytest -q -n $(JOBS) --dist worksteal

test-slow: $(STAMP)  ## the slow tests
	$(BIN)/python -m pytest -q -m slow

lint: $(STAMP)  ## style, docstrings and format
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

format: $(STAMP)  ## write the format and the fixes that are safe
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

types: $(STAMP)  ## the strict type checker
	$(BIN)/mypy

layers: $(STAMP)  ## imports point one way only
	PYTHONPATH=. $(BIN)/lint-imports

notebooks: $(STAMP)  ## execute the notebooks from a clean kernel
	$(BIN)/python -m pytest -q --nbmake --nbmake-timeout=600 -o addopts= -o filterwarnings= notebooks

pair: $(STAMP)  ## write the notebooks anew from their scripts
	$(BIN)/jupytext --sync notebooks/*.py

# A solve ends its series at LIMIT seconds; all series of a program on a problem share eight times that.
LIMIT ?= 10
BENCH := $(BIN)/python -m benchmarks.run --limit $(LIMIT)

bench: $(VENV)/.installed-bench  ## time rfm beside scikit-fem on gmsh meshes
	$(BENCH) --programs rfm scikit-fem --name bench

bench-peers: $(STAMP) $(PEERS)/.installed  ## time rfm beside NGSolve, ngsxfem, scikit-fem and nutils: make bench-peers [LIMIT=10]
	$(BENCH) --peers-python $(PEERS)/bin/python --pages docs

bench-large: $(STAMP)  ## time and memory of rfm up to 1e6 unknowns; takes long
	$(BENCH) --limit 1000 --large --pages docs

gallery: $(STAMP)  ## render docs/gallery from the cases
	$(BIN)/python docs/render_gallery.py

figures: $(STAMP)  ## render docs/pictures, the figures of the theory pages
	$(BIN)/python docs/render_figures.py

lock:  ## write the locks anew (needs uv)
	uv pip compile pyproject.toml --extra dev --universal --python-version 3.11 --upgrade --quiet \
	  --generate-hashes --no-emit-index-url --no-emit-find-links --no-annotate \
	  --custom-compile-command "make lock" --output-file requirements.lock
	uv pip compile pyproject.toml --extra bench --universal --python-version 3.11 --upgrade --quiet \
	  --constraints requirements.lock \
	  --generate-hashes --no-emit-index-url --no-emit-find-links --no-annotate \
	  --custom-compile-command "make lock" --output-file requirements-bench.lock
	uv pip compile pyproject.toml --extra peers --universal --python-version 3.11 --upgrade --quiet \
	  --constraints requirements.lock \
	  --generate-hashes --no-emit-index-url --no-emit-find-links --no-annotate \
	  --custom-compile-command "make lock" --output-file requirements-peers.lock

clean:  ## remove caches and runs, keep .venv
	rm -rf runs studies build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find rfm structures solvers tests benchmarks docs -name __pycache__ -type d -prune -exec rm -rf {} +

# The environment: made once, made again when the requirements change.
$(STAMP): pyproject.toml requirements.lock
	@$(call make_venv,$(VENV))
	@$(call install,$(VENV),requirements.lock)
ifdef UV
	@$(UV) pip install --quiet --python $(BIN)/python --no-deps --no-build-isolation --editable .
else
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
endif
	@touch $@

$(VENV)/.installed-bench: $(STAMP) requirements-bench.lock
	@$(call install,$(VENV),requirements-bench.lock)
	@touch $@

# The other programs have an environment of their own, so that none of them reaches the tests.
$(PEERS)/.installed: requirements-peers.lock
	@$(call make_venv,$(PEERS))
	@$(call install,$(PEERS),requirements-peers.lock)
	@touch $@

define make_venv
if [ ! -x $(1)/bin/python ]; then \
  for python in $${PYTHON:-} python3 python3.14 python3.13 python3.12 python3.11; do \
    if "$$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then found=$$python; break; fi; \
  done; \
  if [ -z "$$found" ]; then echo "rfm needs Python 3.11 or newer: none found; set PYTHON=/path/to/python3" >&2; exit 1; fi; \
  echo "setting up $(1) with $$("$$found" --version), once; this takes a minute or two"; \
  if [ -n "$(UV)" ]; then "$(UV)" venv --quiet --seed --python "$$found" $(1); else "$$found" -m venv $(1); fi || { \
    rm -rf $(1); \
    echo "could not make $(1); on Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }; \
fi
endef

ifdef UV
install = $(UV) pip install --quiet --python $(1)/bin/python --require-hashes --requirement $(2)
else
install = $(1)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes --requirement $(2)
endif

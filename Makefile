# One word does a thing from a fresh clone; what has been done is not done again.

DEMO := osgode.examples.heap
VENV := .venv
PY := $(VENV)/bin/python
PIP := $(PY) -m pip --disable-pip-version-check --quiet
BENCH := build/benchmarks
CFLAGS ?= -O2

SYSTEM_DONE := $(VENV)/.stamp-system
VENV_DONE := $(VENV)/.stamp-venv
BUILD_DONE := $(VENV)/.stamp-build

NATIVE := $(wildcard osgode/native/*.c osgode/native/*.h osgode/native/*.cdef)
GENERATED := osgode/native/_core.c# by cffi: a result, not a source

MAKEFLAGS += --no-builtin-rules
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help demo test lint bench wheel setup clean distclean

help: ## print this list
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' Makefile

demo: setup ## run the demo (everything that is missing is installed first)
	$(PY) -m $(DEMO) $(ARGS)

test: setup ## run the tests; ARGS="-k hinge" goes to pytest
	@tools/setup.sh test
	$(PY) -m pytest -n auto $(ARGS)

lint: setup ## check style, format and types
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	$(PY) -m mypy --strict osgode

bench: setup $(patsubst benchmarks/c/%.c,$(BENCH)/%,$(wildcard benchmarks/c/*.c)) ## time osgode against C and others
	$(PY) -m benchmarks $(ARGS)

wheel: setup ## build a wheel into dist/
	rm -rf build/lib* build/bdist* dist
	$(PIP) wheel --no-build-isolation --no-deps --wheel-dir dist .

setup: $(BUILD_DONE) ## install what is missing and build the extension, no more

clean: ## remove what was built, but not the virtual environment
	rm -rf build dist *.egg-info .mypy_cache .pytest_cache .ruff_cache .hypothesis
	rm -f $(GENERATED) osgode/native/*.so osgode/native/*.o $(BUILD_DONE)
	find . -name __pycache__ -not -path './$(VENV)/*' -prune -exec rm -rf {} +

distclean: clean ## remove the virtual environment as well
	rm -rf $(VENV)

$(SYSTEM_DONE): tools/setup.sh
	@tools/setup.sh system
	@mkdir -p $(@D)
	@touch $@

$(VENV_DONE): $(SYSTEM_DONE)
	@tools/setup.sh venv $(VENV)
	@touch $(SYSTEM_DONE) $@

$(BUILD_DONE): $(VENV_DONE) pyproject.toml setup.py build_ode.py $(filter-out $(GENERATED),$(NATIVE))
	@echo '==> installing the Python packages and building the extension' >&2
	@rm -f osgode/native/_core*.so # one built by hand may have a name that Python prefers to the new one's
	@$(PIP) install --no-build-isolation --editable '.[dev]'
	@touch $@

$(BENCH)/%: benchmarks/c/%.c | $(BUILD_DONE)
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -Wall -Wextra -o $@ $< -lode -lm

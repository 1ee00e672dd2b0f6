# Thin wrapper: every target sets up .venv when it is missing or out of date.
PYTHON ?= python3.11
BIN := .venv/bin
# The dense solves are small: more BLAS threads only get in each other's way.
export OPENBLAS_NUM_THREADS ?= 1

.DEFAULT_GOAL := help
.PHONY: help setup refit test test-slow test-matrix mutants test-wheel check figures docs report bench format lock clean

help:  ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  make %-16s %s\n", $$1, $$2}'

.venv/.ready: requirements.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

setup: .venv/.ready  ## create .venv from the lock file

refit: setup  ## refit all tables and compare them with the paper
	$(BIN)/shadefit refit all
	$(BIN)/shadefit compare

check: setup  ## format, lint and types
	$(BIN)/ruff format --check --quiet .
	$(BIN)/ruff check --quiet .
	$(BIN)/ty check --quiet

test: check  ## checks, then the default tests
	$(BIN)/pytest -n 2

test-slow: setup  ## the full refits and the large sweeps
	$(BIN)/pytest -n 2 -m slow

# The versions of Python to try, as far as they are installed; each has an environment of its own.
PYTHONS ?= python3.11 python3.12 python3.13
MATRIX := build/matrix

test-matrix:  ## the default tests with every version of Python that is installed
	@for python in $(PYTHONS); do \
	    if ! command -v $$python >/dev/null; then echo "$$python is not installed"; continue; fi; \
	    echo "$$python"; place=$(MATRIX)/$$python; \
	    $$python -m venv $$place && \
	    $$place/bin/pip install --quiet --disable-pip-version-check --require-hashes \
	        -r requirements.lock && \
	    $$place/bin/pip install --quiet --disable-pip-version-check --no-deps \
	        --no-build-isolation -e . && \
	    $$place/bin/pytest -n 2 || exit 1; \
	done

mutants: setup  ## count the small changes of the code that its tests notice
	$(BIN)/python benchmarks/mutants.py

test-wheel: setup  ## build the packages, install them into an empty environment, and test them there
	$(BIN)/pytest -m wheel tests/test_wheel.py

figures: setup  ## draw the pictures of README.md and docs/ into docs/figures
	$(BIN)/shadefit figures --out docs/figures
	$(BIN)/shadefit render --out docs/figures
	$(BIN)/shadefit render cloth --sweep --fibers even --size 150 --out docs/figures
	$(BIN)/shadefit ambient --out docs/figures

docs: .venv/.docs  ## build the documentation site into build/site, and check its links
	rm -rf build/site
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going -b html -c docs/site \
	    -d build/doctrees . build/site
	$(BIN)/shadefit report --pictures docs/figures --out build/site/explorer.html
	$(BIN)/python docs/site/check_links.py build/site

.venv/.docs: .venv/.ready requirements-docs.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
	    -r requirements-docs.lock
	touch $@

report: setup  ## write build/report.html: every table's worth, the figures, and an explorer
	$(BIN)/shadefit report

verify: toolchains  ## compile, run and compare the exported code of every table, in every language
	$(BIN)/shadefit verify ps g q r velvet published/ps published/g published/q published/r exact/ps \
	    --precision all
	$(BIN)/shadefit verify $(patsubst coefficients/tables/fuzz/%.json,%,$(wildcard coefficients/tables/*/best/*.json))

bench: setup  ## reproduce the claims of speed, as ratios measured in one run
	$(BIN)/python benchmarks/refit_times.py --write docs
	$(BIN)/python benchmarks/speed_ratios.py
	$(BIN)/python benchmarks/search_times.py
	$(BIN)/python benchmarks/samplers.py

format: setup  ## format and mend what can be mended
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

lock: setup  ## resolve the locked dependencies anew
	$(BIN)/uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header \
	    --no-emit-index-url --no-emit-find-links --python-version 3.11 --extra dev \
	    pyproject.toml -o requirements.lock
	$(BIN)/uv pip compile --quiet --universal --generate-hashes --no-annotate --no-header \
	    --no-emit-index-url --no-emit-find-links --python-version 3.11 -c requirements.lock \
	    requirements-docs.in -o requirements-docs.lock

clean:  ## remove the environment and caches
	rm -rf .venv .pytest_cache .ruff_cache .hypothesis *.egg-info

include toolchains.mk

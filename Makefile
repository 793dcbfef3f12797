# Everything a tree needs, from a fresh clone: `make carry` and `make test`.
#
# Set-up is done once and remembered by stamp files in .venv: the locked packages are installed
# again when a lock changes, the extension is built again when its sources change.

PYTHON ?= python3

VENV := .venv
BIN := $(VENV)/bin
export PYTHON

EXTENSION := pyproject.toml CMakeLists.txt $(wildcard include/palmbots/*.hpp src/bindings/* src/lanes/*)
CXX_FILES = $(shell find include src tests benchmarks verify -name '*.hpp' -o -name '*.cpp')
PY_FILES = src tests examples benchmarks verify

# Installs the package into .venv: the Python sources where they lie, the extension compiled
# (incrementally) in build/extension. $(1): warnings as errors, ON or OFF.
define install
	@echo "Building the extension (some minutes)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps \
		--config-settings=build-dir=build/extension \
		--config-settings=cmake.define.PALMBOTS_WERROR=$(1) --editable .
endef

help:  ## this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-8s %s\n", $$1, $$2 }' Makefile

carry: $(VENV)/extension.done  ## the main job: carry the paper's box; summary here, picture and log in out/
	$(BIN)/palmbots carry --out out

test: $(VENV)/strict.done lint  ## everything a change must pass
	$(BIN)/python -m pytest --numprocesses auto --dist loadfile

verify: $(VENV)/test.done  ## let the model checker explore the shipped controllers; a table of what holds and what not
	$(BIN)/python verify/explore.py

lint: $(VENV)/test.done
	$(BIN)/ruff check $(PY_FILES)
	$(BIN)/ruff format --check $(PY_FILES)
	$(BIN)/clang-format --dry-run --Werror $(CXX_FILES)
	PYRIGHT_PYTHON_IGNORE_WARNINGS=1 $(BIN)/pyright

format: $(VENV)/test.done  ## put Python and C++ sources into their standard form
	$(BIN)/ruff check --fix $(PY_FILES)
	$(BIN)/ruff format $(PY_FILES)
	$(BIN)/clang-format -i $(CXX_FILES)

fuzz: $(VENV)/test.done  ## libFuzzer on the wire's decoder, on all cores; FUZZ_SECONDS=600
	$(BIN)/python tests/fuzzing.py $(or $(FUZZ_SECONDS),600)

bench: $(VENV)/bench.done $(VENV)/extension.done  ## speed against named peers; CSV in benchmarks/results/
	$(BIN)/python benchmarks/run.py
	$(BIN)/python benchmarks/modes.py
	$(BIN)/python benchmarks/stability.py
	$(BIN)/python benchmarks/wire.py
	$(BIN)/python benchmarks/dynamic.py
	$(BIN)/python benchmarks/curves.py
	$(BIN)/python benchmarks/learn.py

stubs: $(VENV)/extension.done  ## write src/palmbots/_core.pyi anew from the built module
	$(BIN)/python -m nanobind.stubgen -q -m palmbots._core -o src/palmbots/_core.pyi

lock: $(VENV)/test.done  ## write requirements/*.txt anew; LOCK=--upgrade moves to newer versions
	scripts/lock $(LOCK)

clean:  ## forget .venv, build/ and out/
	rm -rf $(VENV) build dist out .pytest_cache .ruff_cache .hypothesis

$(VENV)/carry.done: requirements/carry.txt scripts/setup
	@scripts/setup carry
	@touch $@

$(VENV)/test.done $(VENV)/bench.done: $(VENV)/%.done: requirements/%.txt requirements/carry.txt scripts/setup
	@scripts/setup carry $*
	@touch $(VENV)/carry.done $@

# Only where `make test` has run is a warning an error: elsewhere a newer compiler that warns of
# more must not keep anybody from carrying.
$(VENV)/extension.done: $(EXTENSION) $(VENV)/carry.done
	$(call install,$(if $(wildcard $(VENV)/strict.done),ON,OFF))
	@touch $@

$(VENV)/strict.done: $(EXTENSION) $(VENV)/test.done
	$(call install,ON)
	@touch $(VENV)/extension.done $@

# Targets share .venv and build/.
.NOTPARALLEL:
.DELETE_ON_ERROR:
.PHONY: help carry test verify lint format fuzz bench stubs lock clean

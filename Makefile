# Two commands do everything on a fresh Debian or Ubuntu machine: `make demo` and `make test`.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.ONESHELL:
.DEFAULT_GOAL := help

# the system's Python where it is new enough: `make setup` installs its headers and venv
PYTHON ?= $(shell for p in /usr/bin/python3 python3; do $$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null && echo $$p && break; done)
VENV := .venv
BIN := $(VENV)/bin
SYSTEM_PACKAGES := g++ ccache cmake ninja-build libeigen3-dev libceres-dev libboost-dev nlohmann-json3-dev python3 python3-dev python3-venv
TEST_PACKAGES := doctest-dev cppcheck
CPP_SOURCES := CMakeLists.txt $(shell find cpp cmake -type f)
# One build tree for the Python module, the C++ tests and the benchmarks: each library is compiled once.
BUILD := build/release
# Another clone on this machine compiles only what differs from the last one.
ifneq ($(shell command -v ccache),)
export CMAKE_CXX_COMPILER_LAUNCHER := ccache
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := 1
# A header is compared with its comments: without them ccache returned a precompiled header whose files gcc then read twice.
export CCACHE_DEPEND := 1
export CCACHE_NAMESPACE := brushsvg-depend
export CCACHE_SLOPPINESS := pch_defines,time_macros,include_file_mtime,include_file_ctime
endif
# .ci/run sets this to ON. Elsewhere a newer compiler's new warning must not break `make demo`.
WERROR ?= OFF
PIP_INSTALL := $(BIN)/pip install -q --no-build-isolation -C build-dir=$(BUILD) -C cmake.define.BRUSHSVG_WERROR=$(WERROR) -e

.PHONY: wheel wheel-test wheel-docs sdist deb deb-test cross docs docs-lint plugins help setup system test-system demo test lint format clang-headers clang-check test-variants cpp-test python-test test-wording wording integration thorough test-times integration-system bench bench-compare asan fuzz tsan tidy clean quick FORCE

help:
	@echo "make demo         set up, then paint examples/vincent.svg into demo/"
	@echo "make test         set up, then run the linters and the tests of both languages"
	@echo "make quick        run the fast Python tests, within a minute"
	@echo "make test-wording run the tests with other words in all messages: a test that fails depends on wording"
	@echo "make wording      write tests/golden/wording.txt again, which holds the wording of all messages"
	@echo "make integration  run the longer tests: fits to painted sheets, LinuxCNC, Inkscape, Chromium, pyright (installs them)"
	@echo "make thorough     run every test, also those that .ci/run leaves out, and the C++ tests under sanitizers"
	@echo "make test-times   run the tests and show which tests, fixtures and builds take longest (SUITES='python long integration')"
	@echo "make plugins      the Inkscape extension as a zip for its extension manager, in dist/"
	@echo "make wheel        wheels for x86-64 Linux in dist/, from a compiler of PyPI and Ceres without GPL code (PYTHONS='python3.11 ...')"
	@echo "make wheel-test   install the wheel in a bare system, run the demo and the fast tests there (needs root)"
	@echo "make wheel-docs   write docs/reference/wheels.md again: licenses, auditwheel's report, bill of materials"
	@echo "make sdist        the source as an archive in dist/, which builds without a network"
	@echo "make deb          the C++ library as libbrushsvg-dev, a package for Debian, in dist/"
	@echo "make deb-test     that package in a bare system: programs are compiled against it and run"
	@echo "make cross        the C++ library compiled for aarch64 Linux and Windows"
	@echo "make docs         the documentation as pages to read in a browser, with a search, in docs/_build"
	@echo "make docs-lint    check the language of docs and code: long sentences, words to avoid, the first sentence"
	@echo "make clang-headers  the public headers read by clang and g++ with all warnings as errors"
	@echo "make clang-check  the C++ sources read by clang, as macOS compiles them"
	@echo "make bench        measure our speed and accuracy, and compare them with other programs"
	@echo "make bench-compare REV=main    show what is slower than at a revision; runs both in turn"
	@echo "make test-variants  the tests under the arithmetic of other processors: compilers, maths libraries, vector units"
	@echo "make asan         C++ tests, and Python tests with threads, under address and undefined behaviour sanitizers"
	@echo "make tsan         C++ tests, and Python tests with threads, under the thread sanitizer"
	@echo "make tidy         run clang-tidy on the core, for faults that compilers do not find"
	@echo "make fuzz         run each reader and each computation on random input for 20 s (FUZZ_S=600, ONLY='plan_json dxf')"
	@echo "make format       format both languages"
	@echo "make clean        remove what was built"

# $(call install,PACKAGES): what is missing, with root's rights where we have them
define install
	missing=""
	for p in $(1); do dpkg-query -W -f '$${Status}' $$p 2>/dev/null | grep -q 'ok installed' || missing="$$missing $$p"; done
	if [ -n "$$missing" ]; then
	  run=""
	  if [ "$$(id -u)" != 0 ]; then
	    if sudo -n true 2>/dev/null || { [ -t 0 ] && command -v sudo >/dev/null; }; then run=sudo; else
	      echo "these packages are needed: run, as root,  apt-get install --no-install-recommends$$missing" >&2; exit 1; fi
	  fi
	  $$run apt-get update -q
	  DEBIAN_FRONTEND=noninteractive $$run apt-get install -y -q --no-install-recommends $$missing
	fi
endef

system:
	@command -v dpkg-query >/dev/null || { echo "not a Debian or Ubuntu system: see README.md for what to install" >&2; exit 0; }
	$(call install,$(SYSTEM_PACKAGES))

setup: system
	@$(MAKE) --no-print-directory $(VENV)/.installed

$(VENV)/.created:
	@test -n "$(PYTHON)" || { echo "Python 3.11 or later is needed" >&2; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install -q --upgrade pip
	$(BIN)/pip install -q "scikit-build-core>=1.0" "pybind11>=3.0"
	touch $@

# which modules there are: an editable install knows those that it found, and not those of a later checkout
$(VENV)/.modules: $(VENV)/.created FORCE
	@find python -name '*.py' | sort > $@.now
	if cmp -s $@.now $@; then rm $@.now; else mv $@.now $@; fi

$(VENV)/.installed: $(VENV)/.created $(VENV)/.modules pyproject.toml $(CPP_SOURCES)
	@echo "building (a few minutes the first time)"
	$(PIP_INSTALL) ".[text,plot,arm]"
	touch $@

$(VENV)/.dev: $(VENV)/.installed pyproject.toml
	@$(PIP_INSTALL) ".[dev]"
	touch $@

demo: setup
	@$(BIN)/python examples/demo.py examples/vincent.svg demo

test-system:
	@$(call install,$(TEST_PACKAGES))

test: setup test-system
	@$(MAKE) --no-print-directory $(VENV)/.dev
	$(MAKE) --no-print-directory lint cpp-test python-test

lint: $(VENV)/.dev test-system
	@$(BIN)/ruff check .
	$(BIN)/bandit -q -ll -r -c pyproject.toml python
	$(BIN)/ruff format --check -q .
	$(BIN)/clang-format --dry-run --Werror $$(git ls-files '*.cpp' '*.hpp')
	cppcheck -q --std=c++17 --language=c++ --enable=warning,performance,portability --inline-suppr --error-exitcode=1 --suppress=missingIncludeSystem -I cpp/include -I cpp/io -I cpp/posts cpp examples benchmarks

INCLUDES := $(patsubst %,-Icpp/%,include io posts fit/laws fit/marks refine) -Icpp -isystem /usr/include/eigen3

clang-headers: setup
	@$(call install,clang)
	# public headers as a consumer with strict warnings reads them, by both compilers
	for compiler in clang++ g++; do
	  { for header in cpp/include/brushsvg/*.hpp cpp/io/{brush,plan,marks}_json.hpp cpp/posts/linuxcnc.hpp cpp/fit/*/{law_fit,angles,mark_fit}.hpp cpp/refine/refine.hpp; do
	      if [ -e "$$header" ]; then echo "#include \"$$PWD/$$header\""; fi; done; } | \
	    $$compiler -x c++ -std=c++17 -fsyntax-only -Wall -Wextra -Wconversion -Wsign-conversion -Werror $(INCLUDES) -
	done
	# the sources as a part of a consumer's project: no flag that clang does not know
	rm -rf build/clang-consumer && mkdir -p build/clang-consumer/source
	{ echo 'cmake_minimum_required(VERSION 3.25)'; echo 'project(consumer CXX)'; echo "add_subdirectory($$PWD brushsvg)"; } >build/clang-consumer/source/CMakeLists.txt
	cmake -S build/clang-consumer/source -B build/clang-consumer/build -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_CXX_FLAGS=-Werror >/dev/null
	cmake --build build/clang-consumer/build --target brushsvg/CMakeFiles/brushsvg_core.dir/cpp/model/brush_law.cpp.o >/dev/null

# Read by clang, which refuses what g++ lets pass (clang 14: captured structured bindings); nothing is compiled or run.
clang-check: clang-headers $(VENV)/.dev
	@git ls-files 'cpp/*.cpp' | xargs -P "$$(nproc)" -n 1 clang++ -std=c++17 -fsyntax-only -Wall -Wextra -Werror \
	  -Wno-missing-field-initializers -DBRUSHSVG_FIT '-DBRUSHSVG_VERSION="0"' $(INCLUDES) $$($(BIN)/python -m pybind11 --includes)

format: $(VENV)/.dev
	@$(BIN)/ruff check --fix -q .
	$(BIN)/ruff format -q .
	$(BIN)/clang-format -i $$(git ls-files '*.cpp' '*.hpp')

cpp-test: setup test-system
	@cmake --preset release -DBRUSHSVG_WERROR=$(WERROR) >/dev/null
	cmake --build --preset release
	ctest --preset release

# The C++ tests, and the Python tests in which threads meet: several drawings at a time, and what is given up half way.
THREADED_TESTS := tests/python/test_batch.py tests/python/test_conversion.py tests/python/test_fit_interrupted.py \
  tests/python/test_refine.py tests/python/test_size_advice.py tests/python/test_threads.py
asan tsan: setup test-system
	@$(MAKE) --no-print-directory $(VENV)/.dev
	cmake --preset $@ -DBRUSHSVG_PYTHON=ON -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python \
	  -Dpybind11_DIR=$$($(BIN)/python -m pybind11 --cmakedir) >/dev/null
	cmake --build --preset $@ --target brushsvg_tests _core
	ctest --preset $@ -R '^cpp$$'
	$(BIN)/python tests/sanitized.py $@ -q -m 'not long' $(THREADED_TESTS)

# Faults that no compiler sees: the checks of .clang-tidy.
tidy: setup test-system
	@$(PIP_INSTALL) ".[analysis]"
	cmake --preset release >/dev/null
	git ls-files 'cpp/*.cpp' ':!cpp/bindings' | xargs -P $$(nproc) -n 4 $(BIN)/clang-tidy -p build/release --quiet

# FUZZ_S: seconds for each target. ONLY: names of targets, or how they begin. SLOWEST_S: an input that takes longer is a
# finding. Inputs that reach new code, and findings, stay in build/fuzz-kept for the next run.
FUZZ_S ?= 20
SLOWEST_S ?= 10
ONLY ?=
fuzz: setup
	@$(call install,clang llvm)
	# the package that holds clang's sanitizers and fuzzer is named after its version
	runtime=libclang-rt-$$(clang++ -dumpversion | cut -d. -f1)-dev
	if apt-cache show $$runtime >/dev/null 2>&1; then
	$(call install,$$runtime)
	fi
	$(BIN)/python -c 'import atheris' 2>/dev/null || $(PIP_INSTALL) ".[fuzz]" || \
	  echo "Atheris cannot be installed: the Python targets change their seeds at random" >&2
	cmake --preset fuzz >/dev/null
	cmake --build --preset fuzz --target fuzz_targets
	$(BIN)/python tests/fuzz/run.py --seconds $(FUZZ_S) --slowest $(SLOWEST_S) $(ONLY)

# One worker per processor; a worker that runs out of tests takes some from another.
PYTEST := $(BIN)/python -m pytest -n auto --dist worksteal
# What each suite runs in .ci/run. `make thorough` runs the same suites without "not thorough".
PYTHON_TESTS := tests/python tests/laws tests/journeys
NOT_THOROUGH := and not thorough

python-test: $(VENV)/.dev
	@$(PYTEST) -m 'not long $(NOT_THOROUGH)' $(PYTHON_TESTS)

quick: $(VENV)/.dev
	@$(BIN)/ruff check -q .
	$(PYTEST) -m 'not slow $(NOT_THOROUGH)' tests/python

# VARIANTS: options of the script, such as VARIANTS='--variant v3-fma --suite cpp'
VARIANTS ?=
test-variants: setup test-system
	@$(MAKE) --no-print-directory $(VENV)/.dev
	$(BIN)/python tools/test_variants.py $(VARIANTS)

# The tests of both languages with other words in every sentence: what fails here and not in `make test` depends on wording.
REWORDED := build/reworded
test-wording: setup test-system
	@$(MAKE) --no-print-directory $(VENV)/.dev
	$(BIN)/python tests/rewording/reword_cpp.py $(REWORDED)
	cmake -S $(REWORDED) -B $(REWORDED)/out -G Ninja -DCMAKE_BUILD_TYPE=Release -DBRUSHSVG_TESTS=ON -DBRUSHSVG_PYTHON=ON \
	  -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python -Dpybind11_DIR=$$($(BIN)/python -m pybind11 --cmakedir) >/dev/null
	cmake --build $(REWORDED)/out --target brushsvg_tests _core
	$(REWORDED)/out/tests/cpp/brushsvg_tests
	PYTHONPATH=tests/rewording $(PYTEST) -rf -m 'not long and not wording $(NOT_THOROUGH)' $(PYTHON_TESTS)

wording: $(VENV)/.dev
	@$(BIN)/python tests/python/test_wording.py

integration-system: setup
	@$(MAKE) --no-print-directory $(VENV)/.dev
	$(call install,$(shell cat tests/integration/apt-packages.txt))
	if ! command -v npm >/dev/null; then
	$(call install,nodejs npm)
	fi
	$(BIN)/pip install -q -r tests/integration/requirements.txt

integration: integration-system
	@$(PYTEST) -m 'long $(NOT_THOROUGH)' tests/laws
	$(PYTEST) -rs -m 'not long $(NOT_THOROUGH)' tests/integration

thorough: test-system integration-system
	@$(MAKE) --no-print-directory lint cpp-test asan clang-check
	$(MAKE) --no-print-directory python-test integration NOT_THOROUGH=

# The same suites with each test's cost recorded, then the table.
SUITES ?= python long integration
test-times: test-system integration-system
	@$(BIN)/python tools/test_times.py run $(SUITES)

bench: setup
	@$(MAKE) --no-print-directory $(VENV)/.dev
	cmake --preset release >/dev/null
	cmake --build --preset release --target advance_bench
	$(BIN)/python benchmarks/table.py $(TABLE)
	build/release/benchmarks/advance_bench
	$(BIN)/python benchmarks/marks.py
	$(BIN)/python benchmarks/page.py
	$(BIN)/python benchmarks/read.py
	$(BIN)/python benchmarks/article_tables.py
	font=/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf  # of `make integration`
	if [ -f $$font ]; then $(BIN)/pip install -q -e '.[bench]' --no-build-isolation; $(BIN)/python benchmarks/outlines.py $$font; fi
	$(BIN)/python benchmarks/preview.py

# Run the same script on both trees. The tree of REV is built next to ours and kept, so that the next run is quick.
# TABLE: more arguments of the script, such as TABLE='--rounds 1 --only word'.
TABLE ?=
bench-compare: setup
	@: "$${REV:?which revision? make bench-compare REV=main}"
	$(MAKE) --no-print-directory $(VENV)/.dev
	that="build/compare/$$(git rev-parse --short --verify "$$REV^{commit}")"
	git worktree prune
	[ -e "$$that" ] || git worktree add -q --detach "$$that" "$$REV"
	$(MAKE) --no-print-directory -C "$$that" setup
	for tree in . "$$that"; do
	  (cd "$$tree"; cmake --preset release >/dev/null; cmake --build --preset release --target advance_bench)
	done
	$(BIN)/python benchmarks/table.py --against "$$that" $(TABLE)

# Short sentences, modern words, a first sentence that says who a page is for. tools/banned_words.txt has the words.
docs-lint:
	@$(PYTHON) tools/docs_lint.py
	$(PYTHON) tools/words_lint.py

docs: setup
	@$(PIP_INSTALL) ".[docs]"
	$(BIN)/python -m sphinx -q -W -b html docs docs/_build
	echo "open docs/_build/index.html"

# Interpreters with headers, a wheel for each; JOBS: at most so many compilers at once.
PYTHONS ?= $(PYTHON)
DEB = $(firstword $(wildcard dist/libbrushsvg-dev_*.deb))
WHEEL = $(firstword $(wildcard dist/brushsvg-*-cp311-*manylinux*.whl))

wheel: system
	@$(PYTHON) tools/wheel/build.py $(PYTHONS:%=--python %)

wheel-test:
	@test -n "$(WHEEL)" || { echo "there is no wheel in dist/: run  make wheel" >&2; exit 1; }
	$(call install,mmdebstrap)
	PYTHON=$(PYTHON) tools/wheel/bare_root.sh $(WHEEL)

wheel-docs:
	@test -n "$(WHEEL)" || { echo "there is no wheel in dist/: run  make wheel" >&2; exit 1; }
	$(PYTHON) tools/wheel/contents.py page $(WHEEL) build/wheel/cp311/auditwheel.txt docs/reference/wheels.md

sdist: $(VENV)/.created
	@mkdir -p dist
	$(BIN)/python -c 'from scikit_build_core import build; print("dist/" + build.build_sdist("dist"))'

deb: system
	@$(call install,dpkg-dev debhelper lintian)
	tools/build_deb.sh

deb-test:
	@test -n "$(DEB)" || { echo "there is no package in dist/: run  make deb" >&2; exit 1; }
	$(call install,mmdebstrap)
	tools/deb_bare_root.sh $(DEB)

cross: system
	@PYTHON=$(PYTHON) tools/cross_compile.sh

plugins:
	@mkdir -p dist
	$(PYTHON) tools/zip_plugin.py plugins/inkscape dist/brushsvg-inkscape.zip

clean:
	@rm -rf build demo docs/_build docs/reference/{commands,python,cells}.md $(VENV)

# `make demo` needs only Rust and Python (.ci/manifest.toml states the oldest); the workbench's page needs Node.js besides. CI runs
# `make test`.
#
# The tests run a development build of the extension, which shares all that it compiles with the Rust tests and checks its own
# assertions, so that nothing is compiled twice; `make optimised` and `pip install .` build what users get.

PYTHON ?= python3
VENV ?= .venv
ifeq ($(OS),Windows_NT)
BIN := $(VENV)/Scripts
EXE := .exe
else
BIN := $(VENV)/bin
EXE :=
endif
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet

# Profile of a first build.
PROFILE ?= dev
optimised: PROFILE = release

SOURCES := pyproject.toml Cargo.toml $(shell find crates -name '*.rs' -o -name Cargo.toml -o -name '*.sdl')

PAGE := python/moldloft/workbench/page/index.html
PAGE_SOURCES := web/package-lock.json web/vite.config.js web/index.html $(wildcard web/src/*) python/moldloft/colours.json python/moldloft/workbench/usual.json
# Without Node.js everything but the workbench is there.
WEB := $(if $(shell command -v npm 2>/dev/null),$(PAGE),)

ENGINE := python/moldloft/workbench/wasm/engine.wasm.xz
# `demo` makes one without optimisation, a quarter of the work: the same bits, for tests.
ENGINE_PROFILE ?= engine
WASM := wasm32-unknown-unknown

.PHONY: setup demo optimised web engine living quick test check bits stubs site release soak changes fuzz clean help

help: ## this list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## /\1\t/'

setup: $(VENV)/.with-tests $(VENV)/.with-browser ## .venv with the package and everything that the tests need

# An older one finds no package in the locked requirements, and pip's words do not say why.
OLDEST_PYTHON := $(shell sed -n 's/^python = "\(.*\)"/\1/p' .ci/manifest.toml)
OLD_PYTHON = import sys; oldest = '$(OLDEST_PYTHON)'; sys.version_info >= tuple(map(int, oldest.split('.'))) or sys.exit( \
	'%s: expected Python %s or newer, found %s; another one: make PYTHON=python%s VENV=.venv%s' \
	% (sys.executable, oldest, sys.version.split()[0], oldest, oldest))

# The virtual environment with the package of this checkout: as the tests need it or, for a first look, without any optimisation,
# which takes a quarter of the time to build.
define INSTALL
@$$(test -x $(BIN)/python && echo $(BIN)/python || echo $(PYTHON)) -c "$(OLD_PYTHON)"
@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
@echo "building and installing moldloft into $(VENV) (a first build takes a few minutes)"
@$(PIP) install --require-hashes --requirement requirements/build.txt
@PATH="$$PWD/$(BIN):$$PATH" MATURIN_PEP517_ARGS="--profile $(PROFILE)" $(PIP) install --no-build-isolation --editable .
@touch $@
endef

$(VENV)/.installed: $(SOURCES)
	$(INSTALL)

$(VENV)/.for-demo: PROFILE = demo
$(VENV)/.for-demo: $(SOURCES)
	$(INSTALL)

$(VENV)/.with-tests: $(VENV)/.installed requirements/test.txt $(WEB)
	@echo "installing the packages that the tests need into $(VENV)"
	@$(PIP) install --require-hashes --requirement requirements/test.txt
	@touch $@

web: $(PAGE) ## the page of the workbench; needs Node.js

NODE_MODULES := web/node_modules/.package-lock.json

$(NODE_MODULES): web/package-lock.json
	@command -v npm >/dev/null || { echo "the page of the workbench needs Node.js 20 or newer and npm"; exit 1; }
	@cd web && npm ci --no-audit --no-fund --loglevel=error
	@touch $@

$(PAGE): $(PAGE_SOURCES) $(NODE_MODULES)
	@echo "building the page of the workbench"
	@cd web && npm run --silent build
	@touch $@

# The engine for pages that compute by themselves; optimised by itself, it takes as long as the rest of the house.
engine: ## the engine for `export --html`; needs the target wasm32-unknown-unknown
	@test -d "$$(rustc --print sysroot)/lib/rustlib/$(WASM)" || { \
		echo "the engine for pages needs the target $(WASM): rustup target add $(WASM)"; exit 1; }
	@echo "building the engine for pages (it takes a while)"
	@cargo build --quiet --profile $(ENGINE_PROFILE) --target $(WASM) -p moldloft-wasm
	@$(PYTHON) tools/pack_engine.py $${CARGO_TARGET_DIR:-target}/$(WASM)/$(ENGINE_PROFILE)/moldloft_engine.wasm $(ENGINE)

living: $(VENV)/.with-tests $(VENV)/.with-browser ## the tests of the engine for pages and of pages with it
	@$(BIN)/python -m pytest tests/python/workbench/test_engine_in_page.py tests/python/workbench/test_workbench_page.py tests/python/workbench/test_vscode_page.py

# What the tests of the page need, where it can be had: a browser that runs without a display.
$(VENV)/.with-browser:
	@if ! command -v chromium >/dev/null && command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then \
		echo "installing chromium for the tests of the page"; \
		(apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium) >/dev/null \
			|| echo "chromium could not be installed: the tests of the page are left out"; \
	fi
	@touch $@

# Where a package was built for the tests or for users, that one is used and kept.
demo: $(or $(wildcard $(VENV)/.installed),$(VENV)/.for-demo) ## the sailing yacht of examples/sailboat as panels, files, hydrostatics and a picture
	@$(BIN)/moldloft build examples/sailboat/hull.sdl --to gdf stl obj vtp vts p3d svg png -o out/sailboat
	@test -e $(VENV)/.installed || echo "this build of the package is not optimised: \`make optimised\` builds the one that users get"

optimised: ## rebuilds the package in .venv as users get it, for benchmarks
	@rm -f $(VENV)/.installed
	@$(MAKE) --no-print-directory PROFILE=release $(VENV)/.installed

# 339 tests of each part of the package, 100 s of processor time: without browsers, builds, solvers and random campaigns.
QUICK := shapes/test_api.py shapes/test_contours.py house/test_docstrings.py language/test_errors.py formats/test_formats.py language/test_model_files.py \
	hydro/test_offsets.py shapes/test_panels.py shapes/test_parts.py shapes/test_searches.py house/test_types.py language/test_usage_mistakes.py

quick: $(VENV)/.with-tests ## format, lints and some tests, two minutes; CRATE=name adds the tests of a crate
	@cargo fmt --all --check
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --quiet --check
	@$(BIN)/python -m pytest --quiet --numprocesses auto $(QUICK:%=tests/python/%)
	@$(if $(CRATE),cargo test --quiet -p moldloft-$(CRATE))

test: setup check ## every check and test
	@$(BIN)/python -m pytest --numprocesses auto --dist worksteal

check: setup $(if $(WEB),$(NODE_MODULES)) ## formatting, lints, links of the documentation, types, the Rust tests and those of the page's parts
	@cargo fmt --all --check
	@cargo clippy --quiet --workspace --all-targets -- -D warnings
	@RUSTDOCFLAGS="-D warnings" cargo doc --quiet --workspace --no-deps
	@cargo test --quiet --workspace --exclude moldloft-py --no-fail-fast
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --quiet --check
	@$(BIN)/mypy --no-error-summary
	@$(if $(WEB),cd web && npm run --silent check,echo "without Node.js the page is not checked")

stubs: $(VENV)/.installed ## rewrites the stubs from the declarations
	@$(BIN)/python -m moldloft.stubs

site: $(VENV)/.with-tests ## the documentation with living models, in out/site
	@MOLDLOFT_LIVING=1 NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict

release: ## wheel with language server and page, sdist, notices, bill of materials; in dist/
	@$(PYTHON) tools/release.py

bits: ## rewrites tests/bits.txt after a change of results
	@cargo run --quiet -p moldloft --example bits > tests/bits.txt

soak: export MOLDLOFT_SOAK = 1
soak: test ## the long random tests in full

changes: ## additions of tests/changes and changed arguments of 50 rows, each in one build of this clean tree, by all faces
	@$(PYTHON) tools/changes.py
	@$(PYTHON) tools/renames.py

fuzz: $(VENV)/.with-tests ## coverage-guided fuzzing, SECONDS (600) for each target; needs a C++ compiler
	@$(BIN)/python tools/fuzz.py --seconds $(or $(SECONDS),600)

clean: ## removes what was built
	rm -rf $(VENV) out dist target web/node_modules python/moldloft/workbench/page python/moldloft/workbench/wasm

# `make demo` and `make test` need only Rust and Python >= 3.10. CI runs `make test`.

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

SOURCES := pyproject.toml Cargo.toml $(shell find crates -name '*.rs' -o -name Cargo.toml -o -name '*.sdl')

# The packages of the extra `test` by name: `pip install '.[test]'` would build the extension once more.
define TEST_PACKAGES
from importlib.metadata import requires
for line in requires("moldloft"):
    if 'extra == "test"' in line.replace("'", '"'):
        print(line.split(";")[0])
endef
export TEST_PACKAGES

.PHONY: setup demo test check reference soak clean help

help: ## this list
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## /\1\t/'

setup: $(VENV)/.with-tests ## .venv with the package and everything that the tests need

# The virtual environment, with the package built from this checkout.
$(VENV)/.installed: $(SOURCES)
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@echo "building and installing moldloft into $(VENV) (a first build takes a few minutes)"
	@$(PIP) install --editable .
	@touch $@

$(VENV)/.with-tests: $(VENV)/.installed pyproject.toml
	@echo "installing the packages that the tests need into $(VENV)"
	@$(BIN)/python -c "$$TEST_PACKAGES" > $(VENV)/test-packages.txt
	@$(PIP) install --requirement $(VENV)/test-packages.txt
	@echo "building the language server"
	@cargo build --quiet --release -p moldloft-lsp
	@cp $${CARGO_TARGET_DIR:-target}/release/moldloft-lsp$(EXE) $(BIN)/
	@touch $@

demo: $(VENV)/.installed ## the sailing yacht of examples/sailboat as panels, files, hydrostatics and a picture
	@$(BIN)/moldloft build examples/sailboat/hull.sdl --to gdf stl obj vtp vts p3d svg png -o out/sailboat

test: setup check ## every check and test
	@$(BIN)/python -m pytest

check: setup ## formatting, lints, types and the Rust tests
	@cargo fmt --all --check
	@cargo clippy --quiet --workspace --all-targets -- -D warnings
	@cargo test --quiet --workspace --exclude moldloft-py
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --quiet --check
	@$(BIN)/mypy --no-error-summary

reference: $(VENV)/.installed ## docs/reference.md anew from the declarations
	@$(BIN)/moldloft doc --markdown > docs/reference.md
	@$(BIN)/moldloft doc --pictures docs/kinds

soak: export MOLDLOFT_SOAK = 1
soak: test ## the long random tests in full

clean: ## removes what was built
	rm -rf $(VENV) out target

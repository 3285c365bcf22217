# Everything a newcomer needs: Python 3.11 or 3.12 and make. The rest is fetched into this folder.
#
#   make demo    a recorded face drives all four characters; results in out/demo
#   make test    the tests
#   make check   style, types, layers
#   make studio  the browser's side of 'mien studio' (needs Node)
#   make docs    this documentation as a site, in out/site
#   make papers  the papers' figures, made again (minutes)
#   make clean   remove what make made

.DEFAULT_GOAL := demo
.PHONY: env demo test check format studio docs papers docs-env clean

export UV_PYTHON_DOWNLOADS := never
export UV_PROJECT_ENVIRONMENT := .venv
export MIEN_WITHOUT_PAGE := 1
UV_VERSION := 0.13.9
UV := .boot/bin/uv
BIN := .venv/bin
EXTRAS := --extra landmarks --extra scan --extra studio --extra batch --extra draco

# The first that runs: a name on PATH may be a shim for a version that is not installed.
PYTHON ?= $(shell for p in python3.12 python3.11 python3 python; do \
	$$p -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 13))' 2>/dev/null \
	&& echo $$p && break; done)

$(UV):
	@test -n "$(PYTHON)" || { echo "mien needs Python 3.11 or 3.12: install one, or name it: make PYTHON=/path/to/python3.12"; exit 1; }
	@$(PYTHON) -m venv .boot || { rm -rf .boot; echo "$(PYTHON) cannot make environments: on Debian, apt install python3-venv"; exit 1; }
	@.boot/bin/python -m pip install --quiet --disable-pip-version-check uv==$(UV_VERSION)

# The lock names every package; the environment is as old as the newer of lock and project file.
.venv/.synced: $(UV) uv.lock pyproject.toml
	@echo "setting up the environment: a minute, a gigabyte"; begin=$$(date +%s); \
	$(UV) sync --quiet --frozen $(EXTRAS) --compile-bytecode --python $(or $(PYTHON),3) && \
	touch $@ && \
	echo "environment ready in $$(( $$(date +%s) - begin )) s"

env: .venv/.synced

demo: env
	@begin=$$(date +%s); \
	$(BIN)/mien demo -o out/demo && \
	echo "demo done in $$(( $$(date +%s) - begin )) s"

# One test a core: threads of the mathematics would only wait for each other.
test: env
	@OPENBLAS_NUM_THREADS=1 $(BIN)/pytest -n auto --dist worksteal

check: env
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check --quiet .
	@$(BIN)/mypy
	@told=$$($(BIN)/lint-imports --no-logo --no-cache) || { echo "$$told"; exit 1; }

# The page that 'mien studio' serves; the only thing here that needs Node.
studio: env
	@cd studio && npm ci --no-audit --no-fund --silent && \
	../$(BIN)/python -m mien.live.studio.messages > src/messages.ts && npm run --silent build

# The site: links that lead nowhere fail, and nothing in it is fetched from elsewhere when it is read.
docs: docs-env
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

papers: docs-env
	@$(BIN)/python docs/reproduce.py

docs-env: env
	@$(UV) sync --quiet --frozen --inexact $(EXTRAS) --group docs --python $(or $(PYTHON),3)

format: env
	@$(BIN)/ruff check --fix --quiet .
	@$(BIN)/ruff format --quiet .

clean:
	rm -rf .boot .venv .tools out .pytest_cache .ruff_cache .mypy_cache .hypothesis .import_linter_cache

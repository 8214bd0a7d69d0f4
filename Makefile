# make: set up · make report: set up and run the main job · make test: set up and pass the tests · make bench, stress, lint
VENV := .venv
PY := $(VENV)/bin/python
STAMP := $(VENV)/.installed
# 3.11 first: above it pybullet has no wheels, and its engine and tests are left out.
PYTHON ?= $(shell for p in python3.11 python3.12 python3.13 python3.14 python3 python; do \
	if $$p -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' >/dev/null 2>&1; then command -v $$p; break; fi; done)

COMPILE_PLANE = $(PY) -c "import analytic as a; a.simulate(a.Block.rectangle(width_m=0.2, height_m=1.0), a.ZeroExcitation(), duration_s=0.01)"
COMPILE_SPACE = $(PY) -c "from analytic import spatial as s; s.simulate(s.Body.block(100.0, 0.4, 0.3, 1.2), duration_s=0.01, friction_static=0.5)"

# Whatever the environment says: without bytecode every process, hundreds in the tests, compiles anew what it imports.
export PYTHONDONTWRITEBYTECODE :=

.DEFAULT_GOAL := setup
.PHONY: help setup report test fast wheel lowest lint docs types contracts bench stress lock clean

help: ## list the targets
	@grep -hE '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | column -t -s "$$(printf '\t')"

setup: $(STAMP) ## create the environment in .venv from the lock file (plain make does this)
	@echo "ready: $(VENV)/bin/rockcheck (make help lists what else there is)"

$(STAMP): requirements.lock pyproject.toml
	@if [ -z "$(PYTHON)" ]; then \
		echo "rockcheck needs CPython 3.11 to 3.14 (pybullet only has wheels for 3.11): install it, or name it with make PYTHON=/path/to/python3.11" >&2; \
		exit 1; fi
	@echo "setting up $(VENV) with $(PYTHON)"
	@$(PYTHON) -m venv --clear $(VENV) || { \
		echo "rockcheck needs Python's venv module (on Debian: apt-get install python3.11-venv)" >&2; exit 1; }
	@$(PY) -m pip install --quiet --disable-pip-version-check --prefer-binary --only-binary pybullet -r requirements.lock
	@$(PY) -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	@# Compiled once here, not in whatever runs first.
	@$(COMPILE_PLANE) & plane=$$!; $(COMPILE_SPACE) && wait $$plane
	@touch $@

report: $(STAMP) ## run the main job and say where the report is
	@$(PY) -m reports.build_examples

test: $(STAMP) ## pass the tests
	@# Compiled once here, not once in each of the processes below.
	@$(COMPILE_PLANE) & plane=$$!; $(COMPILE_SPACE) && wait $$plane
	@# Half as many processes again as cores: browsers, kills and limits are waited for, a sixth of the time.
	@$(PY) -m pytest -q -n $$($(PY) -c "import os; print((os.cpu_count() or 1) * 3 // 2)") --dist worksteal -m "not measures"

fast: $(STAMP) ## pass the fast tests: no engine runs but single steps, under a minute
	@$(PY) -m pytest -q -m fast $$(cat tests/fast.txt)

wheel: $(STAMP) ## build the wheel, install it in a fresh environment (of a newer Python where there is one), run the main job from it
	@.ci/wheel $(VENV)

lowest: $(STAMP) ## install the lowest versions that pyproject.toml allows in an environment of their own, run a scene with three engines
	@.ci/lowest $(VENV)

lint: $(STAMP) ## check style, types and import rules
	@$(VENV)/bin/ruff check .
	@$(VENV)/bin/ruff format --check .
	@$(VENV)/bin/mypy
	@$(VENV)/bin/lint-imports

docs: $(STAMP) ## write the API reference from the docstrings, without a network
	@$(PY) -m pdoc --output-directory out/api analytic analytic.closed_form analytic.pulse_response meshes harness
	@echo "API reference: out/api/index.html"

bench: $(STAMP) ## run time against error, in one run
	@$(VENV)/bin/rockcheck bench
	@$(PY) -m tests.measures.other_integrators
	@$(PY) -m tests.measures.engine_defaults
	-@$(VENV)/bin/python -m tests.measures.goals
	@$(VENV)/bin/python -m tests.measures.scoring
	@$(VENV)/bin/python -m tests.measures.calibration

stress: $(STAMP) ## hard scenes and mutated input
	@$(VENV)/bin/rockcheck stress
	@$(PY) -m tests.measures.invariance_checks
	@$(PY) -m tests.fuzz

lock: ## renew requirements.lock from pyproject.toml
	@$(PY) -m pip install --quiet uv
	@$(VENV)/bin/uv pip compile --quiet pyproject.toml --all-extras --python-version 3.11 --universal \
		--no-emit-index-url --no-header -o requirements.lock

clean: ## remove the environment and all output
	rm -rf $(VENV) out

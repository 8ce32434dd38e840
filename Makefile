# Everything needs only make and python3.11+ with venv; a stamp file per set of packages avoids installing twice.

PYTHON ?= python3
BIN := .venv/bin

PLUGINS := $(wildcard plugins/*)
# Two processes have half of the tests each; the first that is done takes half of what the other has left. A test that
# hangs ends its process, and the other goes on and names it.
PYTEST := $(BIN)/pytest -n 2 --dist worksteal --timeout-method thread
# Files in which tests need plug-ins, or PyVista as another reader of fields, and files in which they need DOLFINx.
WITH_PLUGINS := tests/unit/core/run/test_resumption.py tests/unit/core/run/test_shared_run.py tests/unit/benchmarks
WITH_DOLFINX := tests/contract/test_fluid_backends.py tests/unit/backends/test_dolfinx.py \
	tests/unit/benchmarks/test_backends_benchmark.py tests/unit/benchmarks/test_parallel_benchmark.py tests/mpi

.PHONY: run test test-long test-plugins test-dolfinx install lint docs validate stale bench clean

run: install
	$(BIN)/rigidfluid run scenes/falling_disk.toml

install: .venv/.installed

test: .venv/.installed-test
	$(PYTEST) --timeout 300 --durations 40

test-long: .venv/.installed-test
	$(PYTEST) --timeout 1800 --durations 40 -m 'long and not validation'

test-plugins: .venv/.installed-plugins
	for plugin in $(PLUGINS); do (cd $$plugin && $(CURDIR)/$(BIN)/python -m pytest --timeout 600) || exit 1; done
	$(PYTEST) --timeout 600 -m 'not validation' $(WITH_PLUGINS)

# In Debian 13's packages, in a folder; see tools/dolfinx.
test-dolfinx:
	tools/dolfinx make
	tools/dolfinx run python3 -m pytest -m 'not validation' $(WITH_DOLFINX)

# The documentation site, in site/; a warning, as of a link that leads nowhere, ends it.
docs: .venv/.installed-docs
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs site

validate: .venv/.installed-plugins
	$(BIN)/pytest -m validation
	cd plugins/rigidfluid-lammps && $(CURDIR)/$(BIN)/python -m pytest -m validation
	$(BIN)/python docs/make_validation.py

stale: .venv/.installed
	$(BIN)/python docs/make_validation.py --stale

lint: .venv/.installed-dev
	$(BIN)/ruff check
	$(BIN)/mypy

bench: .venv/.installed-bench .venv/.installed-plugins
	$(BIN)/python benchmarks/step.py --page docs/validation/step.md
	$(BIN)/python benchmarks/backends.py --page docs/validation/backends.md
	$(BIN)/python benchmarks/work_precision.py --page docs/validation/work_precision.md
	$(BIN)/python benchmarks/dry_spheres.py

clean:
	rm -rf .venv .dolfinx site

# A stamp, since a venv that could not be finished leaves its python behind.
.venv/.created:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "rigidfluid needs Python 3.11 or newer")'
	$(PYTHON) -m venv .venv
	touch $@

.venv/.installed: pyproject.toml | .venv/.created
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

.venv/.installed-plugins: $(PLUGINS:%=%/pyproject.toml) | .venv/.installed-test
	$(BIN)/python -m pip install --quiet --editable . 'pyvista>=0.44' $(PLUGINS:%=--editable %)
	touch $@

.venv/.installed-%: pyproject.toml | .venv/.created
	$(BIN)/python -m pip install --quiet --editable '.[$*]'
	touch $@

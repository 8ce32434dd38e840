# Everything needs only make and python3.11+ with venv; a stamp file per set of packages avoids installing twice.

PYTHON ?= python3
BIN := .venv/bin

PLUGINS := $(wildcard plugins/*)
# Two processes have half of the tests each; the first that is done takes half of what the other has left. A test that
# hangs ends its process, and the other goes on and names it.
PARALLEL := -n 2 --dist worksteal --timeout-method thread
PYTEST := $(BIN)/pytest $(PARALLEL)
# Files in which tests need plug-ins, PyVista or notebooks; files and contracts in which they need DOLFINx; and those that
# start processes of MPI, one after another.
WITH_PLUGINS := tests/unit/core/run/test_resumption.py tests/unit/core/run/test_shared_run.py tests/unit/benchmarks \
	tests/unit/docs/test_validation_pages.py tests/unit/core/output/test_fluid_fields.py tests/unit/post/test_run_results.py \
	tests/unit/post/test_notebook.py tests/unit/docs/test_site_code.py::test_how_to_pages_run
WITH_DOLFINX := $(addprefix tests/contract/test_fluid_backends.py::,TestDolfinx TestDolfinxBySchurComplement) \
	tests/unit/backends/test_dolfinx.py tests/unit/benchmarks/test_backends_benchmark.py
WITH_MPI := tests/unit/benchmarks/test_parallel_benchmark.py tests/mpi

# Each package that rigidfluid itself names is called somewhere here.
WITH_LOWEST := $(addprefix tests/unit/,test_cli.py test_registry.py core/case core/scene core/output core/mesh/test_remesh.py \
	domains/test_cad.py domains/test_mesh_domain.py marching/test_marching.py taylor_hood/test_factorization.py post/reports \
	post/studies/test_random_samples.py) \
	tests/contract/test_bodies.py tests/contract/test_force_laws.py

.PHONY: run fast test test-wheel test-lowest test-long test-nightly test-plugins test-dolfinx install lint docs mutants pages validate nightly stale bench lock clean

run: install
	$(BIN)/rigidfluid run scenes/falling_disk.toml

install: .venv/.installed

# MKL's solver too, of 1 GB, by which flows in the plane take about half the time.
fast: .venv/.installed-fast

test: .venv/.installed-test
	$(PYTEST) --timeout 300 --durations 40

# Numba keeps one version's code of a file, so this one keeps its own elsewhere.
test-lowest: .venv-lowest/.installed
	NUMBA_CACHE_DIR=$(CURDIR)/.venv-lowest/numba .venv-lowest/bin/pytest $(PARALLEL) --timeout 300 $(WITH_LOWEST)

# What would be published, a wheel made from the sdist, alone in an environment: no file of this folder is in reach.
test-wheel:
	rm -rf dist .venv-build .venv-wheel
	$(PYTHON) -m venv .venv-build
	.venv-build/bin/python -m pip install --quiet build
	.venv-build/bin/python -m build --outdir dist
	$(PYTHON) -m venv .venv-wheel
	.venv-wheel/bin/python -m pip install --quiet dist/*.whl
	cd .venv-wheel && bin/rigidfluid examples rebound && bin/rigidfluid check rebound.toml && bin/rigidfluid run rebound.toml
	$(PYTHON) tools/installed_size.py .venv-wheel

test-long: .venv/.installed-test
	$(PYTEST) --timeout 1800 --durations 40 -m 'long and not nightly and not validation'

# A twentieth of the long tests takes two thirds of their time.
test-nightly: .venv/.installed-test
	$(PYTEST) --timeout 3600 --durations 40 -m nightly

test-plugins: .venv/.installed-plugins
	for plugin in $(PLUGINS); do (cd $$plugin && $(CURDIR)/$(BIN)/python -m pytest --timeout 600) || exit 1; done
	$(PYTEST) --timeout 600 -m 'not validation' $(WITH_PLUGINS)

# In Debian 13's packages, in a folder; see tools/dolfinx.
test-dolfinx:
	tools/dolfinx make
	tools/dolfinx run python3 -m pytest $(PARALLEL) --timeout 600 -m 'not validation' $(WITH_DOLFINX)
	tools/dolfinx run python3 -m pytest --timeout 1800 -m 'not validation' $(WITH_MPI)

# The documentation site, in site/; a warning, as of a link that leads nowhere, ends it.
docs: .venv/.installed-docs
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs site

# The quick pages, made again elsewhere and compared.
pages: .venv/.installed-plugins
	$(BIN)/python docs/make_validation.py --check

# The validation tests and all pages that the present sources have not made; goes on where it was stopped. Some pages
# need DOLFINx, two of these NGSolve beside it.
validate: .venv/.installed-plugins .venv/.installed-bench
	tools/dolfinx make
	tools/dolfinx run pip install --quiet --editable plugins/rigidfluid-ngsolve
	$(BIN)/python docs/make_validation.py --present

# The validation tests alone, and docs/validation/tests.md.
nightly: .venv/.installed-plugins
	$(BIN)/python docs/make_validation.py --present tests

stale: .venv/.installed-plugins
	$(BIN)/python docs/make_validation.py --stale

lint: .venv/.installed-dev
	$(BIN)/ruff check
	$(BIN)/mypy

mutants: .venv/.installed-test
	$(BIN)/python tools/mutants.py --page docs/mutants.md

bench: .venv/.installed-bench .venv/.installed-plugins
	$(BIN)/python docs/make_validation.py step work_precision contact_step step_profile
	$(BIN)/python benchmarks/dry_spheres.py

# The versions that are installed here, for those who want the same; run the tests with them first.
lock: .venv/.installed-dev .venv/.installed-docs .venv/.installed-bench .venv/.installed-movies .venv/.installed-plugins
	$(BIN)/python -m pip check
	$(BIN)/python -m pip freeze --exclude-editable > requirements.lock
	$(BIN)/python tools/third_party.py

clean:
	rm -rf .venv .venv-lowest .venv-build .venv-wheel dist .dolfinx site

# A stamp, since a venv that could not be finished leaves its python behind.
%/.created:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "rigidfluid needs Python 3.11 or newer")'
	$(PYTHON) -m venv $*
	touch $@

.venv/.installed: pyproject.toml | .venv/.created
	$(BIN)/python -m pip install --quiet --editable .
	touch $@

.venv/.installed-plugins: $(PLUGINS:%=%/pyproject.toml) | .venv/.installed-test
	$(BIN)/python -m pip install --quiet --editable '.[vtk,notebooks]' $(PLUGINS:%=--editable %)
	touch $@

.venv/.installed-%: pyproject.toml | .venv/.created
	$(BIN)/python -m pip install --quiet --editable '.[$*]'
	touch $@

# pip takes the newest of all; uv can take the lowest that these projects name.
.venv-lowest/.installed: pyproject.toml $(PLUGINS:%=%/pyproject.toml) | .venv-lowest/.created
	.venv-lowest/bin/python -m pip install --quiet uv
	.venv-lowest/bin/uv pip install --quiet --python .venv-lowest --resolution lowest-direct \
		--editable '.[test,movies,notebooks]' $(PLUGINS:%=--editable %)
	.venv-lowest/bin/python tools/lowest.py
	touch $@

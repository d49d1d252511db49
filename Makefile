# One command does everything. Needs only git, make, python3 (3.11 or newer) and python3-venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# The lock file as it was installed: a target of this Makefile and the environment the workflow's rules depend on.
INSTALLED := $(VENV)/installed.lock
SNAKEMAKE := $(BIN)/snakemake
DOCS := $(VENV)/docs.lock

# Tests run in so many processes, each with whole files of them.
WORKERS ?= $(shell n=$$(nproc 2>/dev/null || echo 2); echo $$((n < 8 ? n : 8)))

# One thread a process: the workflow runs one process a core.
export OMP_NUM_THREADS := 1
export MKL_NUM_THREADS := 1

# Python keeps what it compiles, beside the sources: packages are compiled when they are first imported.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: help setup figures studies smoke test coverage soak bench lint report archive docs specimens pad regression-update schemas adopt unlock clean

help:
	@echo "make figures            set up, then simulate and draw every figure and table of config/thesis.yaml"
	@echo "make test               set up, then run the tests"
	@echo "make smoke              set up, then the same workflow with config/smoke.yaml (coarse, under results/smoke)"
	@echo "make soak               set up, then try random scenes: N=1000 at most, SEED=0, MINUTES=10 of process time at most;"
	@echo "                        FILES=1: files with parts dropped, nodes moved, names changed, tables cut"
	@echo "make studies            set up, then run the studies of accuracy, stability, effects, peers and reconstruction anew"
	@echo "make bench              set up, then measure and print the benchmark table"
	@echo "make report             make figures, then pack figures, tables and the run's statistics into results/report.zip"
	@echo "make archive            make figures, then copy inputs, code, outputs and costs into results/archive, an RO-Crate"
	@echo "make docs               set up, then build the documentation, docs/_build/html"
	@echo "make specimens          calibrate, and take the calibrated specimens over into config/specimens"
	@echo "make pad                infer the thesis's pad anew, and take it over into config/specimens/thesis.yaml"
	@echo "make regression-update  accept a deliberate change of the figures"
	@echo "make lint               style, formatting and the import contracts"
	@echo "make schemas            write workflow/schemas from the typed models"
	@echo "make adopt              take copied results for finished ones: nothing is made again for being newer or older"
	@echo "make unlock             let go of a locked working directory whose run is dead (done by itself where that can be told)"
	@echo "make clean              remove the results (not the environment, not the committed figures)"

setup: $(INSTALLED)

$(INSTALLED): requirements.lock workflow/installer.lock pyproject.toml workflow/scripts/setup.sh workflow/scripts/system_libraries.sh
	@sh workflow/scripts/setup.sh $(PYTHON) $(VENV)
	@cp requirements.lock $@

figures: $(INSTALLED)
	$(SNAKEMAKE)
	@echo "figures: figures/thesis, figures/studies; tables: figures/tables; all of them listed in figures/README.md"

studies: $(INSTALLED)
	$(SNAKEMAKE) accuracy stability effects peers reconstruction

smoke: $(INSTALLED)
	$(SNAKEMAKE) --configfile config/smoke.yaml
	@echo "figures and tables of the coarse run: results/smoke"

test: $(INSTALLED)
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile --durations 25

# the tests take twice as long while lines are counted; compiled loops are not
coverage: $(INSTALLED)
	$(BIN)/python -m pytest -n $(WORKERS) --dist loadfile --cov fingerpad --cov cysyk1999 --cov-report term:skip-covered

N ?= 1000
SEED ?= 0
MINUTES ?= 10

soak: $(INSTALLED)
	$(BIN)/python tests/soak.py --scenes $(N) --seed $(SEED) --minutes $(MINUTES) $(if $(FILES),--files) $(if $(TABLE),--table $(TABLE))

bench: $(INSTALLED)
	$(BIN)/python -m cysyk1999.studies.bench

lint: $(INSTALLED)
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/lint-imports

report: figures
	$(SNAKEMAKE) report_pages
	PYTHONWARNINGS=ignore::RuntimeWarning $(SNAKEMAKE) all report_pages --report results/report.zip \
	  --report-stylesheet workflow/report/report.css --report-metadata workflow/report/metadata.yaml

archive: figures
	$(BIN)/python -m cysyk1999.workflow.archive config/thesis.yaml results/archive

docs: $(DOCS)
	PYDEVD_DISABLE_FILE_VALIDATION=1 $(BIN)/sphinx-build --quiet --nitpicky --fail-on-warning --keep-going docs docs/_build/html
	@echo "docs/_build/html/index.html"

# What the documentation needs beside the workflow, into the same environment; the rules do not depend on it.
$(DOCS): docs/requirements.lock $(INSTALLED)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r docs/requirements.lock
	@cp docs/requirements.lock $@

regression-update: figures
	FINGERPAD_UPDATE_BASELINES=1 $(BIN)/python -m pytest -q tests/test_figure_regression.py
	$(BIN)/python docs/_ext/published.py

specimens: $(INSTALLED)
	$(SNAKEMAKE) calibration spheres
	cp results/thesis/specimens/calibrated_*.yaml results/thesis/spheres/specimens/dome_*.yaml config/specimens/

pad: $(INSTALLED)
	$(SNAKEMAKE) reconstruction
	cp results/thesis/reconstruction/thesis.yaml config/specimens/
	cp results/thesis/reconstruction/bands.csv config/reference/reconstruction_bands.csv

schemas: $(INSTALLED)
	$(BIN)/python -m cysyk1999.workflow.schemas

adopt: $(INSTALLED)
	$(SNAKEMAKE) --touch

unlock: $(INSTALLED)
	$(SNAKEMAKE) --unlock

clean:
	rm -rf results .snakemake docs/_build docs/generated

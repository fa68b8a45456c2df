# Needs python3 (3.11 or newer) and make; everything else is installed into .venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# The extras of wmrgen to install, and how: .ci/run installs more, and compiles only modules that are imported.
EXTRAS ?= dev
HOW ?= --compile
STAMP := $(VENV)/.installed
# Python keeps its bytecode even if the environment forbids it, because the tests start about five hundred processes.
PYTEST := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n auto --dist worksteal

.PHONY: setup demo test check lint types fresh budgets generate docs bench mutants fuzz clean
.DEFAULT_GOAL := demo

setup: $(STAMP)

$(STAMP): pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "wmrgen needs Python 3.11 or newer, this is " + sys.version.split()[0])'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check $(HOW) -c constraints.txt -e '.[$(EXTRAS)]'
	@$(BIN)/python -m compileall -q wmrgen textbook
	@touch $@

demo: setup
	$(BIN)/wmrgen derive robots/pioneer3dx.yaml -o build/demo --html
	@ls build/demo/*
	@echo "Open build/demo/pioneer3dx/report.html in a browser: the derivation, and the robot to drive."

test: setup
	$(PYTEST)

# All tests, slow ones included, after the targets in BEFORE. CI runs these targets in parallel first, with BEFORE= here.
BEFORE ?= lint types fresh budgets

check: setup $(BEFORE)
	WMRGEN_DEEP=1 $(PYTEST) -m 'slow or not slow'

# --full derives every robot, so that the manifests of generated/ are checked too.
fresh: setup
	$(BIN)/wmrgen check --full

budgets: setup
	$(BIN)/python -m benchmarks budgets

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: setup
	$(BIN)/mypy

generate: setup
	$(BIN)/wmrgen derive robots/*.yaml -o generated
	$(BIN)/wmrgen gallery -o generated
	$(BIN)/wmrgen textbook -o generated
	$(BIN)/wmrgen schema --markdown > docs/robot_file.md
	$(BIN)/wmrgen schema > robots/robot.schema.json
	$(BIN)/python -m tests.gallery.table
	$(BIN)/python -m tests.packaging.python_page
	$(BIN)/python -m tests.packaging.feature_page
	$(BIN)/python -m tests.packaging.textbook_page
	$(BIN)/python -m tests.packaging.textbook_robots
	$(BIN)/python -m tests.packaging.moving_picture

# Build docs/, README and the reports as a site: build/docs/docs/index.html. Its first page links to robots to drive.
LIVE := pioneer3dx kuka_youbot ackermann_car wpilib_swervebot lekiwi car_with_trailers
docs: $(VENV)/.docs
	$(BIN)/python -m sphinx -q -n -W --keep-going -j auto -b html -c docs . build/docs
	$(BIN)/wmrgen derive $(LIVE:%=robots/%.yaml) -o build/docs/live --html >build/docs/live.log

$(VENV)/.docs: $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev,docs]'
	@touch $@

bench: setup
	$(BIN)/python -m benchmarks

mutants: setup
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev,mutants]'
	$(BIN)/python -m benchmarks mutants

# Test random robot files by Atheris for SECONDS.
fuzz: $(VENV)/.fuzz
	$(BIN)/python -m tests.hostile.fuzz $(or $(SECONDS),600)

$(VENV)/.fuzz: $(STAMP)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev,fuzz]'
	@touch $@

clean:
	rm -rf build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis

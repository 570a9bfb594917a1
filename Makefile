# Every target sets up what it needs: nothing but Python >= 3.11 with venv has to be there.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= out/paper

.PHONY: demo test check bench formal fuzz docs lock clean

demo: $(VENV)/base
	$(BIN)/gaincert run examples/paper.toml -o $(OUT)
	@echo "open $(OUT)/report.html"

test: $(VENV)/test
	$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

check: $(VENV)/dev
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	mkdir -p build/types && ln -sfn ../.. build/types/gaincert
	cd build/types && ../../$(BIN)/mypy --config-file ../../pyproject.toml -p gaincert

bench: $(VENV)/test
	$(BIN)/python -m benchmarks

# The machine-checked theorem; Coq comes from the system, and the check says which packages it wants.
formal:
	$(PYTHON) -I verify/formal/check.py

fuzz: $(VENV)/test
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[fuzz]"
	GAINCERT_FUZZ_SECONDS=120 $(BIN)/python -m pytest tests/campaigns/test_fuzz.py
	$(BIN)/python tests/campaigns/fuzz_loaders.py --seconds 60

docs: $(VENV)/docs
	mkdir -p build/types && ln -sfn ../.. build/types/gaincert
	$(BIN)/mkdocs build --strict --quiet
	@echo "open build/docs/index.html"

lock: $(VENV)/test $(VENV)/dev $(VENV)/docs
	echo "# What CI installs: every package at one version. Written by 'make lock' from the environment of the other targets." > requirements.lock
	$(BIN)/python -m pip freeze --exclude-editable | grep -v ^atheris >> requirements.lock

clean:
	rm -rf $(VENV) build out

# One environment; the stamps say which extras are in it.
$(VENV)/base: pyproject.toml
	$(PYTHON) -c "import sys; sys.exit('gaincert needs Python >= 3.11') if sys.version_info < (3, 11) else None"
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	touch $@

$(VENV)/test: $(VENV)/base
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[test,browser]"
	touch $@

$(VENV)/dev: $(VENV)/base
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	touch $@

$(VENV)/docs: $(VENV)/base
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[docs]"
	touch $@

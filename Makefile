# make run    Dahneke's bouncing sphere from nothing: table, result.json and figures in results/dahneke
# make test   all tests, from nothing
# make validation   every figure of the two papers, and docs/validation.md; about half an hour, goes on where it stopped
# All install what is missing: Debian packages through apt, Python packages into .venv.

PYTHON ?= python3
VENV   := .venv
OUTPUT := results/dahneke

SOURCES := pyproject.toml CMakeLists.txt $(shell find cmake liggghts_src pyjkr templates cases -type f ! -name '*.pyc')

.PHONY: run test validation packages install clean

run: $(VENV)/installed
	$(VENV)/bin/pyjkr run dahneke -o $(OUTPUT)

test: $(VENV)/installed-test
	tools/debian-packages --with-examples
	$(VENV)/bin/pytest -q

# A case that fails does not keep the others from being done; then the page is not written.
validation: $(VENV)/installed-validation
	@failed=; for case in $$($(VENV)/bin/python docs/validation.py --list); do \
	  $(VENV)/bin/pyjkr sweep $$case -o results/validation/$$case || failed="$$failed $$case"; \
	done; test -z "$$failed" || { echo "make validation: did not hold:$$failed" >&2; exit 1; }
	$(VENV)/bin/python docs/validation.py

install: $(VENV)/installed

packages:
	tools/debian-packages

$(VENV)/bin/pip: | packages
	$(PYTHON) -m venv $(VENV)

$(VENV)/installed: $(SOURCES) | packages $(VENV)/bin/pip
	$(VENV)/bin/pip install --quiet --disable-pip-version-check .
	touch $@

$(VENV)/installed-test: $(SOURCES) | packages $(VENV)/bin/pip
	$(VENV)/bin/pip install --quiet --disable-pip-version-check '.[test]'
	touch $(VENV)/installed $@

$(VENV)/installed-validation: $(SOURCES) | packages $(VENV)/bin/pip
	$(VENV)/bin/pip install --quiet --disable-pip-version-check '.[packing]'
	touch $(VENV)/installed $@

clean:
	rm -rf build $(VENV) results

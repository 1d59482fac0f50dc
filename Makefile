# make run    Dahneke's bouncing sphere from nothing: table, result.json and figures in results/dahneke
# make test   all tests, from nothing
# Both install what is missing: Debian packages through apt, Python packages into .venv.

PYTHON ?= python3
VENV   := .venv
OUTPUT := results/dahneke

SOURCES := pyproject.toml CMakeLists.txt $(shell find cmake liggghts_src pyjkr templates cases -type f ! -name '*.pyc')

.PHONY: run test packages install clean

run: $(VENV)/installed
	$(VENV)/bin/pyjkr run dahneke -o $(OUTPUT)

test: $(VENV)/installed-test
	tools/debian-packages --with-examples
	$(VENV)/bin/pytest -q

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

clean:
	rm -rf build $(VENV) results

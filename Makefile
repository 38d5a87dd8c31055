# `make run` and `make test` first install missing packages and build; both are quick the second time.
DECK ?= cases/arch/readme.toml
# quick, or long: with the tests of tests/long.txt too, of more than half a second of a processor each
SUITE ?= quick
MARKS := $(if $(filter long,$(SUITE)),-m "not verify",$(if $(filter quick,$(SUITE)),,$(error SUITE is quick or long)))
PYTHON := .venv/bin/python
# An import after a pull may build anew; meson then requires numpy-config and ninja on the path.
export PATH := $(CURDIR)/.venv/bin:$(PATH)

.PHONY: browser pictures run test times verify faults bench oldest lint format wheel setup table-5-3 impact-map docs coverage release clean

run: setup
	@.venv/bin/extrados run $(DECK)

test: setup
	@$(if $(filter long,$(SUITE)),$(PYTHON) tools/extras.py ifc)
	@$(PYTHON) -m pytest -q -n auto --maxprocesses 8 --dist worksteal $(MARKS)
	@$(PYTHON) tools/native_tests.py

times: setup  ## measure the processor time of all tests but the validation; writes tests/long.txt
	@$(PYTHON) tools/long_tests.py

browser: setup  ## chromium and Playwright, if available, for the tests of the interactive page
	@sh tools/browser.sh

verify: setup  ## long validation and whole trials, in an hour on two cores; writes docs/verification.md
	@EXTRADOS_TRIALS=1 $(PYTHON) -m pytest -v -m "" -n auto --maxprocesses 8 --dist load --maxschedchunk 1
	@$(PYTHON) tools/verification_book.py

faults: setup  ## plants 80 faults in Fortran and C, one at a time: an hour of one core; the next `make verify` prints their fates
	@$(PYTHON) tools/seeded_faults.py

bench: setup  ## comparison with other programs, which it installs; BENCH="arch dem" selects some
	@$(PYTHON) tests/bench $(BENCH)

oldest: setup  ## build and test with the oldest pip and libraries supported
	@$(PYTHON) tools/oldest.py

lint: setup
	@.venv/bin/ruff check python tests tools
	@.venv/bin/ruff format --check python tests tools
	@.venv/bin/fortitude check fortran tests/fortran
	@.venv/bin/mypy

format: setup
	@.venv/bin/ruff check --fix python tests tools
	@.venv/bin/ruff format python tests tools

coverage: setup  ## share of lines of Python, Fortran and C that the quick suite runs, in a build of its own; TESTS="tests/unit/test_sla_events.py" selects tests
	@$(PYTHON) tools/coverage.py $(TESTS)

release: setup  ## VERSION=0.2.0: sets the version in all files, dates the changelog, commits, tags, packs the sources
	@$(PYTHON) tools/release.py $(VERSION)

docs: setup  ## the documentation site in build/site/VERSION: pictures by their decks, notebooks executed, offline search; installs its requirements
	@$(PYTHON) tools/site.py

pictures: setup  ## pictures of the README (docs/pictures) from decks of cases/; NAME="strip-arch page" selects some
	@$(PYTHON) tools/pictures.py $(NAME)

table-5-3: setup  ## refit the assessment criterion (thesis Table 5.3); RULE=inelastic prints the fit by another impact rule
	@$(PYTHON) -m extrados.analyses.rocking.criterion $(RULE)

impact-map: setup  ## c_v of arches by each impact rule and by discrete elements: results/impact-map
	@$(PYTHON) tools/impact_map.py

wheel: setup
	@$(PYTHON) -m pip wheel --no-deps --no-build-isolation -w dist .

setup:
	@sh tools/setup.sh

clean:
	rm -rf .venv build dist results

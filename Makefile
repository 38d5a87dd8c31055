# `make run` and `make test` set up whatever is missing first; both are quick the second time.
DECK ?= cases/arch/readme.toml
PYTHON := .venv/bin/python
# An import after a pull may build anew, and meson then looks for numpy-config and ninja on the path.
export PATH := $(CURDIR)/.venv/bin:$(PATH)

.PHONY: browser run test verify bench oldest lint format wheel setup table-5-3 impact-map docs coverage release clean

run: setup
	@.venv/bin/extrados run $(DECK)

test: setup
	@$(PYTHON) -m pytest -q -n auto --maxprocesses 8 --dist worksteal
	@$(PYTHON) tools/native_tests.py

browser: setup  ## chromium and Playwright, where they can be had, for the tests of the interactive page
	@sh tools/browser.sh

verify: setup  ## long validation and whole trials; writes docs/verification.md
	@EXTRADOS_TRIALS=1 $(PYTHON) -m pytest -q -m ""
	@$(PYTHON) tools/seeded_faults.py
	@$(PYTHON) tools/verification_book.py

bench: setup  ## against peers, which it installs; BENCH="arch dem" names some
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

coverage: setup  ## of Python, Fortran and C by the quick suite, which it builds anew for; TESTS="tests/unit/test_sla_events.py" names some
	@$(PYTHON) tools/coverage.py $(TESTS)

release: setup  ## VERSION=0.2.0: sets it everywhere, dates the changelog, commits, tags, packs the sources
	@$(PYTHON) tools/release.py $(VERSION)

docs: setup  ## the site, in build/site, with its search offline; installs its own needs
	@$(PYTHON) tools/site.py

table-5-3: setup  ## refit the assessment criterion (thesis Table 5.3); RULE=inelastic prints it by another impact rule
	@$(PYTHON) -m extrados.analyses.rocking.criterion $(RULE)

impact-map: setup  ## c_v of arches by each impact rule beside discrete elements: results/impact-map
	@$(PYTHON) tools/impact_map.py

wheel: setup
	@$(PYTHON) -m pip wheel --no-deps --no-build-isolation -w dist .

setup:
	@sh tools/setup.sh

clean:
	rm -rf .venv build dist results

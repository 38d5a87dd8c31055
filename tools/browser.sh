#!/bin/sh
# A browser for the tests of the interactive page: chromium by apt if possible, Playwright into .venv, and the package for
# the page as a widget of notebooks. Without them
# these tests are skipped and say so; nothing else needs them.
set -u

wanted='import tomllib; extras = tomllib.load(open("pyproject.toml", "rb"))["project"]["optional-dependencies"]; print(*extras["browser"], *extras["notebook"])'
# shellcheck disable=SC2046
.venv/bin/python -c 'import anywidget, axe_playwright_python, playwright' 2>/dev/null \
  || .venv/bin/python -m pip install -q --disable-pip-version-check $(.venv/bin/python -c "$wanted") 2>/dev/null \
  || echo "Playwright could not be installed: tests in a browser are skipped" >&2
for name in chromium chromium-browser google-chrome; do
  command -v "$name" >/dev/null 2>&1 && exit 0
done
if command -v apt-get >/dev/null 2>&1; then
  become=""
  [ "$(id -u)" = 0 ] || become="sudo -n"
  $become apt-get update -qq 2>/dev/null
  $become env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends chromium fonts-dejavu-core \
    >/dev/null 2>&1 && exit 0
fi
echo "no chromium: tests in a browser are skipped (apt-get install chromium)" >&2
exit 0

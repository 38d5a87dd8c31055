#!/usr/bin/env bash
# Walk "First change in 15 minutes" of CONTRIBUTING.md on a bare Debian: git, make, python3 and certificates, nothing else.
#
#   sudo tools/first_change.sh [bookworm|trixie]
#
# The machine is a folder made by debootstrap, entered by chroot, with a clone of the present commit. Prints the seconds of
# each step and of all; exit code 1 if a step differs from the page. Downloads of pip are kept (tools/bare.sh).
set -euo pipefail

source=$(cd "$(dirname "$0")/.." && pwd)
. "$source/tools/bare.sh"
release=${1:-bookworm}
fresh "$release" first
room=$place/$release-first
git clone -q --no-hardlinks "$source" "$room/root/extrados"
log=$place/logs/$release-first
: >"$log"
start=$SECONDS

step() {  # WHAT WANTED(done|refused) COMMAND: as typed by the reader
  local begin=$SECONDS code=0
  enter "$room" root sh -c "cd ~/extrados && $3" >>"$log" 2>&1 || code=$?
  printf '%4d s  %s\n' $((SECONDS - begin)) "$1"
  if [ "$2" = done ] && [ $code != 0 ] || [ "$2" = refused ] && [ $code = 0 ]; then
    tail -20 "$log"
    echo "not as the page says (exit code $code), see $log" >&2
    exit 1
  fi
}

words=python/extrados/decks/synonyms.py
step "1. make run" done "make run"
step "2. a word that is there" done ".venv/bin/extrados explain springing"
step "   a word that is not" refused ".venv/bin/extrados explain wedgestone"
step "   a line of one's own" done "sed -i 's/^SYNONYMS: .*/&\n    _line(\"wedgestone\", \"a stone of an arch\", \"arch.voussoirs\", \"guide.md\"),/' $words && .venv/bin/extrados explain wedgestone"
step "3. the test of the table" done ".venv/bin/pytest -q -n 0 tests/unit/test_words.py"
step "   sees a pointer to nowhere" refused "sed -i 's/\"arch.voussoirs\", \"guide.md\"),\$/\"arch.vousoirs\", \"guide.md\"),/' $words && .venv/bin/pytest -q -n 0 tests/unit/test_words.py"
step "   and is content again" done "sed -i 's/arch.vousoirs/arch.voussoirs/' $words && .venv/bin/pytest -q -n 0 tests/unit/test_words.py"
step "4. make lint, commit" done "make lint && git -c user.name=Mason -c user.email=mason@example.org commit -qam 'explain knows the wedgestone'"
step "5. a line of Fortran, and its test sees it" refused "sed -i 's/thesis = -b(5)/thesis = -0.9_wp * b(5)/' fortran/arch/impact.f90 && .venv/bin/pytest -q -n 0 tests/unit/test_impact.py"
step "   taken back" done "git checkout -q fortran && .venv/bin/pytest -q -n 0 tests/unit/test_impact.py"
printf '%4d s  in all\n' $((SECONDS - start))

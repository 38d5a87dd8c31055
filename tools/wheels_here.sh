#!/bin/sh
# Build and try wheels for Python 3.11 to 3.14 on this machine, without root.
#
#   tools/wheels_here.sh [VERSION ...]
#
# A Python is found by uv, on the path, or among those of pyenv; one that is missing is named, and the exit code is then 1.
# Each wheel is installed into a fresh environment, where a case is run. Wheels lie in dist/. `sudo tools/wheels.sh` builds and
# tries them on bare Debians instead.
set -u

source=$(cd "$(dirname "$0")/.." && pwd)
[ $# != 0 ] || set -- 3.11 3.12 3.13 3.14
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bad=0

found() {  # VERSION: the interpreter
  uv python find --no-python-downloads "$1" 2>/dev/null && return
  for one in "$HOME"/.pyenv/versions/"$1".*/bin/python3 "$(command -v "python$1" || true)"; do
    [ -x "$one" ] && "$one" -c "import sys; sys.exit('%d.%d' % sys.version_info[:2] != '$1')" 2>/dev/null && echo "$one" && return
  done
  return 1
}

for version in "$@"; do
  if ! python=$(found "$version"); then
    echo "Python $version: not on this machine (uv python install $version)"
    bad=1
    continue
  fi
  rm -rf "$work/$version" "$work/try-$version"
  if ! sh "$source/tools/wheel.sh" "$python" "$work/$version" >"$work/log" 2>&1; then
    tail -20 "$work/log" >&2
    echo "Python $version: the build failed"
    bad=1
    continue
  fi
  mkdir -p "$source/dist" && cp "$work/$version/"*.whl "$source/dist/"
  "$python" -m venv "$work/try-$version" && "$work/try-$version/bin/pip" install -q --disable-pip-version-check "$work/$version/"*.whl
  if (cd "$work" && "try-$version/bin/extrados" new arch >deck.toml && "try-$version/bin/extrados" run deck.toml --out "out-$version"); then
    wheel=$(basename "$work/$version/"*.whl)
    echo "$wheel: $(stat -c %s "$source/dist/$wheel" | awk '{printf "%.1f MB", $1 / 1e6}'), runs"
  else
    echo "Python $version: the wheel does not run"
    bad=1
  fi
done
exit $bad

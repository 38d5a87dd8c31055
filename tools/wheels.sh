#!/usr/bin/env bash
# Build wheels with all libraries inside, each on a bare Debian, and try each on a bare Debian with Python alone.
#
#   sudo tools/wheels.sh [bookworm|trixie|3.14|FOLDER ...]
#
# Debian 12 gives the wheel of Python 3.11, Debian 13 that of Python 3.13, each tried on its own release. The wheel of Python
# 3.14 is built on Debian 13 with the Python of Debian's testing branch, which this older glibc runs, because auditwheel names
# no glibc as new as that of testing; it is tried on testing (forky). No Debian has Python 3.12: FOLDER holds a Python that runs in place (of pyenv, of
# `uv python install`, of a forge's tools; built on Debian 12 or older), and its wheel is built on Debian 12 and tried on
# both releases. By default both releases, 3.14, and the Python 3.12 that the path finds. A wheel runs on its release's glibc
# or a newer one, as its name says. GSL, SuiteSparse, OpenBLAS and gfortran's library lie in the wheel, with their
# licences. The wheels of the present commit are put in dist/; the log of a failed step is named.
set -euo pipefail

source=$(cd "$(dirname "$0")/.." && pwd)
. "$source/tools/bare.sh"
pythons=("$@")
if [ ${#pythons[@]} = 0 ]; then
  pythons=(bookworm trixie 3.14)
  newer=$(python3.12 -c 'import sys; print(sys.base_prefix)' 2>/dev/null || true)
  case "$newer" in
    "" | /usr) echo "note: no wheel for Python 3.12: the path finds none that could be taken along" >&2 ;;
    *) pythons+=("$newer") ;;
  esac
fi
commit=$(git -C "$source" describe --always --exclude="*")
most=$((40 * 1000 * 1000))  # bytes of a wheel

taken='
set -e
echo "deb $MIRROR forky main" >/etc/apt/sources.list.d/forky.list
apt-get update -qq
cd /tmp
apt-get download -qq python3.14 python3.14-minimal python3.14-venv python3.14-dev \
  libpython3.14-minimal libpython3.14-stdlib libpython3.14-dev
for package in ./*.deb; do dpkg -x "$package" /; done
rm /etc/apt/sources.list.d/forky.list ./*.deb
'
built='
set -e
apt-get update -qq
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends gcc libc6-dev gfortran pkg-config \
  libgsl-dev libsuitesparse-dev libopenblas-dev python3-dev python3-venv
/root/extrados/tools/wheel.sh "$PYTHON" /root/repaired
'
tried='
set -e
apt-get update -qq
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends python3-venv
"$PYTHON" -m venv /root/try
cd /root
try/bin/pip install -q --disable-pip-version-check ./*.whl
try/bin/extrados version | grep -F " $COMMIT "
try/bin/extrados new arch >deck.toml
try/bin/extrados run deck.toml
try/bin/extrados cases | grep arch/oppenheim.toml
try/bin/extrados run try/lib/python3*/site-packages/extrados/cases/arch/oppenheim.toml
'

room() {  # RELEASE NAME: a fresh machine, with the Python that is taken along
  fresh "$1" "$2"
  [ "$python" = python3 ] || { mkdir -p "$place/$1-$2$prefix" && cp -a "$prefix/." "$place/$1-$2$prefix/"; }
}

step() {  # MACHINE LOG WHAT SCRIPT: run it there as root
  enter "$place/$1" root env PYTHON="$python" COMMIT="$commit" MIRROR="$mirror" sh -c "$4" >"$2" 2>&1 || { tail -20 "$2"; echo "$3 failed, see $2" >&2; exit 1; }
}

for word in "${pythons[@]}"; do
  case "$word" in
    bookworm | trixie) release=$word python=python3 prefix='' trials=("$word") ;;
    3.14) release=trixie python=python3 prefix='' trials=(forky) ;;
    /*) release=bookworm prefix=$(realpath "$word") trials=(bookworm trixie)
      python=$prefix/bin/python3
      [ -x "$python" ] || { echo "$python: not there" >&2; exit 2; } ;;
    *) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//;p}' "$0" >&2; exit 2 ;;
  esac
  log=$place/logs/$(basename "$word")-wheel
  room "$release" wheel
  git clone -q --no-hardlinks "$source" "$place/$release-wheel/root/extrados"
  if [ "$word" = 3.14 ]; then
    step "$release-wheel" "$log-taken" "taking Python $word" "$taken"
    python=python3.14 step "$release-wheel" "$log" "building for $word" "$built"
  else
    step "$release-wheel" "$log" "building for $word" "$built"
  fi
  mkdir -p "$source/dist"
  wheel=$(basename "$place/$release-wheel/root/repaired/"*.whl)
  cp "$place/$release-wheel/root/repaired/$wheel" "$source/dist/"
  for trial in "${trials[@]}"; do
    room "$trial" wheel-try
    cp "$source/dist/$wheel" "$place/$trial-wheel-try/root/"
    step "$trial-wheel-try" "$log-try-$trial" "trying $wheel on $trial" "$tried"
  done
  size=$(stat -c %s "$source/dist/$wheel")
  printf '%s: %.1f MB, runs on bare %s\n' "$wheel" "$(echo "$size" | awk '{print $1 / 1e6}')" "${trials[*]}"
  [ "$size" -le $most ] || { echo "larger than $most bytes" >&2; exit 1; }
done

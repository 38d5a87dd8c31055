#!/bin/sh
# Install missing packages: compilers and libraries by apt (elsewhere the line to type is named), then .venv.
set -eu

packages="gcc libc6-dev gfortran pkg-config libgsl-dev libsuitesparse-dev libopenblas-dev python3 python3-dev python3-venv"
lacking=""
need() { command -v "$1" >/dev/null 2>&1 || lacking="$lacking $1"; }
need gcc
need gfortran
need pkg-config
if command -v pkg-config >/dev/null 2>&1; then
  pkg-config --exists gsl || lacking="$lacking gsl"
  pkg-config --exists openblas || pkg-config --exists lapack || lacking="$lacking lapack"
fi
found=no
for folder in /usr/include /usr/local/include /opt/homebrew/include /usr/include/suitesparse \
              /usr/local/include/suitesparse /opt/homebrew/include/suitesparse; do
  [ -f "$folder/cholmod.h" ] && found=yes
done
[ $found = yes ] || lacking="$lacking suitesparse"
python=$(command -v python3 || true)
[ -n "$python" ] || lacking="$lacking python3"
if [ -n "$python" ]; then
  "$python" -c 'import ensurepip, venv' 2>/dev/null || lacking="$lacking python3-venv"
  "$python" -c 'import os, sysconfig, sys; sys.exit(not os.path.exists(sysconfig.get_path("include") + "/Python.h"))' \
    || lacking="$lacking python3-dev"
fi

if [ -n "$lacking" ]; then
  echo "missing:$lacking"
  if command -v apt-get >/dev/null 2>&1; then
    become=""
    if [ "$(id -u)" != 0 ]; then
      # Without a password to type or a terminal to type it at, sudo cannot help.
      if command -v sudo >/dev/null 2>&1 && { sudo -n true 2>/dev/null || { [ -t 0 ] && sudo -v; }; }; then
        become=sudo
      else
        echo "ask root for: apt-get install -y --no-install-recommends $packages" >&2
        exit 1
      fi
    fi
    echo "installing with apt-get ..."
    $become apt-get update -qq
    # shellcheck disable=SC2086
    $become env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $packages >/dev/null
  else
    cat >&2 <<'HELP'
install them and try again:
  macOS:   brew install gcc gsl suite-sparse openblas pkg-config python
  Fedora:  sudo dnf install gcc gcc-gfortran pkgconf gsl-devel suitesparse-devel openblas-devel python3-devel
  conda:   conda install -c conda-forge compilers gsl suitesparse openblas pkg-config python
HELP
    exit 1
  fi
fi

python=$(command -v python3)
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
  echo "extrados needs Python 3.11 or newer; $python is $("$python" -V)" >&2
  exit 1
}

# Warnings are errors with the compiler the project is checked with. A newer one may warn of more, and that must
# not keep a user from building.
case "$(gfortran -dumpversion)" in
  12*) strict=true ;;
  *) strict=false ;;
esac

# The stamp holds what the environment was made from: a change of it makes the environment anew. What is there
# already is taken as it is, so that this works offline too. pip of Debian 12 (23.0.1) knows no -C.
stamp=".venv/made-from"
want="$("$python" -V) $(cat pyproject.toml meson.build meson.options tools/setup.sh | cksum)"
if [ ! -f "$stamp" ] || [ "$(cat "$stamp")" != "$want" ]; then
  echo "making .venv and building (about two minutes) ..."
  .venv/bin/python -m pip --version >/dev/null 2>&1 || "$python" -m venv --clear .venv
  needed=$("$python" -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"])')
  # shellcheck disable=SC2086
  .venv/bin/python -m pip install -q --disable-pip-version-check $needed
  PATH="$PWD/.venv/bin:$PATH" .venv/bin/python -m pip install -q --disable-pip-version-check \
    --no-build-isolation --config-settings=setup-args=-Dwerror=$strict -e ".[dev]"
  echo "$want" > "$stamp"
fi

# The loader of editable installs reads compiled modules but keeps none: without this every command compiles its own.
.venv/bin/python -m compileall -q python/extrados || true

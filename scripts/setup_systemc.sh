#!/bin/bash
# Finds SystemC 2.3.4, or unpacks the pinned Debian packages into build/tools/systemc, without root. Writes the flags to
# compile and link with into build/tools/systemc/cflags and ldflags.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=build/tools/systemc list=scripts/requirements/systemc.txt

fail() {
  echo "setup: SystemC 2.3.4 cannot be had: $1. On Debian 12 as root: apt install libsystemc-dev" >&2
  exit 1
}

works() {  # CFLAGS LDFLAGS: compiles and links; the library tells a wrong version or standard apart
  printf '#include <systemc>\n#include <tlm>\nint sc_main(int, char *[]) { return SC_VERSION_MAJOR != 2; }\n' |
    g++ -std=c++17 -O0 $1 -x c++ - $2 -lsystemc -o "$folder/probe" 2>"$folder/probe.log" && "$folder/probe" >/dev/null 2>&1
}

mkdir -p "$folder"
if works "" ""; then
  cflags="" ldflags=""
else
  reason=$(scripts/debian_packages.sh $list $folder 2>&1) || fail "$reason"
  library=$PWD/$folder/root/usr/lib/x86_64-linux-gnu
  cflags="-isystem $PWD/$folder/root/usr/include" ldflags="-L$library -Wl,-rpath,$library"
  works "$cflags" "$ldflags" || fail "the unpacked packages do not link, see $folder/probe.log"
fi
echo "$cflags" >"$folder/cflags"
echo "$ldflags" >"$folder/ldflags"

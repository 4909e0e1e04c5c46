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
  [ "$(dpkg --print-architecture 2>/dev/null)" = amd64 ] || fail "neither installed nor a Debian amd64 to fetch it for"
  packages=$(sed -n 's/^[0-9a-f]\{64\}  //p' "$list")
  for deb in $packages; do
    [ -f "$folder/$deb" ] && continue
    IFS=_ read -r name version _ <<<"$deb"
    (cd "$folder" && apt-get download --quiet=2 "$name=$version") 2>"$folder/apt.log" || fail "$(tail -n 1 "$folder/apt.log")"
  done
  (cd "$folder" && grep -v '^#' "$OLDPWD/$list" | sha256sum --check --quiet --strict) >&2 ||
    fail "a package in $folder is not the pinned one"
  for deb in $packages; do dpkg -x "$folder/$deb" "$folder/root"; done
  library=$PWD/$folder/root/usr/lib/x86_64-linux-gnu
  cflags="-isystem $PWD/$folder/root/usr/include" ldflags="-L$library -Wl,-rpath,$library"
  works "$cflags" "$ldflags" || fail "the unpacked packages do not link, see $folder/probe.log"
fi
echo "$cflags" >"$folder/cflags"
echo "$ldflags" >"$folder/ldflags"

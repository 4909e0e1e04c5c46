#!/bin/bash
# Finds a clang with libFuzzer, or unpacks the pinned one of Debian 12 into build/tools/clang, without root. Writes the
# command that runs it into build/tools/clang/command: an empty file where there is none to be had, and then the fuzz
# targets are built by gcc and run their corpus only.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=build/tools/clang

works() {  # COMMAND: compiles, links and runs a target under all the sanitizers
  printf 'int LLVMFuzzerTestOneInput(const char *data, unsigned long size) { return size > 99 && *data; }\n' |
    $1 -fsanitize=fuzzer,address,undefined,float-cast-overflow -x c - -o "$folder/probe" >"$folder/probe.log" 2>&1 &&
    "$folder/probe" -runs=1 >>"$folder/probe.log" 2>&1
}

choose() { printf '%s\n' "$1" >"$folder/command"; exit; }

mkdir -p "$folder"
for candidate in clang-14 clang; do
  if command -v $candidate >/dev/null && works $candidate; then choose $candidate; fi
done

echo "setup: unpacking clang 14 into $folder"
root=$PWD/$folder/root
unpacked="env LD_LIBRARY_PATH=$root/usr/lib/x86_64-linux-gnu:$root/usr/lib/llvm-14/lib $root/usr/lib/llvm-14/bin/clang"
if reason=$(scripts/debian_packages.sh scripts/requirements/clang.txt $folder 2>&1); then
  if works "$unpacked"; then choose "$unpacked"; fi
  reason="see $folder/probe.log"
fi
echo "setup: no clang with libFuzzer ($reason): the fuzz targets run their corpus only" >&2
choose ""

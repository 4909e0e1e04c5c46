#!/bin/bash
# What the tests cover of the C code (gcov) and of Python, by folder, and build/coverage/{c,python}/index.html.
# usage: scripts/coverage.sh PROCESSES [PYTEST ARGUMENT ...]
set -euo pipefail
cd "$(dirname "$0")/.."
readonly processes=$1 out=build/coverage
shift

export VISTA_BUILD=build/covered COVERAGE_FILE=$PWD/$out/data
make --no-print-directory native systemc BUILD="$VISTA_BUILD" CFLAGS="-O1 -g" SANITIZE="--coverage -fprofile-update=atomic" \
  SYSTEMC_CXXFLAGS="-O1 -g -std=c++17" >/dev/null
rm -rf $out && mkdir -p $out/c
find "$VISTA_BUILD" -name '*.gcda' -delete

# Loops that wait run more often than gcovr believes (suspicious hits).
# Tests that fail are named, but do not keep the others from being counted. The benches of the RTL: make coverage-rtl.
tests=("$@")
[ $# -gt 0 ] || tests=(model sw/tests sw/eval/tests)
.venv/bin/coverage run --parallel-mode --concurrency=multiprocessing,thread -m pytest -n "$processes" "${tests[@]}" ||
  echo "coverage: not all tests passed" >&2
.venv/bin/coverage combine --quiet
.venv/bin/coverage json --quiet -o $out/python.json
.venv/bin/coverage html --quiet --directory $out/python
.venv/bin/gcovr --root . --object-directory "$VISTA_BUILD" --filter 'model/' --filter 'sw/' --exclude-throw-branches \
  --merge-mode-functions=merge-use-line-min --gcov-suspicious-hits-threshold=0 --json-summary $out/c.json \
  --html-nested $out/c/index.html 2>$out/gcovr.log ||
  { tail -n 5 $out/gcovr.log >&2; exit 1; }
.venv/bin/python scripts/coverage_table.py $out/c.json $out/python.json
echo "line by line: $PWD/$out/c/index.html, $PWD/$out/python/index.html"

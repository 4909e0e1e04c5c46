#!/bin/bash
# The tests that reach C and C++ code, over libraries built with AddressSanitizer and UndefinedBehaviorSanitizer.
# usage: scripts/test_sanitized.sh [PYTEST ARGUMENT ...]
set -euo pipefail
cd "$(dirname "$0")/.."

export VISTA_BUILD=build/sanitized
# AddressSanitizer sees what the checks of null pointers, object sizes and overflowing pointers see, with which the inlined
# kernels of the engine take half a minute each to compile; the fuzz targets have them.
make --no-print-directory -j "$(nproc)" native systemc BUILD="$VISTA_BUILD" DEVELOPER=ON CFLAGS="-O1 -g1" SYSTEMC_CXXFLAGS="-O1 -g1 -std=c++17 -Wall -Wextra -Werror" \
  SANITIZE="-fsanitize=address,undefined,float-cast-overflow -fno-sanitize=null,object-size,pointer-overflow -fno-sanitize-recover=all"

tests=("$@")
# With more processes than there are processors, the tests that fly in real time lose too many frames. All tests that reach
# C and C++ code lie in these folders.
[ $# -gt 0 ] || tests=(-n "$(nproc)" --max-worker-restart=0 -m "native and not same_c" model sw/tests)

# Python itself is not instrumented: the run-time comes first by preload, and its leaks are not ours.
LD_PRELOAD="$(gcc -print-file-name=libasan.so) $(gcc -print-file-name=libstdc++.so)" \
ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
  .venv/bin/python -m pytest -p no:cacheprovider "${tests[@]}"

#!/bin/bash
# All tests, then those of the compiled code again under sanitizers; one line with what both came to at the end.
# usage: scripts/test_all.sh PROCESSES
set -uo pipefail
cd "$(dirname "$0")/.."

# The same commit is tested with the same random numbers: what passed here passes in CI, and each commit draws anew.
VISTA_RUN=${VISTA_RUN:-$(git rev-parse HEAD 2>/dev/null || true)}
export VISTA_RUN

status=0
.venv/bin/python -m pytest -n "$1" --max-worker-restart=0 --durations=25 2>&1 | tee build/test.log || status=1
echo "again under AddressSanitizer and UndefinedBehaviorSanitizer: build/test-asan.log"
scripts/test_sanitized.sh >build/test-asan.log 2>&1 || { status=1; cat build/test-asan.log; }

count() { tail -qn 1 build/test.log build/test-asan.log | grep -oE "[0-9]+ $1" | awk '{ sum += $1 } END { print sum + 0 }'; }
failed=$(($(count failed) + $(count error)))
[ $status = 0 ] || [ $failed != 0 ] || failed=1 # pytest did not come to its end
echo "$(count passed) passed, $failed failed, $(count skipped) skipped"
exit $status

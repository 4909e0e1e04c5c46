#!/bin/bash
# Static analysers over the C code: cppcheck, clang-tidy and gcc -fanalyzer. analyse.sh JOBS; ends with 1 when one of them
# finds something. What is suppressed in the code has its reason there.
set -uo pipefail
cd "$(dirname "$0")/.."
readonly jobs=${1:-2} out=build/analyse
mkdir -p $out
cmake -S . -B $out -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >$out/cmake.log || { cat $out/cmake.log; exit 1; }
status=0

# A file may be compiled for several libraries; once is enough. gcc's analyzer needs no optimisation, which would only
# inline what it then follows many times over. The rows of the engine are unrolled by their source: it takes many minutes
# for each of these files.
.venv/bin/python - $out <<'PYTHON'
import json, pathlib, shlex, sys
out = pathlib.Path(sys.argv[1])
once = {item["file"]: item for item in json.loads((out / "compile_commands.json").read_text())}
(out / "once").mkdir(exist_ok=True)
(out / "once" / "compile_commands.json").write_text(json.dumps(list(once.values())))
(out / "files").write_text("\n".join(once) + "\n")
with (out / "gcc").open("w") as commands:
    for item in once.values():
        if "/model/c/src/rows_" in item["file"]:
            continue
        words = ["-O0" if word.startswith("-O") else word for word in shlex.split(item["command"])]
        words[words.index("-o") + 1] = "/dev/null"
        commands.write(f"cd {item['directory']} && {shlex.join(words)} $ANALYZER\n")
PYTHON

echo "analyse: cppcheck"
.venv/bin/cppcheck --quiet -j "$jobs" --std=c11 --enable=warning,performance,portability --inline-suppr \
  --error-exitcode=1 --project=$out/once/compile_commands.json || status=1

# Left out: what style decides here (parameters of one type side by side, bits of signed numbers, products that are
# widened where their range is known, assignments in conditions, indices by whole division, steps along a path that are
# no whole numbers, _POSIX_C_SOURCE), and what C has no better function for.
echo "analyse: clang-tidy"
checks='-*,clang-analyzer-*,bugprone-*,cert-err34-c'
for name in clang-analyzer-security.{FloatLoopCounter,insecureAPI.DeprecatedOrUnsafeBufferHandling} \
  bugprone-{easily-swappable-parameters,signed-bitwise,implicit-widening-of-multiplication-result,narrowing-conversions} \
  bugprone-{assignment-in-if-condition,integer-division,float-loop-counter,reserved-identifier}; do
  checks+=,-$name
done
xargs -a $out/files -P "$jobs" -n 4 .venv/bin/clang-tidy --quiet -p $out/once --checks="$checks" \
  --warnings-as-errors='*' 2>$out/tidy.log || status=1

# gcc 12 loses sight of what is filled in or kept through a pointer, and takes it for uninitialised or leaked; cppcheck,
# clang-tidy and the sanitizers look for both.
echo "analyse: gcc -fanalyzer"
export ANALYZER='-fanalyzer -Wno-analyzer-use-of-uninitialized-value -Wno-analyzer-malloc-leak -Werror'
tr '\n' '\0' <$out/gcc | xargs -0 -P "$jobs" -I COMMAND sh -c COMMAND || status=1
exit $status

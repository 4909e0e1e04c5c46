#!/bin/bash
# Compiles Verilator's run-time, which is the same in every simulation, only once. Verilator's
# makefiles put it before each compiler call when OBJCACHE names it: object_cache.sh COMPILER ARGUMENT ... -o OBJECT SOURCE
# The objects are kept in the folder VISTA_OBJECTS by the command that made them, until their source is newer. However
# fast the design is asked to be, they are compiled with one level of optimisation, to be linked into whatever it becomes,
# and without what is defined for our own sources.
set -euo pipefail
readonly source=${!#} object=$(basename "${@:$#-1:1}")
case $object in verilated*.o) ;; *) exec "$@" -include "$(dirname "$0")/assertions_on.h" ;; esac

command=()
for word in "$@"; do
  case $word in -O? | -fPIC | -std=* | -DVISTA_*) ;; *) command+=("$word") ;; esac
done
command=("${command[0]}" -O1 -fPIC -std=gnu++17 "${command[@]:1}")
sum=$(printf '%s\n' "${command[@]}" | cksum)
readonly kept=$VISTA_OBJECTS/${sum%% *}_$object
mkdir -p "$VISTA_OBJECTS"
exec 9>"$kept.lock"
flock 9 # several builds may run at once, and one compiles for all
if [ ! "$kept" -nt "$source" ]; then
  "${command[@]}"
  mv "$object" "$kept"
fi
cp "$kept" "$object"

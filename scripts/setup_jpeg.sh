#!/bin/bash
# Finds libjpeg to be linked statically into vista-fly, or unpacks the pinned Debian package into build/tools/jpeg,
# without root. Where it cannot be had vista-fly is built without it, and cannot read Motion JPEG.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=build/tools/jpeg list=scripts/requirements/jpeg.txt

mkdir -p "$folder"
if ! ls /usr/lib/*/libjpeg.a >/dev/null 2>&1; then
  reason=$(scripts/debian_packages.sh $list $folder 2>&1) || {
    rm -rf "$folder/root"
    echo "setup: libjpeg cannot be had, so vista-fly reads no Motion JPEG: $reason. On Debian as root: apt install libjpeg-dev" >&2
  }
fi
touch "$folder/stamp"

#!/bin/bash
# Unpacks pinned packages of Debian 12 (amd64) without root: debian_packages.sh LIST FOLDER
# LIST holds a line "sha256  file" for each package, # begins a comment. FOLDER/root receives the contents of those that
# are not installed in this very version. A package that the archive no longer has in this version may be installed in
# another one; else the reason is one line on stderr.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly list=$PWD/$1 folder=$2

[ "$(dpkg --print-architecture 2>/dev/null)" = amd64 ] || { echo "this is no Debian amd64 to fetch packages for" >&2; exit 1; }

# Falls back on package lists of our own: a container image often ships none.
download() {  # NAME=VERSION, into the current folder
  apt-get download -qq "$1" 2>apt.log && return
  mkdir -p lists/partial cache/archives/partial
  local options=(-qq -o Dir::State::lists="$PWD/lists" -o Dir::Cache="$PWD/cache")
  { apt-get update "${options[@]}" && apt-get download "${options[@]}" "$1"; } 2>apt.log
}

mkdir -p "$folder"
cd "$folder"
grep -E '^[0-9a-f]{64}  ' "$list" | while read -r sum deb; do
  IFS=_ read -r name version _ <<<"$deb"
  version=${version/\%3a/:}
  installed=$(dpkg-query -W -f='${db:Status-Status} ${Version}' "$name" 2>/dev/null || true)
  [ "$installed" != "installed $version" ] || continue
  if [ ! -f "$deb" ] && ! download "$name=$version"; then
    [[ $installed != "installed "* ]] || continue
    tail -n 1 apt.log >&2
    exit 1
  fi
  echo "$sum  $deb" | sha256sum --check --quiet --strict >/dev/null 2>&1 ||
    { rm -f "$deb"; echo "$deb is not the pinned package" >&2; exit 1; }
  dpkg -x "$deb" root
done

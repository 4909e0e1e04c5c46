#!/bin/bash
# Finds a Chromium for the tests of the HTML pages, or unpacks Debian's into build/tools/browser, without root.
# Prints the path of the program. The tests that need a browser are skipped, with that reason, where there is none.
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=build/tools/browser

fail() {
  echo "setup: no browser: $1 (Debian as root: apt install chromium)" >&2
  exit 1
}

works() { [ -x "$1" ] && "$1" --version >/dev/null 2>&1; }

for name in chromium chromium-browser google-chrome-stable google-chrome; do
  if program=$(command -v "$name") && works "$program"; then
    echo "$program"
    exit
  fi
done
program=$PWD/$folder/chromium
if ! works "$program"; then
  command -v apt-get >/dev/null || fail "none is installed, and this is no Debian to fetch it from"
  rm -rf "$folder"
  mkdir -p "$folder/packages" "$folder/root" "$folder/lists/partial" "$folder/cache/archives/partial"
  # Package lists of our own: a container image often ships none. apt checks signatures as ever.
  options=(-qq -o "Dir::State::lists=$PWD/$folder/lists" -o "Dir::Cache=$PWD/$folder/cache")
  echo "setup: fetching Chromium (125 MB)" >&2
  apt-get update "${options[@]}" >&2 || fail "apt-get update failed"
  packages=$(apt-get install "${options[@]}" --simulate --no-install-recommends chromium |
    sed -n 's/^Inst \([^ ]*\) .*/\1/p') || fail "apt-get finds no chromium"
  # shellcheck disable=SC2086
  (cd "$folder/packages" && apt-get download "${options[@]}" $packages) >&2 || fail "apt-get download failed"
  for package in "$folder"/packages/*.deb; do dpkg -x "$package" "$folder/root"; done
  rm -rf "$folder/packages" "$folder/lists" "$folder/cache"
  root=$PWD/$folder/root
  libraries=$root/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH 2>/dev/null || echo "$(uname -m)-linux-gnu")
  printf '#!/bin/sh\nLD_LIBRARY_PATH=%q exec %q "$@"\n' "$libraries:$libraries/pulseaudio" "$root/usr/lib/chromium/chromium" >"$program"
  chmod +x "$program"
  works "$program" || fail "the unpacked one does not start"
fi
echo "$program"

#!/bin/bash
# A compiler for AArch64 and an emulator of it, without root: build/tools/aarch64/gcc and build/tools/aarch64/run.
# They call what is installed, or what is unpacked here from the pinned packages of Debian 12 (95 MB).
set -euo pipefail
cd "$(dirname "$0")/.."
readonly folder=$PWD/build/tools/aarch64 list=scripts/requirements/aarch64.txt
readonly root=$folder/root
sysroot=/

mkdir -p "$folder"
gcc=$(command -v aarch64-linux-gnu-gcc || true)
qemu=$(command -v qemu-aarch64-static || command -v qemu-aarch64 || true)
if [ -z "$gcc" ] || [ -z "$qemu" ]; then
  if ! cmp -s $list "$folder/pinned.txt"; then
    echo "setup: unpacking GCC for AArch64 and qemu into build/tools/aarch64"
    rm -rf "$root"
    reason=$(scripts/debian_packages.sh $list build/tools/aarch64 2>&1) || {
      echo "setup: GCC for AArch64 cannot be had: $reason. On Debian as root: apt install gcc-aarch64-linux-gnu qemu-user-static" >&2
      exit 1
    }
    cp $list "$folder/pinned.txt"
  fi
  gcc=$root/usr/bin/aarch64-linux-gnu-gcc-12
  sysroot=$root
  qemu=$root/usr/bin/qemu-aarch64-static
fi
{
  echo '#!/bin/bash'
  printf 'LD_LIBRARY_PATH=%q exec %q --sysroot=%q "$@"\n' "$root/usr/lib/x86_64-linux-gnu" "$gcc" "$sysroot"
} >"$folder/gcc"
printf '#!/bin/bash\nexec %q -L %q "$@"\n' "$qemu" "${sysroot%/}/usr/aarch64-linux-gnu" >"$folder/run"
chmod +x "$folder/gcc" "$folder/run"

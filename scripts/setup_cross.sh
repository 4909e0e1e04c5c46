#!/bin/bash
# A compiler for another processor and an emulator of it, without root: setup_cross.sh aarch64|armhf|riscv64 makes
# build/tools/NAME/gcc and build/tools/NAME/run. They call what is installed, or what is unpacked here from the pinned
# packages of Debian 12 (95 MB).
set -euo pipefail
cd "$(dirname "$0")/.."
readonly name=$1
case $name in
  aarch64) triple=aarch64-linux-gnu emulator=aarch64 ;;
  armhf) triple=arm-linux-gnueabihf emulator=arm ;;
  riscv64) triple=riscv64-linux-gnu emulator=riscv64 ;;
  *) echo "setup: no such processor: $name" >&2; exit 2 ;;
esac
readonly folder=$PWD/build/tools/$name list=scripts/requirements/$name.txt
readonly root=$folder/root
sysroot=/

mkdir -p "$folder"
gcc=$(command -v $triple-gcc || true)
qemu=$(command -v qemu-$emulator-static || command -v qemu-$emulator || true)
if [ -z "$gcc" ] || [ -z "$qemu" ]; then
  if ! cmp -s "$list" "$folder/pinned.txt"; then
    echo "setup: unpacking GCC for $name and qemu into build/tools/$name"
    rm -rf "$root"
    reason=$(scripts/debian_packages.sh "$list" "build/tools/$name" 2>&1) || {
      echo "setup: GCC for $name cannot be had: $reason. On Debian as root: apt install gcc-$triple qemu-user-static" >&2
      exit 1
    }
    cp "$list" "$folder/pinned.txt"
  fi
  gcc=$root/usr/bin/$triple-gcc-12
  sysroot=$root
  qemu=$root/usr/bin/qemu-$emulator-static
fi
{
  echo '#!/bin/bash'
  printf 'LD_LIBRARY_PATH=%q exec %q --sysroot=%q "$@"\n' "$root/usr/lib/x86_64-linux-gnu" "$gcc" "$sysroot"
} >"$folder/gcc"
printf '#!/bin/bash\nexec %q -L %q "$@"\n' "$qemu" "${sysroot%/}/usr/$triple" >"$folder/run"
chmod +x "$folder/gcc" "$folder/run"

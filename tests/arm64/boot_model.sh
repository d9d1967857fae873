#!/usr/bin/env bash
# The bootloader's decision code cross-compiled for arm64 without heap, log and exceptions, run under qemu-user beside the
# host's build with libsodium: the same slots, the same control blocks, digest by digest.
# usage: boot_model.sh SOURCE_DIR WORK_DIR BIN_DIR; exit 77: skipped.
set -euo pipefail
source_dir=$1 work_dir=$2 bin_dir=$3
cross=aarch64-linux-gnu
for tool in $cross-g++ qemu-aarch64; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: $tool is missing; install g++-aarch64-linux-gnu and qemu-user"
    exit 77
  fi
done
mkdir -p "$work_dir/include"
ln -sfn /usr/include/tl "$work_dir/include/tl"
cd "$source_dir"

# What a bootloader takes.
sources=(firmware/boot/*.cpp firmware/boot/bare/*.cpp protocol/image/{manifest,trust}.cpp)
bare=(-std=c++20 -Os -Wall -Wextra -Werror -fno-exceptions -fno-rtti -fno-threadsafe-statics -I. -isystem "$work_dir/include")
compile() { # SOURCE FLAGS...
  local object=$work_dir/${1//\//_}.o
  $cross-g++ -c "$1" -o "$object" "${@:2}" && echo "$object"
}
objects=()
for s in "${sources[@]}"; do objects+=("$(compile "$s" "${bare[@]}")"); done
$cross-ld -r -o "$work_dir/boot_set.o" "${objects[@]}"

# Nothing is asked of the outside but to copy, fill and compare memory. Control: code that makes texts asks for more.
beyond_memory() { $cross-nm -u "$1" | awk '{print $2}' | grep -vxE 'mem(cpy|move|set|cmp)|bcmp' || true; }
asked=$(beyond_memory "$work_dir/boot_set.o")
if [ -n "$asked" ]; then
  echo "the boot code asks for more than memory functions:" && $cross-c++filt <<<"$asked" && exit 1
fi
if [ -z "$(beyond_memory "$(compile protocol/base/result.cpp -std=c++20 -Os -I. -isystem "$work_dir/include")")" ]; then
  echo "control: code with std::string was not caught" && exit 1
fi

# Of protocol/base it includes these headers only. Control: the log is another.
allowed='protocol/base/(bytes|crc32|sha256|result)\.hpp'
other_headers() { $cross-g++ -std=c++20 -I. -isystem "$work_dir/include" -MM "$@" 2>/dev/null | grep -oE 'protocol/base/[a-z0-9_]+\.hpp' | grep -vxE "$allowed" || true; }
found=$(other_headers "${sources[@]}" | sort -u)
if [ -n "$found" ]; then echo "the boot code includes $found" && exit 1; fi
if [ -z "$(other_headers protocol/base/file.cpp)" ]; then echo "control: another header was not caught" && exit 1; fi
echo "boot code for arm64: $($cross-size "$work_dir/boot_set.o" | awk 'NR == 2 {print $1 " bytes of code and constants, " $2 + $3 " of data"}'); no heap, no log, no exceptions"

harness=()
for s in tests/arm64/boot_model.cpp tests/arm64/ed25519_replay.cpp; do
  harness+=("$(compile "$s" -std=c++20 -O2 -Wall -Wextra -Werror -I. -isystem "$work_dir/include")")
done
$cross-g++ -static "${harness[@]}" "$work_dir/boot_set.o" -o "$work_dir/boot_model"
"$bin_dir/boot_cases" "$work_dir/boot.cases"
"$bin_dir/boot_model" "$work_dir/boot.cases" >"$work_dir/host.txt"
qemu-aarch64 "$work_dir/boot_model" "$work_dir/boot.cases" >"$work_dir/arm64.txt"
echo "host:  $(tail -1 "$work_dir/host.txt")"
echo "arm64: $(tail -1 "$work_dir/arm64.txt")"
diff "$work_dir/host.txt" "$work_dir/arm64.txt"
for answer in A B recovery; do
  grep -q ": $answer," "$work_dir/host.txt" || { echo "no case ends in $answer: the cases show too little" && exit 1; }
done
# Control: one wrong bit in an image is told by both.
printf '\x55' | dd of="$work_dir/boot.cases" bs=1 seek=20000 conv=notrunc status=none
qemu-aarch64 "$work_dir/boot_model" "$work_dir/boot.cases" >"$work_dir/damaged.txt"
if cmp -s "$work_dir/arm64.txt" "$work_dir/damaged.txt"; then echo "control: a damaged image went unnoticed" && exit 1; fi

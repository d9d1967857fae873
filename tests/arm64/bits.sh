#!/usr/bin/env bash
# Cross-compiles the decoder, the fused model and its registration for arm64, runs them on drawn bursts under qemu-user,
# and asks for the bits that x86-64 gives.
# Loops stay NEON's: Highway's one static target there. usage: bits.sh SOURCE_DIR WORK_DIR; exit 77: skipped.
set -euo pipefail
source_dir=$1 work_dir=$2
compiler=aarch64-linux-gnu-g++
for tool in "$compiler" qemu-aarch64; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: $tool is missing; install g++-aarch64-linux-gnu and qemu-user"
    exit 77
  fi
done

# Header-only libraries, apart from this machine's own headers, which are another architecture's.
mkdir -p "$work_dir/include"
for headers in nlohmann tl hwy eigen3/Eigen; do
  ln -sfn "/usr/include/$headers" "$work_dir/include/${headers##*/}"
done

cd "$source_dir"
mapfile -t decoder < <(find pipeline/decode -name '*.cpp' ! -name decode_maps.cpp | sort)
mapfile -t model < <(find calib/model -name '*.cpp' ! -name mount_file.cpp ! -name json_seal.cpp | sort)
mapfile -t fused < <(find pipeline/model/fuse pipeline/register/icp -name '*.cpp' | sort)
parts=("${model[@]}" protocol/base/{result,check,file,image_blocks}.cpp firmware/boot/bare/crc32.cpp "${decoder[@]}" "${fused[@]}")
programs=(decode_bits model_bits)
sources=("${programs[@]/%/.cpp}")
sources=("${sources[@]/#/tests/arm64/}" "${parts[@]}")
flags=(-std=c++20 -O2 -DNDEBUG -ffp-contract=off -fno-fast-math -fno-math-errno -fno-trapping-math
  -DHWY_COMPILE_ONLY_STATIC -I. -isystem "$work_dir/include")
export compiler work_dir
printf '%s\n' "${sources[@]}" |
  xargs -P "$(nproc)" -I{} bash -c '"$compiler" "$@" -c {} -o "$work_dir/$(tr / _ <<<{}).o"' _ "${flags[@]}"
objects=()
for s in "${parts[@]}"; do objects+=("$work_dir/${s//\//_}.o"); done
for program in "${programs[@]}"; do
  "$compiler" -static "$work_dir/tests_arm64_$program.cpp.o" "${objects[@]}" -o "$work_dir/$program"
  qemu-aarch64 "$work_dir/$program"
done

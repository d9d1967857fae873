#!/usr/bin/env bash
# A probe's package is built, holds what it must and runs on another instruction set's processor.
# usage: arm64.sh SOURCE_DIR WORK_DIR BIN_DIR; exit code 77: skipped.
set -euo pipefail
source_dir=$1 work=$2 bin=$3
here=$source_dir/tests/package
command -v qemu-aarch64 >/dev/null || { echo "skipped: qemu-aarch64 is missing; run tools/setup/install-deps.sh" && exit 77; }
sysroot=$("$source_dir/tools/setup/arm64-sysroot")
rm -rf "$work/out" "$work/again" "$work/tree"
mkdir -p "$work"

"$source_dir/tools/package-probe" --build "$work/build" --out "$work/out"
"$source_dir/tools/package-probe" --build "$work/build" --out "$work/again" >/dev/null
deb=$(echo "$work"/out/*.deb)
cmp "$deb" "$work/again/${deb##*/}" || { echo "the same sources gave other bytes" && exit 1; }
"$here/check_package" "$deb" "$sysroot/shlibs"

# Controls: packages that must be refused, each for its own reason.
refused() { # WHY
  local said
  sed -i 's/^Version: .*/Version: 0/' "$work/tree/DEBIAN/control"
  dpkg-deb --root-owner-group -Znone --build "$work/tree" "$work/bad.deb" >/dev/null
  if said=$("$here/check_package" "$work/bad.deb" "$sysroot/shlibs" 2>&1); then echo "control: taken with $1" && exit 1; fi
  grep -q "fault: .*$1" <<<"$said" || { echo "control: not refused for $1, but:" && echo "$said" && exit 1; }
  rm -rf "$work/tree"
}
unpack() { dpkg-deb -R "$deb" "$work/tree"; }
cross="aarch64-linux-gnu-gcc --sysroot=$sysroot -x c -"
unpack
$cross -shared -fPIC -Wl,-soname,libopencv_core.so.406 -o "$work/libopencv_core.so" <<<'int image(void) { return 0; }'
$cross -s -o "$work/tree/usr/bin/enamel-probe" -L"$work" -lopencv_core <<<'int image(void); int main(void) { return image(); }'
refused libopencv_core
unpack
cp "$bin/enamel-probe" "$work/tree/usr/bin/"
refused 'a simulator in it'
unpack
install -D -m 644 "$source_dir/config/probe/ov9281.toml" "$work/tree/etc/enamel/probe.toml"
refused 'a file in /etc'

unpack
probe() { qemu-aarch64 -L "$sysroot" "$work/tree/usr/bin/enamel-probe" "$@" >"$work/said" 2>&1; }
probe --help || { cat "$work/said" && exit 1; }
grep -q 'acquisition process' "$work/said"
# What its unit asks of it, it knows.
unit=$work/tree/lib/systemd/system/enamel-probe.service
# shellcheck disable=SC2013 # words are what is wanted
for option in $(sed -n 's/^Exec[A-Za-z]*=//p' "$unit" | grep -oE -e '--[a-z-]+' | sort -u); do
  grep -qe "$option\b" "$work/said" || { echo "the unit says $option, which the program does not know" && exit 1; }
done
expect() { # CODE TEXT ARGUMENT...
  local code=0
  probe "${@:3}" || code=$?
  [ "$code" -eq "$1" ] && grep -qe "$2" "$work/said" && return 0
  echo "enamel-probe ${*:3}: exit code $code, wanted $1 and '$2'; it said:" && cat "$work/said" && exit 1
}
expect 3 'simulates nothing' --twin mouth.toml
# Emulation sees this machine's devices.
if compgen -G '/dev/video*' >/dev/null; then
  echo "this machine has video devices: not asked for a list without any"
else
  expect 3 'no camera: ' --camera list
fi
expect 2 'nowhere.toml' --profile nowhere.toml --serial A

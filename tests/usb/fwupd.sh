#!/bin/sh
# fwupd.sh ENAMEL_SIGN: fwupd's own tool, without its daemon, takes what `enamel-sign package` makes, and refuses what is broken.
# Exit 77: skipped, because fwupdtool is not installed.
set -eu
sign=$1
command -v fwupdtool >/dev/null || {
  echo "skipped: fwupdtool is not installed (package fwupd)"
  exit 77
}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export HOME="$work" XDG_CACHE_HOME="$work" XDG_CONFIG_HOME="$work" STATE_DIRECTORY="$work" CACHE_DIRECTORY="$work"

fail() {
  echo "$1"
  cat "$work/out"
  exit 1
}
accepts() {
  fwupdtool "$@" >"$work/out" 2>&1 || fail "fwupdtool $1 refused it"
}
refuses() {
  if fwupdtool "$@" >"$work/out" 2>&1; then fail "fwupdtool $1 took it"; fi
}
says() {
  grep -qF -- "$1" "$work/out" || fail "fwupdtool does not say: $1"
}

head -c 300000 /dev/urandom >"$work/payload"
"$sign" keygen --out "$work/key" >/dev/null
"$sign" sign --key "$work/key" --payload "$work/payload" --version 2.5.0+7 --counter 3 --hardware 1:3 \
  --build-time 1767225600 --out "$work/firmware.enfw" >/dev/null
"$sign" package "$work/firmware.enfw" --out "$work/ours.cab" --metainfo "$work/firmware.metainfo.xml" >"$work/guid"
"$sign" package "$work/firmware.enfw" --out "$work/again.cab" >/dev/null
cmp "$work/ours.cab" "$work/again.cab"

# The GUID by a second implementation of UUID version 5.
guid=$(/usr/bin/python3 -c 'import uuid; print(uuid.uuid5(uuid.NAMESPACE_DNS, "USB\\VID_1209&PID_0001"))')
cp "$work/guid" "$work/out"
says "$guid"

accepts firmware-parse "$work/firmware.enfw" dfu
says "<vendor>0x1209</vendor>"
says "<release>0x205</release>"
accepts build-cabinet "$work/theirs.cab" "$work/firmware.enfw" "$work/firmware.metainfo.xml"
for cabinet in theirs ours; do
  accepts firmware-parse "$work/$cabinet.cab" cab
  says "firmware.enfw"
  accepts get-details "$work/$cabinet.cab"
  says "$guid"
  says "New version:      2.5"
  says "Firmware 2.5.0+7, security counter 3."
done
cp "$work/firmware.metainfo.xml" "$work/out"
says '<value key="LVFS::UpdateProtocol">org.usb.dfu</value>'
says '<value key="LVFS::VersionFormat">pair</value>'

# Controls: metainfo that is no XML, a suffix whose CRC is wrong, a cabinet cut short.
sed 's,</provides>,,' "$work/firmware.metainfo.xml" >"$work/broken.metainfo.xml"
refuses build-cabinet "$work/broken.cab" "$work/firmware.enfw" "$work/broken.metainfo.xml"
{ head -c 1000 "$work/firmware.enfw" && printf x && tail -c +1002 "$work/firmware.enfw"; } >"$work/altered.enfw"
refuses firmware-parse "$work/altered.enfw" dfu
if "$sign" package "$work/altered.enfw" --out "$work/altered.cab" >"$work/out" 2>&1 || [ -e "$work/altered.cab" ]; then
  fail "enamel-sign package took an altered image"
fi
head -c 100000 "$work/ours.cab" >"$work/short.cab"
refuses get-details "$work/short.cab"
echo "fwupdtool takes image, metainfo and cabinet, and refuses the broken ones"

#!/usr/bin/env bash
# systemd takes the probe's unit without a word, and its user can be made. usage: unit_file.sh SOURCE_DIR; exit 77: skipped.
set -euo pipefail
units=$1/firmware/systemd
for tool in systemd-analyze systemd-sysusers; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is missing; it comes with systemd" && exit 77; }
done
# The units that ours names, as this machine has them; programs that are there.
system=/lib/systemd/system
[ -f $system/sysinit.target ] || { echo "skipped: no units in $system" && exit 77; }
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
mkdir -p "$root$system" "$root"/{usr/bin,etc}
cp -r $system/. "$root$system/"
install -m 755 /dev/stdin "$root/usr/bin/enamel-probe" <<<'#!/bin/sh'

# What it does not understand systemd leaves out, and says so with exit code 0.
verify() { # NAME
  local said
  said=$(SYSTEMD_LOG_LEVEL=warning systemd-analyze verify --man=no --root="$root" "$1" 2>&1) && [ -z "$said" ] && return 0
  echo "${said:-ended with an error}" && return 1
}
cp "$units/enamel-probe.service" "$root$system/"
verify enamel-probe.service || { echo "the unit is not clean" && exit 1; }

# Controls: each damaged in one place.
damages=(
  's/^NoNewPrivileges/NoNewPrivilege/'
  's/^DevicePolicy=.*/DevicePolicy=shut/'
  's/^SystemCallFilter=.*/SystemCallFilter=@no-such-group/'
  's|^ExecStopPost=/usr/bin/enamel-probe|ExecStopPost=/usr/bin/enamel-dark|'
)
for damage in "${damages[@]}"; do
  sed "$damage" "$units/enamel-probe.service" >"$root$system/damaged.service"
  ! cmp -s "$units/enamel-probe.service" "$root$system/damaged.service" || { echo "control: $damage does nothing" && exit 1; }
  if verify damaged.service; then echo "control: $damage went unnoticed" && exit 1; fi
done

systemd-sysusers --root="$root" "$units/enamel-probe.sysusers" >/dev/null 2>&1
# shellcheck disable=SC2013 # words are what is wanted
for name in $(sed -n 's/^\(User\|Group\|SupplementaryGroups\)=//p' "$units/enamel-probe.service"); do
  grep -q "^$name:" "$root/etc/group" || { echo "no group $name is made" && exit 1; }
done
grep -q '^enamel:' "$root/etc/passwd" || { echo "no user enamel is made" && exit 1; }

#!/usr/bin/env bash
# Installs what packages.txt names and this machine lacks. Needs root only when something is missing.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

mapfile -t wanted < <(sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$here/packages.txt")
# npm comes with Node.js on many machines; Debian's npm conflicts with such an installation.
command -v npm >/dev/null || wanted+=(npm nodejs)

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  exit 0
fi

echo "installing ${#missing[@]} missing Debian packages: ${missing[*]}" >&2
sudo=""
if [ "$(id -u)" -ne 0 ]; then
  sudo=$(command -v sudo) || {
    echo "error: packages are missing and neither root nor sudo is at hand." >&2
    echo "remedy: as root run: apt-get install -y --no-install-recommends ${missing[*]}" >&2
    exit 2
  }
fi
$sudo apt-get update -qq
DEBIAN_FRONTEND=noninteractive $sudo apt-get install -y -qq --no-install-recommends \
  -o DPkg::Lock::Timeout=600 -o Dpkg::Use-Pty=0 "${missing[@]}" >&2

#!/bin/sh
# run.sh WRITER SAME WORK_FOLDER: makes recordings with WRITER and reads them with independent readers from npm; has the
# official writer write them in other forms, and SAME read those.
# Exit 77: skipped, because npm or its registry is not to be had.
set -eu
writer=$1
same=$2
work=$3
here=$(cd "$(dirname "$0")" && pwd)

skip() {
  echo "skipped: $1"
  exit 77
}
command -v node >/dev/null && command -v npm >/dev/null || skip "node and npm are not installed"
mkdir -p "$work"
cmp -s "$here/package-lock.json" "$work/installed.json" || {
  cp "$here/package.json" "$here/package-lock.json" "$here/.npmrc" "$work/"
  (cd "$work" && npm ci --no-progress >npm.log 2>&1) || skip "npm ci failed: $(tail -n 3 "$work/npm.log")"
  cp "$here/package-lock.json" "$work/installed.json"
}
for mode in zstd plain; do
  "$writer" "$mode" "$work/$mode.mcap" "$work/$mode.json"
  node "$here/read_capture.js" "$work" "$work/$mode.mcap" "$work/$mode.json"
done

# The comparison can fail: one digit of one value, one pixel, one bit of the file.
must_fail() {
  if node "$here/read_capture.js" "$work" "$1" "$2" >"$work/control.log" 2>&1; then
    echo "negative control '$3' was not noticed"
    exit 1
  fi
  echo "control '$3': $(head -n 1 "$work/control.log")"
}
python3 - "$work" <<'PY'
import json, sys
work = sys.argv[1]
good = open(f"{work}/zstd.json").read()
def change(name, edit):
    data = json.loads(good)
    edit(data)
    json.dump(data, open(f"{work}/{name}.json", "w"))
def digit(data):
    burst = data["messages"]["enamel/v1/burst"][2]["value"]
    burst["t_publish_ns"] = str(int(burst["t_publish_ns"]) ^ 1)
def pixel(data):
    burst = data["messages"]["enamel/v1/burst"][3]["value"]
    burst["payload"] = burst["payload"][:-1] + ("0" if burst["payload"][-1] != "0" else "1")
change("digit", digit)
change("pixel", pixel)
raw = bytearray(open(f"{work}/plain.mcap", "rb").read())
raw[len(raw) // 2] ^= 1
open(f"{work}/bit.mcap", "wb").write(raw)
PY
must_fail "$work/zstd.mcap" "$work/digit.json" "one digit"
must_fail "$work/zstd.mcap" "$work/pixel.json" "one pixel"
must_fail "$work/bit.mcap" "$work/plain.json" "one bit of the file"

mkdir -p "$work/forms"
node "$here/write_variants.js" "$work" "$work/plain.mcap" "$work/forms" >"$work/forms.txt"
# shellcheck disable=SC2046  # names without blanks, of our own making
"$same" "$work/plain.mcap" $(grep -v control "$work/forms.txt")
if "$same" "$work/plain.mcap" "$work/forms/control.mcap" >"$work/control.log"; then
  echo "negative control 'one message less' was not noticed"
  exit 1
fi
echo "control 'one message less': $(cat "$work/control.log")"

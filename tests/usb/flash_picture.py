#!/usr/bin/env python3
"""flash_picture.py BIN_FOLDER OUT.svg: a picture of a batch update, from a real run of enamel-flash on a terminal of its own.

Three emulated probes: one is healthy, one stalls, one is pulled at 30 % and plugged in again. What the tool writes is kept with
the screen it makes; shown are the moment before the pulled probe is back and the end. SIMULATION: the probes and the bus.
"""
import html
import json
import os
import pathlib
import pty
import re
import subprocess
import sys
import tempfile

WRAPPER = "/usr/bin/umockdev-wrapper"
PAYLOAD = 4 << 20
PULL_AT = 309  # of 1028 blocks
PROBES = [{}, {"stalls_at_block": 250, "stall_count": 1}, {"pull_at_block": PULL_AT, "replug_ms": 1500}]
CHARACTER, LINE, MARGIN = 8.4, 18, 14  # px
STEP = re.compile(rb"\x1b\[(\d*)([AK])|\r|\n|[^\x1b\r\n]+")


class Screen:
    """As much of a terminal as the tool uses: carriage return, line feed, cursor up, clear to the end of the line."""

    def __init__(self):
        self.lines, self.row = [""], 0

    def feed(self, data):
        for m in STEP.finditer(data):
            if m.group(2) == b"A":
                self.row = max(0, self.row - int(m.group(1) or b"1"))
            elif m.group(2) == b"K":
                self.lines[self.row] = ""
            elif m.group(0) == b"\n":
                self.row += 1
                if self.row == len(self.lines):
                    self.lines.append("")
            elif m.group(0) != b"\r":
                self.lines[self.row] = m.group(0).decode()


def record(argv):
    """Screens of a run, one after each write, and its exit code."""
    main, side = pty.openpty()
    child = subprocess.Popen(argv, stdin=side, stdout=side, stderr=side, close_fds=True)
    os.close(side)
    screen, shots = Screen(), []
    while True:
        try:
            data = os.read(main, 65536)
        except OSError:  # Linux: the terminal has no other end any more
            break
        if not data:
            break
        screen.feed(data)
        shots.append(list(screen.lines))
    return shots, child.wait()


def middle(shots):
    """The last screen on which one probe is gone and the others are sending."""
    def fits(lines):
        return sum("gone" in line for line in lines) == 1 and sum("sending" in line for line in lines) == len(PROBES) - 1

    found = [lines for lines in shots if fits(lines)]
    return found[-1] if found else sys.exit("the probe was not seen to be gone while the others were sending")


def panel(title, lines, top):
    out = [f'<text x="{MARGIN}" y="{top}" class="title">{html.escape(title)}</text>']
    for i, line in enumerate(lines):
        if line:
            out.append(f'<text x="{MARGIN}" y="{top + (i + 1) * LINE}" textLength="{len(line) * CHARACTER:.1f}" xml:space="preserve">'
                       f"{html.escape(line)}</text>")
    return out, top + (len(lines) + 2) * LINE


def picture(panels):
    body, top = [], MARGIN + LINE
    for title, lines in panels:
        part, top = panel(title, lines, top)
        body += part
    width = max(len(line) for _, lines in panels for line in lines) * CHARACTER + 2 * MARGIN
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{top - LINE // 2}" font-family="DejaVu Sans Mono, monospace"'
        ' font-size="14" fill="#d8dee9">', "<style>.title { fill: #88c0d0; font-weight: bold }</style>",
        '<rect width="100%" height="100%" rx="6" fill="#2e3440"/>', *body, "</svg>", ""])


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    binaries, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        image = folder / "release-2.0.0.enfw"
        os.environ["PATH"] = f"{binaries}:{os.environ['PATH']}"
        command = "flash --all --jobs 3 release-2.0.0.enfw"
        probes = [word for p in PROBES for word in ("--probe", json.dumps(p))]
        os.chdir(folder)
        shots, code = record([WRAPPER, binaries / "usb_bench", "--image", image, "--image-bytes", str(PAYLOAD), *probes, "--",
                              "enamel-flash", *command.split()])
    end = [line for line in shots[-1] if line]
    if code != 0 or sum("-> 2.0.0+0, confirmed" in line for line in end) != len(PROBES):
        sys.exit(f"exit code {code}:\n" + "\n".join(end))
    said = f"$ enamel-flash {command}"
    out.write_text(picture([(said, [line for line in middle(shots) if line]), (f"{said}     (the end)", end)]), encoding="utf-8")


if __name__ == "__main__":
    main()

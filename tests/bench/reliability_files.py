"""Power cuts, full disks and damage to recordings, for tools/bench-reliability: one dictionary of facts a trial."""
import json
import os
import shutil
import struct

from reliability_live import holds, notes, run

PAGE, CHUNK = 4096, 100_000
DAMAGE_CODES = (0, 2, 4)  # whole, nothing usable, not whole: each told


class PowerCut:
    """Images of a recording as a disk may hold it after its power was cut, from the log of its writes and syncs."""

    def __init__(self, recording, shim_log):
        with open(recording, "rb") as f:
            self.bytes = f.read()
        log = notes(shim_log)
        self.writes = [n for n in log if n[0] == 1]
        self.syncs = [n for n in log if n[0] == 3]
        at = 0
        for _, _, offset, size in self.writes:  # appended only, or the images would be of another file
            if offset != at:
                raise RuntimeError(f"a recording is not written in order: {offset} after {at}")
            at = offset + size
        if at != len(self.bytes):
            raise RuntimeError(f"{at} bytes written, {len(self.bytes)} in the file")

    def image(self, path, rng):
        """At a random instant between the first burst and the end. Returns (ns, how, bytes synced, bytes written)."""
        big = [w for w in self.writes if w[3] > CHUNK]
        at_ns = rng.randrange(big[0][1], self.writes[-1][1] + 200_000_000)
        written = max((w[2] + w[3] for w in self.writes if w[1] <= at_ns), default=0)
        # What was written when the last sync that is over began, is safe.
        begun_ns = max((s[2] for s in self.syncs if s[1] <= at_ns), default=0)
        synced = max((w[2] + w[3] for w in self.writes if w[1] <= begun_ns), default=0)
        how = rng.choice(["cut at what was synced", "pages lost", "size short and pages lost"])
        size = {"cut at what was synced": synced, "pages lost": written}.get(how) if how[0] != "s" else rng.randint(synced, written)
        data = bytearray(self.bytes[:size])
        share = rng.random()
        for page in range(-(-synced // PAGE) * PAGE, size, PAGE):  # the page that the sync ended in is whole up to there
            if rng.random() < share:
                data[page:page + PAGE] = bytes(min(PAGE, size - page))
        with open(path, "wb") as f:
            f.write(data)
        return at_ns, how, synced, written

    def trial(self, given, folder, rng):
        path = os.path.join(folder, "image.mcap")
        at_ns, how, synced, written = self.image(path, rng)
        kept = holds(given, path)
        repaired = os.path.join(folder, "repaired.mcap")
        ran = run(given.program("enamel"), "capture", "repair", path, repaired, "--force", "--json")
        try:
            bursts = json.loads(ran.stdout)["bursts"]
        except ValueError:
            bursts = 0
        times = [w[1] for w in self.writes if w[3] > CHUNK and w[1] <= at_ns]
        last = times[bursts - 1] if bursts else times[0] - 1
        # The first burst's write, cut before any sync, leaves nothing to open: of no more than a second of scan.
        young = at_ns - times[0] <= 1_000_000_000
        return {"how": how, "unsynced_bytes": written - synced, "bursts": len(times), "kept": bursts,
                "lost_s": max(0, at_ns - last) * 1e-9 if bursts < len(times) else 0.0,
                "cannot_open": not kept["opens"] and not young, "problems": kept["problems"], "code": ran.returncode}


def on_small_disk(folder, size, work):
    """work(mount point) on a tmpfs of so many bytes; None where none can be mounted."""
    place = os.path.join(folder, "disk")
    os.makedirs(place, exist_ok=True)
    if run("mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", place).returncode != 0:
        return None
    try:
        return work(place)
    finally:
        run("umount", "-l", place)


def whole(given, path):
    """Whether a file that is there under its final name is all there, as far as its kind can tell."""
    name, size = os.path.basename(path), os.path.getsize(path)
    with open(path, "rb") as f:
        data = f.read()
    if name.endswith(".json"):
        try:
            json.loads(data)
            return True
        except ValueError:
            return False
    if name.endswith(".stl"):
        return size >= 84 and size == 84 + 50 * struct.unpack_from("<I", data, 80)[0]
    if name.endswith(".png"):
        return data.endswith(b"IEND\xaeB`\x82")
    if name.endswith(".mcap"):
        return holds(given, path)["opens"]
    if name.endswith(".ply"):
        return b"end_header\n" in data and run(given.program("enamel"), "compare", path, path, "--out", given.scratch).returncode == 0
    return data.endswith(b"\n") if name.endswith((".csv", ".obj", ".mtl")) else size > 0


class FullDisk:
    """Commands that run out of space at a random byte of what they write."""

    def __init__(self, given, folder, session):
        self.given, self.folder = given, folder
        enamel, recording = given.program("enamel"), os.path.join(session, "capture.mcap")
        self.short = os.path.join(folder, "short.mcap")
        run(enamel, "capture", "cut", recording, self.short, "--last", "12")
        self.exchange = os.path.join(folder, "exchange")
        run(enamel, "capture", "export", self.short, self.exchange)
        with open(self.short, "rb") as f:
            data = f.read()
        self.damaged = os.path.join(folder, "damaged.mcap")
        with open(self.damaged, "wb") as f:
            f.write(data[:len(data) * 9 // 10])
        # What each command writes: its place stands for {}.
        self.commands = {
            "replay": [enamel, "replay", self.short, "--out", "{}/out", "--headless"],
            "export stl": [enamel, "export", session, "--out", "{}/a.stl"],
            "export obj": [enamel, "export", session, "--format", "obj", "--out", "{}/a.obj"],
            "cut": [enamel, "capture", "cut", self.short, "{}/cut.mcap"],
            "repair": [enamel, "capture", "repair", self.damaged, "{}/repaired.mcap"],
            "import": [enamel, "capture", "import", self.exchange, "{}/imported.mcap"],
            "export folder": [enamel, "capture", "export", self.short, "{}/folder"]}
        self.sizes = {name: self.needed(command) for name, command in self.commands.items()}

    def needed(self, command):
        place = os.path.join(self.folder, "ample")
        os.makedirs(place)
        ran = run(*[c.replace("{}", place) for c in command])
        if ran.returncode not in (0, 4):
            raise RuntimeError(f"{command}: {ran.stderr}")
        size = sum(os.path.getsize(os.path.join(at, n)) for at, _, names in os.walk(place) for n in names)
        shutil.rmtree(place)
        return size

    def judge(self, place, ran, exchange):
        files = [os.path.join(at, n) for at, _, names in os.walk(place) for n in names]
        # A folder without bursts.csv was not finished (docs/recording-format.md): its frames are then no result.
        if exchange and not any(f.endswith("bursts.csv") for f in files):
            files = []
        broken = [f for f in files if f.endswith((".partial", ".reserve")) or not whole(self.given, f)]
        return {"code": ran.returncode, "told": len(ran.stderr.strip()) > 0,
                "half_written": [os.path.relpath(f, place) for f in broken], "said": ran.stderr[-300:]}

    def trial(self, name, rng):
        # A tmpfs counts in pages; nine tenths, so that what a file's last page holds over does not make room for it.
        size = max(PAGE, int(rng.uniform(0.01, 0.9) * self.sizes[name]) // PAGE * PAGE)
        command = self.commands[name]
        facts = on_small_disk(self.folder, size, lambda place: self.judge(
            place, run(*[c.replace("{}", place) for c in command]), name == "export folder"))
        return None if facts is None else {"command": name, "bytes": size, "needed": self.sizes[name], **facts}


def burst_ids(path):
    with open(os.path.join(path, "bursts.csv"), encoding="utf-8") as f:
        return [int(line.split(",")[0]) for line in f.read().splitlines()[1:]]


class Damage:
    """One flipped bit, or an end that is missing, and what `enamel capture repair` brings back."""

    def __init__(self, given, folder, recording):
        self.given, self.folder = given, folder
        self.path = os.path.join(folder, "whole.mcap")
        # Made anew by cut, the whole has no gaps: its bursts are its chunks.
        run(given.program("enamel"), "capture", "cut", recording, self.path, "--last", str(given.damage_bursts - 1))
        with open(self.path, "rb") as f:
            self.bytes = f.read()
        self.bursts = holds(given, self.path)["bursts"]

    def trial(self, flip, rng):
        at = rng.randrange(len(self.bytes))
        data = bytearray(self.bytes)
        if flip:
            data[at] ^= 1 << rng.randrange(8)
        else:
            del data[at:]
        path, out = (os.path.join(self.folder, n) for n in ("harmed.mcap", "mended.mcap"))
        with open(path, "wb") as f:
            f.write(data)
        if os.path.exists(out):
            os.remove(out)
        ran = run(self.given.program("enamel"), "capture", "repair", path, out, "--json", timeout=60)
        try:
            told = json.loads(ran.stdout)
        except ValueError:
            told = {"bursts": 0, "missing": 0, "problems": []}
        # Each burst closes a chunk: those whose chunk ends before the cut are whole.
        return {"flip": flip, "at": at, "share": at / len(self.bytes), "code": ran.returncode, "bursts": told["bursts"],
                "missing": told["missing"], "told": bool(ran.stderr.strip() or told["problems"]),
                "crashed": ran.returncode not in DAMAGE_CODES}

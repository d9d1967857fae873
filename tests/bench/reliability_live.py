"""Live scans with real processes that are killed and stopped on the way, for tools/bench-reliability."""
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import time

ROUND = 40  # bursts in the recording that is played
PATIENCE_S = 240
MONOTONIC = time.CLOCK_MONOTONIC


def say(text):
    print(text, flush=True)


def run(*command, timeout=PATIENCE_S, **more):
    """A program to its end. returncode 124: it had to be killed."""
    try:
        return subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=timeout, check=False, **more)
    except subprocess.TimeoutExpired as hung:
        return subprocess.CompletedProcess(command, 124, "", f"{hung.stderr}\nstill running after {timeout} s")


def load(path):
    try:
        with open(path, encoding="utf-8") as f:
            return json.load(f)
    except (OSError, ValueError):
        return {}


def notes(path):
    """What reliability_shim.c wrote: (kind, ns, a, b)."""
    try:
        with open(path, "rb") as f:
            data = f.read()
    except OSError:
        return []
    count = min(struct.unpack_from("<q", data)[0], len(data) // 32 - 1)
    return [r for r in struct.iter_unpack("<4q", data[32:32 + 32 * count]) if r[0] != 0]


def balanced(bursts):
    """As host/report/accounting.cpp: captured and accepted come out exactly."""
    if not bursts:
        return False
    lost = bursts["lost_on_wire"] + bursts["incomplete"] + bursts["shed"]
    return bursts["captured"] == lost + bursts["accepted"] and \
        bursts["accepted"] == bursts["fused"] + sum(bursts["rejected"].values())


class Live:
    """One folder, one DDS tag: probes and hosts that find each other and nobody else."""
    count = 0

    def __init__(self, given, folder):
        Live.count += 1
        self.given, self.folder = given, os.path.join(folder, f"live{Live.count:03d}")
        self.tag = f"enamel-reliability-{os.getpid()}-{Live.count}"
        self.session = os.path.join(self.folder, "session")
        self.processes, self.files = [], []
        os.makedirs(self.folder)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in self.processes:
            if process.poll() is None:
                process.kill()
            process.wait()
        for f in self.files:
            f.close()
        if not self.given.keep:
            shutil.rmtree(self.folder, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, name, *command):
        out, err = (open(self.path(f"{name}.{kind}"), "w", encoding="utf-8") for kind in ("out", "err"))  # noqa: SIM115
        env = {**os.environ, "LD_PRELOAD": self.given.shim, "RELIABILITY_LOG": self.path(f"{name}.shim")}
        process = subprocess.Popen([str(c) for c in command], stdout=out, stderr=err, env=env, stdin=subprocess.DEVNULL)
        self.processes.append(process)
        self.files += [out, err]
        return process

    def probe(self, name="probe", loops=None, speed=None):
        return self.start(name, self.given.program("enamel-probe"), "--play", self.given.recording, "--serial", "P1", "--dds-tag",
                          self.tag, "--loops", loops or self.given.loops, "--speed",
                          speed or self.given.speed, "--json")

    def host(self, name="host", resume=False):
        return self.start(name, self.given.program("enamel"), "scan", "--headless", "--resume" if resume else "--session",
                          self.session, "--dds-tag", self.tag, *self.given.settings)

    def text(self, name):
        with open(self.path(name), encoding="utf-8", errors="replace") as f:
            return f.read()

    def notes(self, name):
        return notes(self.path(f"{name}.shim"))

    def begun(self, name="probe"):
        """By the probe's own account: its last session's counter, printed at its end."""
        return sum(int(n) for n in re.findall(r"ended: begun=(\d+)", self.text(f"{name}.err")))

    def report(self):
        return load(os.path.join(self.session, "report.json"))

    def parts(self):
        """Recordings of the session, in order."""
        names = [n for n in os.listdir(self.session) if n.endswith(".mcap")] if os.path.isdir(self.session) else []
        return [os.path.join(self.session, n) for n in sorted(names, key=lambda n: (len(n), n))]

    def replay(self):
        out = self.path("replayed")
        ran = run(self.given.program("enamel"), "replay", self.session, "--out", out, "--headless", *self.given.settings)
        return ran, load(os.path.join(out, "report.json"))


def wait(process, patience_s=PATIENCE_S):
    try:
        return process.wait(patience_s)
    except subprocess.TimeoutExpired:
        return None


def holds(given, recording):
    """What verify and info say: (bursts, shed, truncated, damaged)."""
    enamel = given.program("enamel")
    verified, told = run(enamel, "capture", "verify", recording, "--json"), run(enamel, "capture", "info", recording, "--json")
    try:
        v, i = json.loads(verified.stdout), json.loads(told.stdout)
    except ValueError:
        return {"bursts": 0, "shed": 0, "opens": False, "problems": [verified.stderr + told.stderr]}
    return {"bursts": v["bursts"], "shed": i["shed"], "opens": True, "truncated": v["truncated"], "problems": v["problems"],
            "seconds": i["duration_ns"] * 1e-9}


def kill_at(process, delay_s, sign=signal.SIGKILL):
    """Sends the signal after so long, or at once at the process's end. Returns CLOCK_MONOTONIC in ns, None if it had ended."""
    try:
        process.wait(delay_s)
        return None
    except subprocess.TimeoutExpired:
        at = time.clock_gettime_ns(MONOTONIC)
        process.send_signal(sign)
        return at

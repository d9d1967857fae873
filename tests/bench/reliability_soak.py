"""A live scan that goes on for long: memory, open files and threads of the host, and whether every burst is accounted for."""
import os
import signal
import time

from reliability_live import Live, balanced, wait

EVERY_S = 5
SETTLED = 1 / 6  # of the time: what grows at first is caches and the model itself
ENDLESS = 100_000  # rounds
SPEED = 0.1  # two slow cores keep up: where most bursts are shed the scan falls apart, and every segment is remembered


def holds_now(pid):
    """(MB resident, open files, threads) of a process."""
    with open(f"/proc/{pid}/status", encoding="utf-8") as f:
        told = dict(line.split(":", 1) for line in f if ":" in line)
    return int(told["VmRSS"].split()[0]) / 1024, len(os.listdir(f"/proc/{pid}/fd")), int(told["Threads"])


def slope(times, values):
    """Least squares, a unit of time."""
    mean_t, mean_v = sum(times) / len(times), sum(values) / len(values)
    across = sum((t - mean_t) ** 2 for t in times)
    return sum((t - mean_t) * (v - mean_v) for t, v in zip(times, values, strict=True)) / across if across else 0.0


def soak(given, folder):
    """The recording played in rounds for --soak minutes, then Ctrl-C. Without the work after a scan: it is not what goes on."""
    with Live(given, folder) as live:
        probe = live.probe(loops=ENDLESS, speed=SPEED)
        host = live.start("host", given.program("enamel"), "scan", "--headless", "--fast", "--session", live.session, "--dds-tag",
                          live.tag)
        begun, seen = time.monotonic(), []
        while time.monotonic() - begun < 60 * given.soak and host.poll() is None:
            time.sleep(EVERY_S)
            seen.append((time.monotonic() - begun, *holds_now(host.pid)))
        host.send_signal(signal.SIGINT)
        code = wait(host)
        probe.terminate()
        bursts = live.report().get("bursts", {})
        after = [s for s in seen if s[0] > 60 * given.soak * SETTLED]
        minutes = [s[0] / 60 for s in after]
        return {"code": code, "minutes": seen[-1][0] / 60 if seen else 0, "balanced": balanced(bursts), "bursts": bursts,
                "rss_mb": after[-1][1], "rss_mb_a_minute": slope(minutes, [s[1] for s in after]),
                "files": sorted({s[2] for s in after}), "threads": sorted({s[3] for s in after}), "seen": seen}


def rows(page, facts):
    page.section("Scanning on and on", f"A live scan of {facts['minutes']:.0f} minutes, the recording played in rounds; figures of the "
                 "host after a sixth of the time.")
    b = facts["bursts"]
    page.row("bursts scanned", "–", str(b.get("accepted")), None)
    page.row("accounting balanced", "yes", "yes" if facts["balanced"] else "no", facts["balanced"])
    page.row("memory, slope", "–", f"{facts['rss_mb_a_minute']:+.2f} MB a minute, of {facts['rss_mb']:.0f} MB", None)
    page.row("memory, slope a burst", "≤ 1 kB", f"{kilobytes_a_burst(facts):.2f} kB", kilobytes_a_burst(facts) <= 1)
    for what, key in (("files open", "files"), ("threads", "threads")):
        page.row(what, "constant", " to ".join(str(n) for n in facts[key]), len(facts[key]) == 1)


def kilobytes_a_burst(facts):
    """A scan that goes on has more poses and more digests to remember: some hundred bytes a burst."""
    a_minute = facts["bursts"].get("accepted", 0) / max(facts["minutes"], 1e-9)
    return 1024 * facts["rss_mb_a_minute"] / max(a_minute, 1e-9)

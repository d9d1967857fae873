"""What happens to a live scan whose host or probe is killed or stopped: one dictionary of facts a trial."""
import math
import os
import signal
import time

from reliability_live import ROUND, Live, balanced, holds, kill_at, say, wait

CHUNK = 100_000  # a write of more bytes is a burst
PROBE_GONE = 3
SCAN_ENDS = (0, 4)  # 4: data were lost, and that is told


def calm(given, folder):
    """A scan that nothing happens to: how long it takes, bytes a burst on the network, its recording and its log."""
    live = Live(given, folder)
    begun = time.monotonic()
    probe, host = live.probe(), live.host()
    code = wait(host)
    seconds = time.monotonic() - begun
    wait(probe)
    bursts = live.report().get("bursts", {})
    if code not in SCAN_ENDS or not balanced(bursts):
        raise RuntimeError(f"a calm scan ends with {code}: {live.text('host.err')}")
    sent = max(n[2] for n in live.notes("probe") if n[0] == 4)
    say(f"calm: {seconds:.1f} s, {bursts}")
    return {"seconds": seconds, "bytes_a_burst": sent / bursts["captured"], "live": live, "bursts": bursts}


def sent_before(live, at_ns, bytes_a_burst):
    sent = max([n[2] for n in live.notes("probe") if n[0] == 4 and n[1] <= at_ns], default=0)
    return math.floor(sent / bytes_a_burst)


def rebuilt_after(live, name, began_ns):
    """Seconds until the first burst of the new part is written; None when there was none."""
    first = min((n[1] for n in live.notes(name) if n[0] == 1 and n[3] > CHUNK), default=None)
    return None if first is None else (first - began_ns) * 1e-9


def resume(live, facts, probes):
    """`enamel scan --resume`, and the replay of the whole."""
    if all(p.poll() is not None for p in probes):  # the probe's recording is at its end: the probe, though, is still there
        probes.append(live.probe(f"probe{len(probes) + 1}", 1))
    began_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
    code = wait(live.host("again", resume=True))
    for p in probes:
        wait(p)
    facts["played"] = ROUND * (live.given.loops + len(probes) - 1)
    facts["resume_code"] = code
    facts["back_s"] = rebuilt_after(live, "again", began_ns)
    report = live.report()
    ran, replayed = live.replay()
    bursts = report.get("bursts", {})
    names = ["probe"] + [f"probe{n + 1}" for n in range(1, len(probes))]
    facts.update(same_hash=bool(report.get("hash")) and report["hash"] == replayed.get("hash"), balanced=balanced(bursts),
                 captured=bursts.get("captured"), begun=sum(live.begun(n) for n in names), replay_code=ran.returncode,
                 bursts=bursts)
    # A probe whose recording came to its end while the model was rebuilt is gone for good: told, and nothing is missing.
    facts["resumed"] = code in SCAN_ENDS or (code == PROBE_GONE and facts["captured"] == facts["played"])
    if not facts["resumed"] or not facts["same_hash"]:
        facts["said"] = live.text("again.err")[-1500:] + ran.stderr[-500:]


def kill(given, folder, reference, rng):
    """SIGKILL of the host at any instant of a scan."""
    delay_s = rng.uniform(0, 1.05 * reference["seconds"])
    with Live(given, folder) as live:
        probes = [live.probe()]
        host = live.host()
        at_ns = kill_at(host, delay_s)
        wait(host)
        facts = {"delay_s": delay_s, "ended_before": at_ns is None, "kept_bytes": 0}
        first = live.parts()[:1]
        kept = holds(given, first[0]) if first else None
        if kept is not None:
            facts["kept_bytes"] = os.path.getsize(first[0])
            sent = sent_before(live, at_ns, reference["bytes_a_burst"]) if at_ns else kept["bursts"] + kept["shed"]
            facts.update(kept_bursts=kept["bursts"], shed=kept["shed"], missing=max(0, sent - kept["bursts"] - kept["shed"]))
            facts["corrupt"] = bool(kept["problems"]) if kept["opens"] else facts["kept_bytes"] > CHUNK
            facts["problems"] = kept["problems"]
        if at_ns is None:
            return facts
        if kept is None or kept["bursts"] == 0:
            facts["fresh"] = True  # nothing to go on with: the same scan once more, into a new folder
            live.session += "-new"
            if probes[0].poll() is not None:
                probes.append(live.probe("probe2", 1))
            facts["fresh_code"] = wait(live.host("again"))
            facts["fresh_ok"] = facts["fresh_code"] in SCAN_ENDS and balanced(live.report().get("bursts"))
            if not facts["fresh_ok"]:
                facts["said"] = live.text("again.err")[-1500:]
        else:
            facts["fresh"] = False
            resume(live, facts, probes)
        return facts


def probe_killed(given, folder, reference, rng):
    """SIGKILL of the probe during a scan, and a new one that plays a round."""
    delay_s = rng.uniform(1.5, max(2.0, 0.6 * reference["seconds"]))
    with Live(given, folder) as live:
        first = live.probe()
        host = live.host()
        at_ns = kill_at(first, delay_s)
        wait(first)
        time.sleep(rng.uniform(0, 2))
        second = live.probe("probe2", 1)
        code = wait(host)
        wait(second)
        sent = sent_before(live, at_ns, reference["bytes_a_burst"]) if at_ns else live.begun()
        bursts = live.report().get("bursts", {})
        parts = live.parts()
        facts = {"delay_s": delay_s, "code": code, "ended": code in SCAN_ENDS, "balanced": balanced(bursts), "bursts": bursts,
                 "sent_by_first": sent, "begun_by_second": live.begun("probe2"), "parts": len(parts)}
        captured = bursts.get("captured", -1)
        # What a killed probe had begun is not known to the burst: that sent in whole at least, five more at most.
        facts["counted_once"] = -1 <= captured - sent - facts["begun_by_second"] <= 5
        facts["corrupt"] = any(holds(given, p)["problems"] for p in parts)
        _, replayed = live.replay()
        facts["same_hash"] = bool(replayed.get("hash")) and replayed["hash"] == live.report().get("hash")
        if not (facts["ended"] and facts["balanced"] and facts["counted_once"]):
            facts["said"] = live.text("host.err")[-1500:]
        return facts


def stop(given, folder, reference, rng):
    """SIGSTOP and SIGCONT of host or probe, between 0.1 s and --longest."""
    whom = rng.choice(["host", "probe"])
    seconds = math.exp(rng.uniform(math.log(0.1), math.log(given.longest)))
    delay_s = rng.uniform(0, 0.8 * reference["seconds"])
    with Live(given, folder) as live:
        probe, host = live.probe(), live.host()
        target = host if whom == "host" else probe
        at_ns = kill_at(target, delay_s, signal.SIGSTOP)
        if at_ns is not None:
            time.sleep(seconds)
            target.send_signal(signal.SIGCONT)
        begun = time.monotonic()
        code = wait(host)
        took_s = time.monotonic() - begun
        ended = wait(probe, 60)
        bursts = live.report().get("bursts", {})
        facts = {"whom": whom, "delay_s": delay_s, "stopped_s": seconds, "came_too_late": at_ns is None, "code": code,
                 "went_on": code in SCAN_ENDS and ended == 0, "then_s": took_s, "captured": bursts.get("captured"),
                 "begun": live.begun(), "balanced": balanced(bursts), "bursts": bursts}
        if not facts["went_on"] or not facts["balanced"] or facts["captured"] != facts["begun"]:
            facts["said"] = live.text("host.err")[-1500:] + live.text("probe.err")[-800:]
        return facts


def trials(name, count, one):
    """count times one(number); told as they end."""
    out = []
    for n in range(count):
        facts = one(n)
        told = {k: v for k, v in facts.items() if k not in ("said", "bursts")}
        say(f"{name} {n + 1}/{count}: {told}")
        if "said" in facts:
            say(facts["said"])
        out.append(facts)
    return out



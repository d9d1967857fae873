"""The history of instructions: one row a commit, and what a run is worth beside the last row. No figures of time in it."""
import json
import os

LIMIT = 0.05  # a stage that grew by more is a loss
JUDGED = ("decode", "track", "fuse")  # the others do next to nothing


def row_of(measured, commit, date, prints, reason=""):
    """measured: the file that bench_speed writes. prints: a recording's name to what its bytes are known by."""
    counted = [r for r in measured["recordings"] if not r["counter_problem"]]
    return {"commit": commit, "date": date, "reason": reason, "build": measured["build"],
            "recordings": {r["name"]: {"bursts": r["bursts"], "print": prints[r["name"]],
                                       "instructions": {s: round(r["stages"][s]["instructions"]) for s in JUDGED}}
                           for r in counted}}


def compare(now, before):
    """(losses, notes). losses: "stage of recording: …"; notes: what could not be judged, and why. Both are rows."""
    if not now["recordings"]:
        return [], ["no instructions were counted: nothing to judge"]
    differing = [f"{key} {now['build'].get(key)}, was {before['build'].get(key)}" for key in sorted(now["build"] | before["build"])
                 if now["build"].get(key) != before["build"].get(key)]
    if differing:
        return [], ["another build, not judged: " + "; ".join(differing)]
    losses, notes = [], []
    for name, recording in now["recordings"].items():
        known = before["recordings"].get(name)
        if known is None:
            notes.append(f"{name}: not in row {before['commit']}")
        elif (known["bursts"], known["print"]) != (recording["bursts"], recording["print"]):
            notes.append(f"{name}: not the bursts of row {before['commit']}, not judged")
        else:
            losses += losses_of(name, recording["instructions"], known["instructions"])
    return losses, notes


def losses_of(name, now, before):
    out = []
    for stage, count in now.items():
        if stage not in before:
            continue
        grown = count / before[stage] - 1
        if grown > LIMIT:
            out.append(f"{stage} of {name}: {count / 1e6:.2f} M instructions a burst, were {before[stage] / 1e6:.2f} M: "
                       f"{100 * grown:+.1f} %, at most {100 * LIMIT:+.0f} %")
    return out


def judged(now, before):
    """How many stages compare() held against another."""
    if now["build"] != before["build"]:
        return 0
    return sum(len(r["instructions"]) for name, r in now["recordings"].items()
               if all(before["recordings"].get(name, {}).get(k) == r[k] for k in ("bursts", "print")))


def with_row(rows, row):
    """A commit measured again has its new row in place of the old one, and the old one's reason where it has none."""
    if rows and rows[-1]["commit"] == row["commit"]:
        return rows[:-1] + [{**row, "reason": row["reason"] or rows[-1]["reason"]}]
    return rows + [row]


def read(path):
    if not os.path.exists(path):
        return []
    with open(path, encoding="utf-8") as f:
        return json.load(f)


def write(path, rows):
    """A row a line: a commit changes one line."""
    text = "[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n"
    with open(path + ".part", "w", encoding="utf-8") as f:
        f.write(text)
    os.replace(path + ".part", path)

"""Runs the tests of flashing and hands their figures over: properties that GoogleTest recorded, lines that scripts printed."""
import json
import os
import re
import subprocess
import sys
import tempfile
import time


def say(text):
    print(f"bench: {text} ...", file=sys.stderr, flush=True)


class Suite:
    """One GoogleTest program: which of its tests passed, how long they took, what they recorded."""

    def __init__(self, build, name, env=None):
        self.name, self.tests = name, {}
        program = f"{build}/bin/test_{name}"
        if not os.path.exists(program):
            return
        say(name)
        with tempfile.TemporaryDirectory() as work:
            subprocess.run([program, f"--gtest_output=json:{work}/out.json"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                           env={**os.environ, **(env or {})}, check=False)
            with open(f"{work}/out.json", encoding="utf-8") as f:
                told = json.load(f)
        for suite in told["testsuites"]:
            for test in suite["testsuite"]:
                self.tests[f"{suite['name']}.{test['name']}"] = test

    def passed(self, *names):
        """All of the tests whose names begin so; absent ones have not passed."""
        for name in names:
            found = [t for full, t in self.tests.items() if full.startswith(name)]
            if not found or any("failures" in t or t.get("result") != "COMPLETED" for t in found):
                return False
        return True

    def figure(self, name, key):
        return int(self.tests.get(name, {}).get(key, 0))

    def seconds(self, name):
        return float(self.tests.get(name, {}).get("time", "0s").rstrip("s"))


class Lane:
    """Tests of ctest by a pattern of their names: `state` is passed, failed, skipped or absent, `lines` what they printed."""

    def __init__(self, build, pattern):
        say(pattern)
        began = time.monotonic()
        ran = subprocess.run(["ctest", "--test-dir", build, "-R", pattern, "--verbose"], capture_output=True, text=True, check=False)
        self.seconds = time.monotonic() - began
        self.lines = [re.sub(r"^\d+: ", "", line) for line in ran.stdout.splitlines()]
        results = re.findall(r"^ *\d+/\d+ Test +#\d+: \S+ \.*\s*(?:\*\*\*)?(\w+)", ran.stdout, re.MULTILINE)
        if not results:
            self.state = "absent"
        elif ran.returncode != 0:
            self.state = "failed"
        else:
            self.state = "skipped" if "Skipped" in results else "passed"

    def starting(self, prefix):
        return [line for line in self.lines if line.startswith(prefix)]


def output_of(command):
    """Lines of a command that must succeed; none when it does not."""
    say(" ".join(command[:2]))
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    return ran.stdout.splitlines() if ran.returncode == 0 else []

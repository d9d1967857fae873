#!/usr/bin/env python3
"""The comparison with the history: it must fail where a stage lost, say which, and judge nothing that is not comparable."""
import copy
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import speed_history as history  # noqa: E402

BUILD = {"compiler": "gcc 12.2.0", "simd": "AVX2", "opencv": "4.6.0"}


def measured(decode=300e6, track=120e6, fuse=160e6, build=BUILD, problem="", bursts=60):
    stages = {"decode": {"instructions": decode}, "track": {"instructions": track}, "fuse": {"instructions": fuse},
              "sink": {"instructions": 1000}}
    return {"build": dict(build), "recordings": [{"name": "molars_m", "bursts": bursts, "counter_problem": problem, "stages": stages}]}


def row(commit="now", prints="a1", **given):
    return history.row_of(measured(**given), commit, "2026-11-28", {"molars_m": prints})


class Compare(unittest.TestCase):
    def test_the_same_run_has_no_loss_and_is_judged(self):
        self.assertEqual(history.compare(row(), row()), ([], []))
        self.assertEqual(history.judged(row(), row()), 3)

    def test_a_loss_names_stage_recording_and_both_figures(self):
        losses, notes = history.compare(row(track=120e6 * 1.051), row())
        self.assertEqual(notes, [])
        self.assertEqual(len(losses), 1)
        for word in ("track", "molars_m", "126.12", "120.00"):
            self.assertIn(word, losses[0])

    def test_every_stage_can_lose(self):
        for stage, count in (("decode", 300e6), ("track", 120e6), ("fuse", 160e6)):
            losses, _ = history.compare(row(**{stage: count * 1.06}), row())
            self.assertEqual([loss.split()[0] for loss in losses], [stage])

    def test_what_grew_by_less_or_shrank_is_no_loss(self):
        self.assertEqual(history.compare(row(track=120e6 * 1.049), row())[0], [])
        self.assertEqual(history.compare(row(track=60e6), row())[0], [])

    def test_another_build_is_said_and_not_judged(self):
        for key in BUILD:
            losses, notes = history.compare(row(track=999e6, build={**BUILD, key: "other"}), row())
            self.assertEqual(losses, [])
            self.assertIn("other", notes[0])
            self.assertIn(BUILD[key], notes[0])
            self.assertEqual(history.judged(row(build={**BUILD, key: "other"}), row()), 0)

    def test_other_bursts_are_said_and_not_judged(self):
        for other in (row(track=999e6, bursts=8), row(track=999e6, prints="b2")):
            losses, notes = history.compare(other, row())
            self.assertEqual(losses, [])
            self.assertIn("molars_m", notes[0])
            self.assertEqual(history.judged(other, row()), 0)

    def test_without_a_counter_nothing_is_judged(self):
        losses, notes = history.compare(row(track=999e6, problem="no instruction counter"), row())
        self.assertEqual(losses, [])
        self.assertTrue(notes)

    def test_a_recording_that_the_row_lacks_is_said(self):
        before = row()
        before["recordings"] = {}
        losses, notes = history.compare(row(), before)
        self.assertEqual((losses, len(notes)), ([], 1))


class Rows(unittest.TestCase):
    def test_a_commit_has_one_row_and_keeps_its_reason(self):
        accepted = {**row("c1"), "reason": "orders from the model"}
        again = history.with_row([row("c0"), accepted], row("c1", track=119e6))
        self.assertEqual([r["commit"] for r in again], ["c0", "c1"])
        self.assertEqual(again[-1]["reason"], "orders from the model")
        self.assertEqual(again[-1]["recordings"]["molars_m"]["instructions"]["track"], 119000000)
        self.assertEqual(len(history.with_row(again, row("c2"))), 3)

    def test_rows_survive_the_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "h.json")
            self.assertEqual(history.read(path), [])
            rows = [row("c0"), row("c1")]
            history.write(path, copy.deepcopy(rows))
            self.assertEqual(history.read(path), rows)
            with open(path, encoding="utf-8") as f:
                self.assertEqual(len(f.read().splitlines()), 4)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/env python3
"""flash_page.py BUILD OUT [--full]: OUT/flashing.md and flashing.json, a row for each thing that flashing must show."""
import argparse
import json
import os
import re
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from bench_page import Page, machine  # noqa: E402
from flash_lanes import Lane, Suite, output_of  # noqa: E402


def word(passed):
    return "passed" if passed else "**failed or absent**"


def cut_rows(page, build, full):
    page.section("Power cuts", "In-process flash model with page erase and torn sectors; an update of 16 MiB, boot and confirmation.")
    s = Suite(build, "fw_power_cut", {"ENAMEL_FULL_TESTS": "1"} if full else None)
    single, double = "PowerCut.no_position_bricks", "PowerCut.two_cuts_in_a_row_do_not_brick_and_the_update_still_succeeds"
    positions, scratch, pairs = s.figure(single, "positions"), s.figure(single, "from_scratch"), s.figure(double, "pairs")
    took = s.seconds(single) + (s.seconds(double) if full else 0)
    page.row("every sector of the flow, every byte of a boot block's write: positions without a brick", "≥ 35 000",
             f"{positions}, {0 if s.passed(single) else 'some'} bricks; {scratch} slots hashed from scratch",
             s.passed(single) and positions >= 35000 and scratch >= 200)
    page.row(f"random double cuts, image of {'16 MiB' if full else '1 MiB (16 MiB by --full)'}, then the update succeeds", "1 000, 0 bricks",
             f"{pairs}, {word(s.passed(double))}", s.passed(double) and pairs >= 1000)
    page.row("… time of both" if full else "… time of the single cuts", "≤ 5 min", f"{took:.0f} s", took <= 300)
    page.row("control: a policy that charges confirmed slots, one that does not verify", "caught", word(s.passed("PowerCut.control")),
             s.passed("PowerCut.control"))


def image_rows(page, build, update):
    page.section("Images that must not run")
    s = Suite(build, "fw_image")
    bits = "Flip.every_bit_of_the_manifest_is_refused_before_the_first_erase"
    flips, sample = "Flip.ten_thousand_of_a_whole_image_are_seen_by_their_chunk", "Flip.payloads_are_refused_by_the_probe_before_their_chunk_is_written"
    page.row("single-bit flips of the manifest, signature block and pad included, refused before the first erase", "100 %",
             f"{update.figure(bits, 'refused')} bits, {word(update.passed(bits))}", update.passed(bits))
    page.row("random flips of a 16 MiB payload refused", "10 000 of 10 000", f"{update.figure(flips, 'refused')}",
             update.passed(flips) and update.figure(flips, "refused") == 10000)
    page.row("… whole way through the receiver: refused, the chunk's place untouched, resumed with the right bytes", "all",
             f"{update.figure(sample, 'flips')}, {word(update.passed(sample))}", update.passed(sample))
    named = update.passed("Update.each_refusal_has_its_number", "Update.revoked_key") and s.passed("Image.")
    page.row("downgrade, foreign, revoked, development key, hardware, truncated, DfuSe, unsigned: own number, device usable", "each",
             word(named), named)


def probe_rows(page, update, usb):
    page.section("On the probe")
    kept = update.passed("Update.calibration_is_the_same_after_flashing_rollback_and_factory_reset")
    page.row("calibration bytes after flashing, rollback, factory reset", "identical", word(kept), kept)
    page.row("… seen over USB", "identical", word(usb.passed("Flash.calibration_is_the_same")), usb.passed("Flash.calibration_is_the_same"))
    cycles = update.passed("BootDecision.a_healthy_trial_survives", "BootDecision.three_power_cycles")
    page.row("three healthy power cycles during a trial", "never \"stop\"", word(cycles), cycles)
    tries = update.passed("BootDecision.zero_tries", "BootDecision.every_block", "Update.recovery_takes_an_image_whatever_the_tries_are")
    page.row("zero tries everywhere: every block over ten boots; recovery takes an image", "never \"stop\"", word(tries), tries)


def arm_row(page, build):
    lane = Lane(build, "^arm64_boot_model$")
    told = [line.split("digest ")[1] for line in lane.starting("host: ") + lane.starting("arm64: ")]
    size = lane.starting("boot code for arm64")
    page.row("boot decision on arm64 (qemu-user) and on the host: digest of all choices and control blocks", "equal",
             " and ".join(d[:16] for d in told) or lane.state, lane.state == "passed" and len(set(told)) == 1)
    page.row("… what the boot code asks for", "memory functions only", size[0].split(": ")[1] if size else lane.state, bool(size))


def usb_rows(page, build, usb):
    page.section("Over USB", "Emulated port (umockdev), real libusb, unmodified `dfu-util`. SIMULATION.")
    page.row("unmodified dfu-util downloads and reads the status back", "yes", word(usb.passed("DfuUtil.")), usb.passed("DfuUtil."))
    refusals = usb.passed("Flash.each_refusal_has_its_exit_code")
    page.row("each refusal by exit code and text, nothing written", "each", word(refusals), refusals)
    three = usb.passed("Field.of_three_one_is_pulled", "Field.a_pulled_probe_is_resumed", "Flash.stalls_are_retried")
    page.row("three at once: one healthy, one stalling, one pulled at 30 %", "succeeds, recovers, resumes", word(three), three)
    fwupd = Lane(build, "^fwupd$")
    page.row("fwupdtool takes the cabinet without its daemon", "yes", fwupd.state, fwupd.state == "passed")
    speed_rows(page, build)


def speed_rows(page, build):
    program = "tests/bench/usb_speed.py"
    lines = output_of([sys.executable, program, f"{build}/bin"]) if os.path.exists(program) else []
    told = json.loads("\n".join(lines)) if lines else None
    for key, what in (("transfer_s", "16 MiB, transfer phase, median of 5"), ("transfer_cpu_s", "… its processor time")):
        if told is None:
            page.row(what + " beside dfu-util", "≤ 1.05 ×", "not measured", False)
            continue
        ours, peer = told["enamel_flash"][key], told["dfu_util"][key]
        page.row(what + " beside dfu-util", "≤ 1.05 ×", f"{ours:.2f} s, dfu-util {peer:.2f} s: {ours / peer:.2f} ×", ours <= 1.05 * peer)


def guest_rows(page, build):
    page.section("In a guest with a real kernel", "qemu without virtualisation hardware, dummy_hcd, FunctionFS, 20 transfers of 1 MiB and one of 16 MiB.")
    for series, descriptor in (("6.1", "without"), ("6.12", "with")):
        lane = Lane(build, f"^guest_{series.replace('.', '[.]')}$")
        ok = len(lane.starting("ok"))
        page.row(f"Debian's {series} kernel, {descriptor} the DFU functional descriptor", "passes", f"{lane.state}, {ok} checks, {lane.seconds:.0f} s",
                 lane.state == "passed")


def fuzz_rows(page, full):
    seconds = 600 if full else 30
    page.section("Fuzzing", "libFuzzer with address and undefined-behaviour sanitizers, corpus in the tree.")
    lines = output_of(["tools/fuzz", "--seconds", str(seconds)])
    for target in ("image", "dfu", "status", "boot"):
        found = [m for m in (re.match(rf"fuzz {target}: (\w+), (.*)", line) for line in lines) if m]
        clean = bool(found) and found[0].group(1) == "clean"
        page.row(f"{target}: findings in {seconds} s", "0", found[0].group(2) if clean else "**a finding, or not run**", clean)


def time_row(page, began):
    seconds = time.monotonic() - began
    page.section("All of it")
    page.row("the lanes of this page together, after the build", "≤ 12 min", f"{seconds / 60:.1f} min", seconds <= 720)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build")
    parser.add_argument("out")
    parser.add_argument("--full", action="store_true")
    args = parser.parse_args()
    page, began = Page(), time.monotonic()
    cut_rows(page, args.build, args.full)
    update, usb = Suite(args.build, "fw_update"), Suite(args.build, "usb_interop")
    image_rows(page, args.build, update)
    probe_rows(page, update, usb)
    arm_row(page, args.build)
    usb_rows(page, args.build, usb)
    guest_rows(page, args.build)
    fuzz_rows(page, args.full)
    if not args.full:
        time_row(page, began)
    page.write(args.out, "flashing", f"tools/bench-flashing{' --full' if args.full else ''}", machine(), {"full": args.full})
    for r in page.rows:
        print(f"{'ok  ' if r['met'] else 'MISS'} {r['what']}: {r['measured']} (target {r['target']})")
    return 0 if all(r["met"] for r in page.rows) else 1


if __name__ == "__main__":
    sys.exit(main())

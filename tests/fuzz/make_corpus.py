#!/usr/bin/env python3
"""make_corpus.py [--check]: writes the seeds in tests/fuzz/corpus, or tells which differ from what is there.

Each seed is the script that its target reads (byte_source.hpp): a choice among n is two bytes, high one first.
"""
import pathlib
import struct
import sys

CORPUS = pathlib.Path(__file__).parent / "corpus"
YES, NO = b"\0\1", b"\0\0"  # one_in(2)


def pick(n):
    return struct.pack(">H", n)


def image_seeds():
    piece = pick(4095)
    for kind, what in ((1, "altered"), (2, "mended"), (5, "signed_anew")):
        for base in range(5):
            yield f"{what}_{base}", piece + bytes([kind]) + pick(base) + pick(0)
    # Two edits of the header: payload length, first TLV.
    edits = pick(0) + struct.pack("<I", 16) + pick(7) + b"\xff" * 8 + pick(0) + struct.pack("<I", 128) + pick(3) + b"\xa0\0\xff\xff"
    yield "lengths_signed_anew", piece + bytes([5]) + pick(1) + pick(2) + edits
    yield "raw_magic", piece + b"\0" + b"ENMFW\r\n\x1a" + b"\0" * 120
    yield "raw_dfuse", piece + b"\0" + b"DfuSe\x01" + b"\0" * 140
    yield "raw_empty", piece + b"\0"


def dfu_seeds():
    download, restart, recover = b"\x0e", b"\x08" + pick(0), b"\x08" + pick(3)
    confirm = b"\x0a" + YES

    def vendor(request, value=0):
        return bytes([4, request]) + pick(0) + bytes([value])

    yield "update", download + restart + confirm
    yield "trial_not_confirmed", download + restart * 4
    yield "trial_rolled_back", download + restart + vendor(3) + b"\0" + pick(1) + download + restart
    yield "recovery", recover + b"\x0d" + download + restart
    yield "cut_and_resume", b"\x09" + pick(40) + pick(100) + b"\7" + download + restart + download + restart
    yield "cut_in_boot_block", b"\x09" + pick(1) + pick(100) + b"\7" + download + restart
    yield "boot_block_lost", b"\x0c" + pick(0) + b"\7" + b"\x0c" + pick(1) + b"\7" + download + restart
    yield "factory_reset", vendor(4)
    yield "status", vendor(7) + b"\6" + pick(3) + b"\x28" + b"\6" + pick(3) + b"\x28"
    yield "damaged_block", b"\1" + pick(2) + pick(7) + pick(9) + b"\1" + b"\6" + pick(0) + download
    yield "aborted", b"\1" + pick(3) + pick(0) + b"\6" + pick(1) + b"\7" + download
    yield "odd_packets", b"\3\x21\1\0\0\0" + pick(0) + b"\x08" + pick(0) + b"12345678" + b"\3\xa1\3\0\0\0" + pick(0) + b"\2" + pick(0)
    for image in range(6):
        yield f"image_{image}", b"\0" + pick(image) + download + restart


def status_seeds():
    block = struct.pack("<IHB2B2B", 0x41545345, 1, 1, 5, 4, 0, 2) + struct.pack("<BBHI", 1, 2, 3, 4) * 2
    block += struct.pack("<III", 5, 6, 257) + bytes(range(32)) + b"EN2-0001".ljust(16, b"\0") + struct.pack("<HHI", 2, 3900, 706)
    yield "good", b"\xff" + block
    yield "short", b"\xff" + block[:-1]
    yield "long", b"\xff" + block + b"\0"
    yield "slot_two", b"\xff" + block[:6] + b"\2" + block[7:]
    yield "getstatus", b"\xff" + b"\0\0\0\0\2\0"
    yield "stalled", b"\0" + block


def boot_seeds():
    def slot(state, tries):
        return bytes([state, tries, 0, 1])

    def block(seq, active, a, b):
        return b"\4" + pick(0) + bytes([seq, active]) + b"\5\0\0\0" + slot(*a) + slot(*b) + b"\0\0"

    blank, confirmed, pending, trial = b"\0", (5, 0), (3, 3), (4, 1)
    steady = pick(0) * 8
    yield "factory", YES + NO + block(1, 0, confirmed, (0, 0)) + blank + steady
    yield "pending", YES + YES + block(1, 0, confirmed, (0, 0)) + block(2, 0, confirmed, pending) + steady
    yield "last_try", YES + YES + block(3, 0, confirmed, trial) + block(2, 0, confirmed, pending) + steady
    yield "no_tries", YES + YES + block(3, 0, (4, 0), (4, 0)) + block(2, 1, (3, 0), (3, 0)) + steady
    yield "cut_while_charged", YES + YES + block(1, 0, confirmed, pending) + block(2, 0, confirmed, pending) + (pick(2) + pick(1) + pick(200) + b"\3") * 8
    yield "both_lost", NO + YES + blank + blank + steady
    yield "raw", YES + YES + b"\1" + b"EBCB" + b"\1" * 508 + b"\1" + b"\xff" * 512


def seeds():
    for target, made in (("image", image_seeds), ("dfu", dfu_seeds), ("status", status_seeds), ("boot", boot_seeds)):
        for name, content in made():
            yield CORPUS / target / name, content


def main():
    stale = [path for path, content in seeds() if not path.exists() or path.read_bytes() != content]
    if sys.argv[1:] == ["--check"]:
        for path in stale:
            print(f"{path}: is not what make_corpus.py writes; run it", file=sys.stderr)
        return 1 if stale else 0
    for path, content in seeds():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return 0


if __name__ == "__main__":
    sys.exit(main())

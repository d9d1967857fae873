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


CORNERS = ((0, 0, 0), (12.5, 0, 0), (0, 15, 0), (0, 0.25, -48.125))
FACES = ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0))


def ply(form, types="float", vertex_more="", face_list="uchar int", body=b""):
    axes = "".join(f"property {types} {axis}\n" for axis in "xyz")
    return (f"ply\nformat {form} 1.0\ncomment c\nobj_info i\nelement vertex 4\n{axes}{vertex_more}element face 4\n"
            f"property list {face_list} vertex_indices\nend_header\n").encode() + body


def mesh_seeds():
    to_ply, to_stl, to_obj = b"\0", b"\1", b"\2"
    rows = "".join("%g %g %g\n" % p for p in CORNERS) + "".join("3 %d %d %d\n" % f for f in FACES)
    yield "ply_ascii", to_ply + ply("ascii", "double", body=rows.encode())
    yield "ply_ascii_crlf", to_ply + b"\xef\xbb\xbf" + ply("ascii", body=rows.encode()).replace(b"\n", b"\r\n")
    yield "ply_faces_of_nothing", to_ply + ply("ascii", body=rows.replace("3 0 3 1", "2 0 3").replace("12.5", "nan").encode())
    for order, form in (("<", "binary_little_endian"), (">", "binary_big_endian")):
        body = b"".join(struct.pack(order + "3f", *p) for p in CORNERS) + b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES)
        yield f"ply_{form}", to_ply + ply(form, body=body)
        body = b"".join(struct.pack(order + "3dhHd", *p, -1, 1, 0.5) for p in CORNERS)
        body += b"".join(struct.pack(order + "H3I", 3, *f) for f in FACES)
        more = "property short seen\nproperty list ushort double weights\n"
        yield f"ply_{form}_lists", to_ply + ply(form, "float64", more, "uint16 uint32", body)
    strips = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty int x\nproperty int y\nproperty int z\nproperty float nx\n" \
             b"property float ny\nproperty float nz\nproperty float quality\nelement tristrips 1\n" \
             b"property list int int vertex_indices\nend_header\n"
    yield "ply_strips", to_ply + strips + b"0 0 0 0 0 1 1\n1 0 0 0 0 1 1\n0 1 0 0 0 1 1\n1 1 0 0 0 1 1\n8 0 1 2 3 -1 0 1 3\n"

    def facet(f):
        return "facet normal 0 0 0\nouter loop\n" + "".join("vertex %e %e %e\n" % CORNERS[i] for i in f) + "endloop\nendfacet\n"
    text = ("solid a b\n" + "".join(map(facet, FACES)) + "endsolid a b\n").encode()
    yield "stl_text", to_stl + text
    yield "stl_text_capitals_crlf", to_stl + b" \r\n" + text.upper().replace(b"\n", b"\r\n")
    yield "stl_text_utf16", to_stl + b"\xff\xfe" + facet(FACES[0]).encode("utf-16-le") + "endsolid".encode("utf-16-le")
    binary = struct.pack("<I", 4) + b"".join(struct.pack("<12fH", 0, 0, 0, *(c for i in f for c in CORNERS[i]), 0) for f in FACES)
    yield "stl_binary", to_stl + b"any".ljust(80) + binary
    yield "stl_binary_solid_spare", to_stl + b"solid cad".ljust(80) + binary + b"\0\0"
    vertices = "".join("v %g %g %g\n" % p for p in CORNERS)
    yield "obj", to_obj + (vertices + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in FACES)).encode()
    yield "obj_forms", to_obj + (f"# c \\\no jaw\n{vertices}vn 0 0 1\nvt 0 0\nf 1/1 2/1/1 3//1 \\\n4\nf -4 -3 -1 # c\ng a b\nf 1 2\nv 1,5 1e999 1.#QNAN\n"
                               "f 5 1 2\n").encode()
    yield "obj_far", to_obj + b"v 700000.25 650000 5e9\nv 700001.25 650000 5e9\nv 700000.25 650002 5e9\nf 1 2 3\n"


def table_seeds():
    poses = "burst_id,t_ns,tx,ty,tz,qx,qy,qz,qw\n0,5,0.5,-1.25,48,0,0,0,1\n3,9,1e-3,0,0,0.6,0,0,0.8\n"
    bursts = "burst_id,t0_ns,t1_ns,t2_ns,t3_ns,exposure_us,temp_c\n0,1,2,3,4,3700,32.0\n3,11,12,13,14,3700,-0.5\n"
    stages = "burst_id,input,decode,track,fuse,verdict\n0,00000000000000ab,0000000000000001,0,0,fused\n"
    axes = "burst_id,rot_cmd_deg,swing_cmd_deg,rot_read_deg,swing_read_deg\n0,15,-20,14.998,nan\n3,,2.5,360.5,\n"
    for kind, (name, text) in enumerate((("poses", poses), ("bursts", bursts), ("stages", stages), ("axes", axes))):
        german = text.replace(",", ";").replace(".", ",").replace("\n", "\r\n")
        yield name, bytes([kind]) + text.encode()
        yield f"{name}_german", bytes([kind]) + b"\xef\xbb\xbfsep=;\r\n" + german.encode() + b";;;;\r\n"
        yield f"{name}_utf16", bytes([kind]) + b"\xfe\xff" + german.replace(";", "\t").encode("utf-16-be")
        yield f"{name}_quoted", bytes([kind]) + ('"' + text.replace(",", '", "').replace("\n", '"\n"')).encode()


def recording_seeds():
    flip, other, cut = pick(0), pick(0), pick(5)
    for form in range(2):
        for at in (3, 20, 900, 2500, 4000, 6000):
            yield f"bit_{form}_{at}", pick(form) + pick(0) + pick(0) + pick(at) + pick(0) + flip + pick(at % 8)
        for at in (100, 3000, 5000):
            yield f"cut_{form}_{at}", pick(form) + pick(0) + pick(0) + pick(at) + other + cut
        for kind, name in ((1, "rubbish"), (2, "zeros"), (3, "gap"), (4, "twice")):
            yield f"{name}_{form}", pick(form) + pick(0) + pick(1) + (pick(2800) + pick(250) + pick(kind) + b"\x06" * 8) * 2
    magic = b"\x89MCAP0\r\n"
    header = b"\x01" + struct.pack("<Q", 8) + struct.pack("<II", 0, 0)
    end = b"\x0f" + struct.pack("<QI", 4, 0) + b"\x02" + struct.pack("<QQQI", 20, 0, 0, 0) + magic
    yield "empty_mcap", pick(0) + pick(7) + magic + header + end
    chunk = struct.pack("<QQQII", 0, 0, 1 << 40, 0, 3) + b"lz4" + struct.pack("<Q", 1)
    yield "huge_chunk", pick(0) + pick(7) + magic + header + b"\x06" + struct.pack("<Q", len(chunk) + 1) + chunk + b"x" + end


def message_seeds():
    plain = b"\0\1\0\0"
    for kind in range(10):
        yield f"zeros_{kind}", bytes([kind]) + plain + bytes(400)
        yield f"delimited_{kind}", bytes([kind]) + b"\0\x09\0\0" + struct.pack("<I", 300) + bytes(300)
    axes = struct.pack("<IIQI4d", 7, 3, 12, 4, 90.0, -15.0, float("nan"), -14.998)
    for name, body in (("whole", axes), ("cut", axes[:-3]), ("beyond", axes[:-8] + struct.pack("<d", 1e9)), ("later", axes + bytes(8))):
        yield f"axes_{name}", b"\x09\0\x09\0\0" + struct.pack("<I", len(body)) + body
    yield "long_sequence", b"\0" + plain + bytes(112) + struct.pack("<I", 0xFFFFFFFF) + bytes(64)


def rig_seeds():
    rigs = pathlib.Path(__file__).parents[2] / "config" / "rigs"
    for path in sorted(rigs.glob("*.json")):
        yield path.stem, path.read_bytes()
    yield "deep", b"[" * 500
    yield "numbers", b'{"format": "rig/1", "camera": {"width": 1e400, "height": -1, "fx": NaN}}'


def config_seeds():
    yield "all", (b'count=5\nseed = 3\nname = "a \\u00e9"\nknots = [1, 2.5]\noffset = [1.0, -2, 3e0]\ntags = ["x", ""]\nmode = "exact"\n'
                  b"[grid]\nstep_mm = 0.25\nenabled = false\n[[ball]]\nradius = 0.5\n[[ball]]\n")
    yield "setting", b"grid.step_mm = 0.5\n[grid]\nenabled = true\n"
    yield "limits", b"seed = 18446744073709551616\ncount = -1\nknots = [nan, inf, 1e400]\noffset = [1]\n"
    yield "no_toml", b"[[[\n= 3\n\"\xff"


def checkpoint_seeds():
    def model(blocks):
        return struct.pack("<16dQI", *([1.0, 0, 0, 0, 0] * 3 + [1.0]), 7, len(blocks)) + b"".join(blocks)

    def block(vertices, triangles, soft=b"\0"):  # soft: its flag, and where that is 1 a byte a vertex
        head = struct.pack("<3iQII", 1, -2, 3, 9, vertices, len(triangles))
        return head + b"\0\0\x80\x3f" * (7 * vertices) + b"".join(struct.pack("<3I", *t) for t in triangles) + soft

    yield "empty", b"\1" + model([])
    yield "two", b"\1" + model([block(3, [(0, 1, 2)]), block(4, [(0, 1, 2), (1, 2, 3)])])
    yield "soft", b"\1" + model([block(3, [(0, 1, 2)], b"\1\0\1\0")])
    yield "soft_flag", b"\1" + model([block(3, [(0, 1, 2)], b"\2\0\1\0")])
    yield "soft_nothing", b"\1" + model([block(0, [], b"\1")])
    yield "far_corner", b"\1" + model([block(3, [(0, 1, 3)])])
    yield "more_than_there_is", b"\1" + model([struct.pack("<3iQII", 0, 0, 0, 0, 0xFFFFFFFF, 0xFFFFFFFF)])
    yield "another_format", b"\0" + b"ply\n"


def seeds():
    for target, made in (("image", image_seeds), ("dfu", dfu_seeds), ("status", status_seeds), ("boot", boot_seeds),
                         ("mesh", mesh_seeds), ("table", table_seeds), ("recording", recording_seeds),
                         ("message", message_seeds), ("rig", rig_seeds), ("config", config_seeds),
                         ("checkpoint", checkpoint_seeds)):
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

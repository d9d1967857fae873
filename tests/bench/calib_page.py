#!/usr/bin/env python3
"""calib_page.py WORK OUT: OUT/calibration.json, calibration.md and PNGs from WORK/study.json and the report in WORK/report."""
import json
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import calib_pictures as pictures  # noqa: E402
from bench_page import Page, machine, wrapped  # noqa: E402


def errors(e):
    return f"{e['p95_um']:.2f} µm, {abs(e['scale_ppm']):.1f} ppm, {e['bow_um']:.2f} µm"


def blind_rows(page, r):
    page.section("calib-01 solved blind", "Rendered by another program; `rig.json` holds design values only. Over 40 to 56 mm, "
                 "after the best rigid motion: 95 % of the points, scale, largest sag or twist over 16 mm at three depths.")
    b, o = r["blind"], r["blind"]["ours"]
    met = o["p95_um"] <= 0.35 and abs(o["scale_ppm"]) <= 12 and o["bow_um"] <= 0.25
    page.row("recovered rig against the true one", "≤ 0.35 µm, 12 ppm, 0.25 µm", errors(o), met)
    page.row("… what its own covariance expects, p95", "–", f"{b['expected_p95_um']:.2f} µm", None)
    page.row("… OpenCV `stereoCalibrate` on the same centres", "–", errors(b["opencv"]), None)
    page.row("… OpenCV with its own detector's centres", "–", errors(r["opencv_detector"]), None)
    for name in ("camera", "projector"):
        ours, peer = b[f"rms_{name}_px"], b[f"opencv_rms_{name}_px"]
        page.row(f"reprojection rms, {name}", "≤ 1.02 × OpenCV's", f"{ours:.5f} px, OpenCV {peer:.5f}: {ours / peer:.3f} ×",
                 ours <= 1.02 * peer)
    page.row("images of the disc centres against their true places, rms an axis", "≤ 0.007 px", f"{r['centre_error_px']:.5f} px",
             r["centre_error_px"] <= 0.007)
    h = r["held_out"]
    page.row("planes of the held-out poses 02, 05, 08, rms of 5×5 means", "≤ 3.3 µm, 1.05 × the true rig's",
             f"{h['ours_um']:.3f} µm, the true rig {h['truth_um']:.3f}: {h['ours_um'] / h['truth_um']:.4f} ×",
             h["ours_um"] <= min(3.3, 1.05 * h["truth_um"]))


def spoilt_rows(page, r):
    page.section("calib-01 spoilt", "OpenCV on the same centres and projector coordinates.")
    for key, what in (("four_poses", "poses 00, 03, 06, 09 only"), ("four_times_noise", "noise raised to four times the sensor's"),
                      ("two_dots_hidden", "two dots hidden a pose")):
        if "refused" in r[key]:
            page.row(what, "≤ 1.5 µm and 1.1 × OpenCV's, or refused", "refused: " + r[key]["refused"], True)
            continue
        ours, peer = r[key]["ours"]["p95_um"], r[key]["opencv"]["p95_um"]
        page.row(what + ": p95", "≤ 1.5 µm and 1.1 × OpenCV's", f"{ours:.2f} µm, OpenCV {peer:.2f}: {ours / peer:.2f} ×",
                 ours <= 1.5 and ours <= 1.1 * peer)


def own_rows(page, s):
    page.section("Rigs and boards of our own generator", "Dots without pictures: `tests/support/calib_scene`.")
    b = s["boards"]
    for r in s["rigs"]:
        page.row(f"{r['rigs']} random rigs (seeds {r['first_seed']} on), one slipped pose each: within 1.2 × their own bound, the 99 % point "
                 "of their covariance", "≥ 27, the rest refused", f"{r['within']}, {r['refused']} refused",
                 r["within"] >= 27 and r["within"] + r["refused"] == r["rigs"])
        page.row("… the slipped pose named, and no other", "30", str(r["named"]), r["named"] == r["rigs"])
        page.row("… error over what the covariance expects, median", "≤ 1.2", f"{r['median_over_expected']:.2f}",
                 r["median_over_expected"] <= 1.2)
    rigs, beyond = sum(r["rigs"] for r in s["rigs"]), sum(r["beyond_95"] for r in s["rigs"])
    page.row(f"all {rigs}: beyond the 95 % point of their covariance", f"expected {0.05 * rigs:g}", str(beyond), None)
    page.row(f"dots off by 3 µm, board bowed by 20 µm, 20 poses, median of {b['solved']} boards: p95 without scale", "≤ 1.5 µm",
             f"{b['p95_um']:.2f} µm (OpenCV, target taken as perfect: {b['opencv_p95_um']:.2f})", b["p95_um"] <= 1.5)
    page.row("… largest sag or twist", "≤ 0.3 µm", f"{b['bow_um']:.2f} µm (OpenCV {b['opencv_bow_um']:.2f})", b["bow_um"] <= 0.3)


def centre_rows(page, centres):
    page.section("Centres of discs", "Analytically integrated, noise of `calib-01`, 200 draws each: sigma is known to 4 %. The bound "
                 "is Cramér and Rao's with centre, axes, blur, levels and the light's gradient unknown.")
    for c in centres:
        what = f"radius {c['radius_px']:g} px, tilt {c['tilt_deg']:g}°, blur {c['blur_px']:g} px"
        page.row(f"{what}: sigma over the bound (grey moments {c['moments_over_bound']:.1f})", "≤ 1.2", f"{c['sigma_over_bound']:.2f}",
                 c["sigma_over_bound"] <= 1.2)
        page.row(f"{what}: bias", "≤ 0.005 px", f"{c['bias_px']:.5f} px", c["bias_px"] <= 0.005)


def captured_rows(page, c):
    page.section("Captured chessboards", "Photos by others. Why the references differ: [calibration](../calibration.md), section 9.")
    if "camera" in c:
        k = c["camera"]
        page.row(f"opencv_stereo_chessboard, left camera, {k['pictures']} pictures: rms", "≤ 0.20 px", f"{k['rms_px']:.3f} px",
                 k["rms_px"] <= 0.20)
        page.row("… focal length", "533.0 ± 0.2 %", f"{k['fx']:.1f}, {k['fy']:.1f}",
                 all(abs(f / 533 - 1) <= 0.002 for f in (k["fx"], k["fy"])))
    if "procam" in c:
        p = c["procam"]
        low, high = 3445 * 0.997, 3452 * 1.003
        page.row("procam_graycode_chessboard, camera alone, board taken as flat: focal length", "3445 to 3452 ± 0.3 %",
                 f"{p['alone_fx']:.1f}, {p['alone_fy']:.1f}", all(low <= f <= high for f in (p["alone_fx"], p["alone_fy"])))
        page.row("… camera and projector, the board's bent corner solved too: camera", "3445 to 3452 ± 0.3 %",
                 f"{p['camera_fx']:.1f} ± {p['camera_fx_sigma']:.1f}, {p['camera_fy']:.1f}",
                 all(low <= f <= high for f in (p["camera_fx"], p["camera_fy"])))
        page.row("… stereo rms", "≤ 0.30 px", f"{p['rms_px']:.3f} px (OpenCV on the same corners {p['opencv_rms_px']:.3f})",
                 p["rms_px"] <= 0.30)
        page.row("… projector", "–", f"f {p['projector_fx']:.1f} ± {p['projector_fx_sigma']:.1f}, {p['projector_fy']:.1f}, centre line "
                 f"{p['projector_cy']:.0f} ± {p['projector_cy_sigma']:.0f}", None)


def time_rows(page, s):
    page.section("Time", "Processor time of one thread.")
    r = s["rendered"]
    total = 20 * r["measure_ms_per_pose"] + s["solve_20_poses_ms"]
    page.row("twenty poses: measuring and solving", "≤ 20 s on 2 cores",
             f"{total / 1e3:.1f} s ({r['measure_ms_per_pose'] / 1e3:.2f} s a pose, solving {s['solve_20_poses_ms'] / 1e3:.1f} s)", total <= 20e3)


def main(work, out):
    with open(f"{work}/study.json", encoding="utf-8") as f:
        study = json.load(f)
    where, page = machine(), Page()
    if study["rendered"]:
        blind_rows(page, study["rendered"])
        spoilt_rows(page, study["rendered"])
    else:
        page.note("The rendered set calib-01 is absent: its rows are left out.")
    own_rows(page, study)
    centre_rows(page, study["centres"])
    captured_rows(page, study["captured"])
    if study["rendered"]:
        time_rows(page, study)
    if os.path.exists(f"{work}/report/calibration.json"):
        page.note(wrapped("Residuals of `calib-01` (poses 02, 05, 08 held out) and the held-out planes, blue nearer, red farther, "
                          "full at 2 µm: `enamel calibrate solve --hold-out 02,05,08`."))
        for name in pictures.draw(f"{work}/report", out):
            page.note(f"![{name}]({name})")
    page.write(out, "calibration", "tools/bench-calibration", where, {"study": study})


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])

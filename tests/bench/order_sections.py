"""Sections of the decode page: modes T and M side by side, orders of teeth, the twin's plane at rest and in motion."""


def modes_section(page, study):
    page.section("Modes T and M: misreads",
                 "The same random rows of teeth (cliffs, one tooth exactly a fringe high, gaps, isolated patches, shadows; camera's point "
                 "spread 0.6 px) in both modes through `BurstDecoder`, four scenes a row of the table. σ/B: noise of a frame over the "
                 "modulation that the camera sees; motion: phase a frame; blur: projector's, σ in fringes.")
    for mode in ("T", "M"):
        c = study["modes"][mode]
        page.row(f"mode {mode}, all conditions: wrong orders among accepted; undecided of what the mask leaves", "–",
                 f"{c['wrong_pct']:.3f} %; {c['undecided_pct']:.1f} %, {c['rejected_bursts']} of {c['bursts']} bursts rejected", None)
    lines = ["| σ/B | motion, rad | blur, fringe | T wrong % | T undecided % | T depth rms, µm | M wrong % | M undecided % | M depth rms, µm |",
             "|---|---|---|---|---|---|---|---|---|"]
    for r in study["modes"]["rows"]:
        cells = [f"{r['noise']:g}", f"{r['motion_rad']:g}", f"{r['blur_fringe']:g}"]
        for mode in ("T", "M"):
            c = r[mode]
            if c["rejected_bursts"] == c["bursts"]:
                cells += ["–", "all rejected", "–"]
                continue
            some = f", {c['rejected_bursts']} of {c['bursts']} rejected" if c["rejected_bursts"] else ""
            cells += [f"{c['wrong_pct']:.3f}", f"{c['undecided_pct']:.2f}{some}", f"{c['rms_um']:.1f}"]
        lines.append("| " + " | ".join(cells) + " |")
    page.note("\n".join(lines))


def orders_section(page, study):
    o = study["orders"]
    page.section("Wrong orders with the code: rows of teeth",
                 "Random rows of teeth: cliffs of 1 to 7 mm and, in each burst, one of exactly one fringe; gaps of 0.3 to 2 mm, deep or dark; "
                 "six isolated patches of 10x10 px; modulation down to a tenth of the mean light; noise of the rig's sensor. *Band*: within 5 "
                 "px of a jump. *Undecided*: order left open, of what the mask of dark, saturated and noisy pixels leaves; pixels beside a cut "
                 "are rejected as mixed, not as undecided.")
    for mode, name in (("T", "mode T"), ("M", "mode M"), ("marker", "single marker, counted from")):
        c = o[mode]
        judge = mode != "marker"
        n = f"{name}, {c['bursts']} bursts"
        page.row(f"{n}: wrong of accepted", "≤ 0.05 %", f"{c['wrong_pct']:.4f} % of {c['accepted_px']} px",
                 c["wrong_pct"] <= 0.05 if judge else None)
        page.row(f"{n}: wrong in the band", "≤ 1 %", f"{c['band_wrong_pct']:.3f} %", c["band_wrong_pct"] <= 1 if judge else None)
        page.row(f"{n}: undecided", "≤ 1 %", f"{c['undecided_pct']:.2f} %; beside a cut {c['edge_pct']:.2f} %, masked {c['masked_pct']:.2f} %",
                 c["undecided_pct"] <= 1 if judge else None)
        page.row(f"{n}: bursts with a wrong region above 100 px", "0", f"{c['bursts_with_large_wrong']} (largest {c['largest_wrong_px']} px)",
                 c["bursts_with_large_wrong"] == 0 if judge else None)


def twin_section(page, study):
    page.section("Plaster plane at 48 mm before the twin, one burst (worst of three)",
                 "SIMULATED, all effects on. Depth less its plane, rms. *45 %*: exposed so that the mean light fills 45 % of the full well, as "
                 "the shot limit of 8.5 µm assumes: there the targets hold. Else as the twin is lit by itself: fewer electrons, more noise.")
    twin = study["twin"]
    if not twin:
        page.row("plane", "–", "skipped: built without the twin", None)
        return
    for mode, limit in (("T", 10.5), ("M", 9.3)):
        for key in ("plane", "plane_full"):
            p = twin[key][mode]
            name = f"mode {mode}, mean light {100 * p['fill']:.0f} % of full well, contrast {p['contrast']:.2f}"
            page.row(f"{name}: raw", f"≤ {limit} µm" if key == "plane_full" else "–", f"{p['raw_um']:.2f} µm (predicted {p['sigma_um']:.2f}; {p['valid_pct']:.1f} % of the pixels)",
                     p["raw_um"] <= limit if key == "plane_full" else None)
            page.row(f"{name}: after a 5x5 mean", "≤ 2.5 µm", f"{p['mean_5x5_um']:.2f} µm", p["mean_5x5_um"] <= 2.5)
    page.section("The plane at 20 mm/s along the axis", "Amplitude at twice the fringe frequency, worst of three bursts.")
    for mode in ("T", "M"):
        for m in twin["motion"][mode]:
            name, speed = f"mode {mode}, frame period {m['frame_period_ms']:g} ms", m["speed_mm_s"]
            page.row(f"{name}: ripple (uncorrected {m['uncorrected_um']:.1f} µm)", "≤ 3 µm",
                     f"{m['ours_um']:.2f} µm" + ("" if m["accepted"] else ", rejected"), m["accepted"] and m["ours_um"] <= 3)
            page.row(f"{name}: velocity", "≤ 2 % or 0.2 mm/s", f"off by {m['velocity_error_mm_s']:.2f} mm/s",
                     m["velocity_error_mm_s"] <= max(0.2, 0.02 * speed))

"""Pictures of the decode page: maps side by side, histograms of errors, curves over phase. Small PNGs."""
import cv2
import numpy as np
from decode_peers import read_pfm

FONT = cv2.FONT_HERSHEY_SIMPLEX
MOST_BYTES = 150_000


def tint(values, low, high, colours=cv2.COLORMAP_VIRIDIS):
    known = np.isfinite(values)
    grey = np.clip((np.where(known, values, low) - low) / (high - low) * 255, 0, 255).astype(np.uint8)
    image = cv2.applyColorMap(grey, colours)
    image[~known] = (40, 40, 40)
    return image


def panel(image, title, width=320):
    height = round(image.shape[0] * width / image.shape[1])
    small = cv2.resize(image, (width, height), interpolation=cv2.INTER_NEAREST)
    head = np.full((22, width, 3), 255, np.uint8)
    cv2.putText(head, title, (4, 16), FONT, 0.42, (0, 0, 0), 1, cv2.LINE_AA)
    return np.vstack([head, small])


def write(path, panels):
    """Two rows; coarser colours, then fewer pixels, where that is needed to stay small."""
    tallest = max(p.shape[0] for p in panels)
    panels = [cv2.copyMakeBorder(p, 0, tallest - p.shape[0], 0, 0, cv2.BORDER_CONSTANT, value=(255, 255, 255)) for p in panels]
    half = (len(panels) + 1) // 2
    rows = [np.hstack(panels[:half]), np.hstack(panels[half:])] if len(panels) > 2 else [np.hstack(panels)]
    image = np.vstack(rows)
    for step, scale in ((1, 1), (8, 1), (16, 1), (16, 0.85), (32, 0.7)):
        small = cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1 else image
        data = cv2.imencode(".png", small // step * step, [cv2.IMWRITE_PNG_COMPRESSION, 9])[1]
        if len(data) < MOST_BYTES:
            break
    with open(path, "wb") as f:
        f.write(data.tobytes())


def histogram(values, limit, unit, title, size=(320, 240)):
    """Bars over +-limit; what lies beyond is counted in the title."""
    values = values[np.isfinite(values)]
    counts, _ = np.histogram(values, 80, (-limit, limit))
    image = np.full((size[1], size[0], 3), 255, np.uint8)
    top = max(counts.max(), 1)
    for k, count in enumerate(counts):
        x, h = k * size[0] // 80, int(count / top * (size[1] - 40))
        cv2.rectangle(image, (x, size[1] - 20 - h), (x + size[0] // 80 - 1, size[1] - 20), (160, 110, 40), -1)
    for x, text in ((2, f"-{limit:g}"), (size[0] // 2 - 4, "0"), (size[0] - 70, f"{limit:g} {unit}")):
        cv2.putText(image, text, (x, size[1] - 5), FONT, 0.4, (0, 0, 0), 1, cv2.LINE_AA)
    beyond = 100 * float((np.abs(values) > limit).mean()) if len(values) else 0
    return panel(image, f"{title}; {beyond:.2g} % beyond", size[0])


def curves(series, limit, title, size=(480, 240)):
    """Lines over one fringe, rad."""
    image = np.full((size[1], size[0], 3), 255, np.uint8)
    cv2.line(image, (0, size[1] // 2), (size[0], size[1] // 2), (200, 200, 200), 1)
    for k, (name, values, colour) in enumerate(series):
        x = np.linspace(0, size[0] - 1, len(values))
        y = size[1] / 2 - np.array(values) / limit * (size[1] / 2 - 4)
        points = np.stack([x, y], 1).round().astype(np.int32)
        cv2.polylines(image, [points], False, colour, 2, cv2.LINE_AA)
        cv2.putText(image, name, (8, 16 + 16 * k), FONT, 0.42, colour, 1, cv2.LINE_AA)
    cv2.putText(image, f"+-{limit:g} rad", (size[0] - 90, 16), FONT, 0.4, (0, 0, 0), 1, cv2.LINE_AA)
    return panel(image, title, size[0])


def oracle_maps(shared, work, out, name, burst):
    folder, result = f"{shared}/data/oracle/{name}", f"{work}/{name}-{burst}"
    depth, truth = read_pfm(f"{result}/depth.pfm"), read_pfm(f"{folder}/truth/depth_{burst:06d}.pfm")
    order = cv2.imread(f"{result}/order.png", cv2.IMREAD_UNCHANGED)
    order = cv2.cvtColor(order, cv2.COLOR_BGR2GRAY) if order.ndim == 3 else order
    order = np.where(order == 255, np.nan, order.astype(np.float32))
    modulation = read_pfm(f"{result}/modulation.pfm")
    error_um = 1e3 * (depth - truth)
    reject = cv2.imread(f"{result}/reject.png", cv2.IMREAD_GRAYSCALE).astype(np.float32)
    write(f"{out}/{name}.png", [
        panel(tint(modulation, 0, np.nanpercentile(modulation, 99.5)), "modulation"),
        panel(tint(order, np.nanmin(order), np.nanmax(order), cv2.COLORMAP_PARULA), "fringe order"),
        panel(tint(error_um, -50, 50, cv2.COLORMAP_TWILIGHT_SHIFTED), "depth error, +-50 um"),
        panel(tint(np.where(reject == 0, np.nan, reject), 0, 255, cv2.COLORMAP_TURBO), "why there is no depth; grey = measured"),
        histogram(error_um, 60, "um", "depth error"),
        panel(tint(depth, np.nanpercentile(depth, 1), np.nanpercentile(depth, 99)), "depth"),
    ])


def plaster(work, out, rows):
    box = np.s_[340:860, 420:950]  # the relief
    modulation, order = read_pfm(f"{work}/plaster_modulation.pfm")[box], read_pfm(f"{work}/plaster_order.pfm")[box]
    depth, error = read_pfm(f"{work}/plaster_depth.pfm")[box], read_pfm(f"{work}/plaster_error.pfm")[box]
    write(f"{out}/plaster-eye.png", [
        panel(tint(modulation, 0, 80), "modulation"),
        panel(tint(order, np.nanmin(order), np.nanmax(order), cv2.COLORMAP_PARULA), "fringe order"),
        panel(tint(depth, np.nanpercentile(depth, 1), np.nanpercentile(depth, 99)), "depth, 750 ... 846 mm"),
        histogram(error - np.nanmean(error), 0.15, "rad", "4 against 12 frames"),
    ])
    raw, ours = (200, 90, 30), (40, 40, 220)
    write(f"{out}/plaster-ripple.png", [
        curves([("four frames as they are", r["raw_curve_rad"], raw), ("corrected", r["curve_rad"], ours)], 0.08,
               f"burst {r['burst']}: mean phase error over a fringe", (330, 220)) for r in rows[:2]])

"""Pictures of the calibration page, from the report of one solved set: residual fields and planes. Small PNGs."""
import base64
import json
import re

import cv2
import numpy as np
from decode_pictures import panel, write

GREY, DARK, RED = (191, 176, 159), (95, 58, 31), (43, 57, 192)  # blue, green, red
CELLS = (8, 6)


def arrow(image, at, along, colour, width):
    fine = 8  # fractional bits of OpenCV's coordinates
    start, end = (np.round(p * 2**fine).astype(int).tolist() for p in (at, at + along))
    cv2.arrowedLine(image, start, end, colour, width, cv2.LINE_AA, fine, 0.3)


def field(places, residuals, size, zoom):
    """Every residual, and the mean of each cell four times as long; red beyond three standard errors."""
    image = np.full((round(size[1] * zoom), round(size[0] * zoom), 3), 255, np.uint8)
    length = 12 / np.sqrt((residuals**2).sum(1).mean())
    for at, r in zip(places, residuals):
        arrow(image, zoom * at, length * r, GREY, 1)
    cell = np.minimum((places / size * CELLS).astype(int), np.array(CELLS) - 1)
    for index in np.ndindex(CELLS):
        inside = residuals[(cell == index).all(1)]
        if len(inside) < 4:
            continue
        mean, sigma = inside.mean(0), inside.std(0, ddof=1) / np.sqrt(len(inside))
        middle = (np.array(index) + 0.5) * size / CELLS
        arrow(image, zoom * middle, 4 * length * mean, RED if (abs(mean) > 3 * sigma).any() else DARK, 2)
    return image


def fields_picture(path, report):
    rows = [r[2:10] for r in report["residuals"]["rows"] if not r[10]]
    data = np.array(rows, float)
    panels = []
    for name, at, size in (("camera", 0, (640, 480)), ("projector", 4, (854, 480))):
        residuals = data[:, at + 2:at + 4]
        rms = np.sqrt((residuals**2).sum(1).mean())
        image = field(data[:, at:at + 2], residuals, np.array(size), 640 / size[0])
        panels.append(panel(image, f"{name}, rms {rms:.4f} px; dark: mean of a cell x 4; red: beyond 3 sigma", 640))
    write(path, panels)


def planes_picture(path, html):
    found = re.findall(r'alt="plane of pose ([^"]*)"[^>]*base64,([^"]+)"', html)
    if found:
        write(path, [np.hstack([panel(cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_COLOR),
                                      f"pose {name}", 384) for name, data in found])])
    return bool(found)


def draw(folder, out):
    """PNGs from FOLDER/calibration.{json,html} into `out`; their names."""
    with open(f"{folder}/calibration.json", encoding="utf-8") as f:
        fields_picture(f"{out}/calibration-residuals.png", json.load(f))
    with open(f"{folder}/calibration.html", encoding="utf-8") as f:
        planes = planes_picture(f"{out}/calibration-planes.png", f.read())
    return ["calibration-residuals.png"] + (["calibration-planes.png"] if planes else [])

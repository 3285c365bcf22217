"""Does sculpting in the suggested order pay off sooner than in the list's own?

    python benchmarks/suggest.py --data FOLDER [--plot FILE.png] [--json]

FOLDER is that of the ICT face. The character has the first five of 25 faces of the databank; the
others are made one by one, in the suggested order (by one take's feature points) and in the list's.
The held-out error is the skin's in another take of random ICT motion, over doing nothing; the
figures are its means over all numbers of faces, and their ratio.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from heads import Ict
from mien.capture.landmarks import POINTS, SIGMA
from mien.mapping.suggest import order
from mien.numeric.qp import solve_boxes
from report import show

Array = NDArray[np.float64]

GIVEN = 5
FRAMES = 120
EVERY = 7
"""Skin vertices that are compared: each so many'th."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    ict = Ict(options.data)
    person = ict.character()
    faces = json.loads((options.data / "databank25.json").read_text())["faces"]
    bank = np.zeros((len(faces), len(ict.names)))
    for row, face in zip(bank, faces.values(), strict=True):
        for shape, weight in face["weights"].items():
            row[ict.names.index(shape)] = weight
    rows = person.face.points.index([fdp for fdp in POINTS if fdp in person.face.points.ids])
    sigma = np.array([SIGMA[POINTS.index(person.face.points.ids[row])] for row in rows])
    fields = person.keys.displacements.astype(float)
    at = (person.face.points.at(fields)[:, rows] / sigma[:, None]).reshape(len(fields), -1)
    skin = person.face.part("skin")
    dense = fields[:, skin.first : skin.last : EVERY].reshape(len(fields), -1)
    take, held = (motion(bank, seed) for seed in (3, 4))
    known, wishes = bank[:GIVEN], bank[GIVEN:]
    chosen, _ = order(take @ at, known @ at, wishes @ at, len(wishes))
    curves = {
        "suggested": errors(held @ dense, known @ dense, wishes[chosen] @ dense),
        "list": errors(held @ dense, known @ dense, wishes @ dense),
    }
    figures = {f"{name}_mean_error": float(np.mean(curve)) for name, curve in curves.items()}
    figures["error_ratio"] = figures["suggested_mean_error"] / figures["list_mean_error"]
    figures["after_five_ratio"] = curves["suggested"][5] / curves["list"][5]
    names = list(faces)[GIVEN:]
    notes = "suggested: " + ", ".join(names[c] for c in chosen[:8]) + " ..."
    if options.plot:
        plot(options.plot, curves)
    show("suggest", "Sculpting in the suggested order", figures, options.json, notes)


def motion(bank: Array, seed: int) -> Array:
    """(F, 55) weights of ICT's shapes: two faces of the databank, and shapes at random."""
    rng = np.random.default_rng(seed)
    weights = np.zeros((FRAMES, bank.shape[1]))
    for frame in weights:
        pair = rng.choice(len(bank), 2, replace=False)
        frame += rng.uniform(0.0, 0.8, 2) @ bank[pair]
        frame[rng.choice(len(frame), 2, replace=False)] += rng.uniform(0.0, 0.3, 2)
    return weights.clip(0.0, 1.0)


def errors(moved: Array, known: Array, wishes: Array) -> list[float]:
    """Held-out error with none of the wishes, the first, the first two ..."""
    return [
        remaining(moved, np.concatenate([known, wishes[:count]]))
        for count in range(len(wishes) + 1)
    ]


def remaining(moved: Array, fields: Array) -> float:
    """Root mean square of what is left over doing nothing."""
    size = len(fields)
    gram = fields @ fields.T
    hessian = gram + 1e-6 * gram.max() * np.eye(size)
    weights = solve_boxes(hessian[None], -moved @ fields.T, np.zeros(size), np.full(size, 1.15))
    return float(np.sqrt(((moved - weights @ fields) ** 2).sum() / (moved**2).sum()))


def plot(path: Path, curves: dict[str, list[float]]) -> None:
    """Draw both curves."""
    from PIL import Image, ImageDraw, ImageFont

    width, height, margin = 900, 560, 70
    picture = Image.new("RGB", (width, height), "white")
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(18)
    top = max(max(curve) for curve in curves.values())

    def place(count: int, value: float) -> tuple[float, float]:
        across = (width - 2 * margin) * count / (len(curves["list"]) - 1)
        return margin + across, height - margin - (height - 2 * margin) * value / top

    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        y = place(0, share * top)[1]
        draw.line([margin, y, width - margin, y], "lightgrey")
        draw.text((14, y - 10), f"{share * top:.2f}", "black", font)
    for count in range(0, len(curves["list"]), 5):
        draw.text((place(count, 0.0)[0] - 6, height - margin + 8), str(count), "black", font)
    for (name, curve), colour in zip(curves.items(), ("teal", "chocolate"), strict=True):
        draw.line([place(i, value) for i, value in enumerate(curve)], colour, 4)
        draw.text((place(7, 0)[0], 30 + 26 * list(curves).index(name)), name, colour, font)
    draw.text((width / 2 - 110, height - 34), "faces made, of twenty", "black", font)
    draw.text((14, 14), "held-out error", "black", font)
    picture.save(path)


if __name__ == "__main__":
    main()

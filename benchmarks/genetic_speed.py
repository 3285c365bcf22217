"""What blending a databank costs a frame, against scipy's bounded least squares in the same run.

    python benchmarks/genetic_speed.py [--take C3D [--faces FOLDER]] [--plot PNG] [--json]

One core. The generic face's own shapes, mixed at random, seen at 32 feature points with noise of
0.3 mm and blended from every second one, or the markers of a take and the 25 ICT faces. ``--plot``
draws the markers' error against generations, as published and repaired, and the exact optimum; a
table tells the same.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

os.environ |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from rich.console import Console
from rich.table import Table
from scipy.optimize import lsq_linear

from ict_bank import read_bank
from mien.face.library import generic_face
from mien.mapping.blend import WEIGHT, Blend, blend, learn_misfit
from mien.mapping.bounded import bounded
from mien.mapping.genetic import genetic, published
from mien.mapping.reconstruct import databank_scale
from mien.numeric.noise import noise_of
from mien.numeric.steady import steady
from mien.recipe import capture_markers
from report import show

Array = NDArray[np.float64]

FRAMES, NOISE, RATE = 600, 0.3, 120.0
GENERATIONS = (0, 10, 20, 35, 70, 140, 300, 700, 1500, 4000, 8000)
ROUNDS = 7
BVLS_FRAMES = 60


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--take", type=Path)
    parser.add_argument("--faces", type=Path, help="folder of the ICT faces (default: ../ict)")
    parser.add_argument("--plot", type=Path)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.take is None:
        fields, motion, rate = from_own_shapes()
    else:
        folder = options.faces or options.take.resolve().parent.parent / "ict"
        fields, motion, rate = from_take(options.take, folder)
    noise = np.full(fields.shape[1], max(noise_of(motion), 1e-3))
    motion, left = steady(motion, rate)
    variance = (left * noise) ** 2 + learn_misfit(fields, motion, left * noise, bounded)
    problem = blend(fields, motion, variance, rate)
    curve(fields, motion, problem, options.plot)
    seconds = measure(fields, motion, variance, problem)
    exact = problem.cost(bounded(blend(fields, motion, variance, 0.0))).sum()
    figures = {
        "frames": float(len(motion)),
        "faces": float(len(fields)),
        **{f"{name}_ms": 1e3 * each for name, each in seconds.items()},
        "ga_bvls_ratio": seconds["ga"] / seconds["bvls"],
        "repaired_bvls_ratio": seconds["repaired"] / seconds["bvls"],
        "bounded_bvls_ratio": seconds["bounded"] / seconds["bvls"],
        "repaired_cost_ratio": float(problem.cost(genetic(problem)).sum() / exact),
    }
    show("genetic_speed", "A frame of blending", figures, options.json)


def from_own_shapes() -> tuple[Array, Array, float]:
    """Fields (K, P, 3) of the generic face's shapes, motion (F, P, 3) of random mixes, rate."""
    generic = generic_face()
    worn = {"2", "4", "5", "8", "9"}
    points = [p for p in generic.face.points.ids if p.partition(".")[0] in worn]
    rows = generic.face.points.index(points[:32])
    shapes = generic.face.points.at(generic.keys.displacements)[:, rows]
    shapes = shapes[np.abs(shapes).max(axis=(1, 2)) > 1.0]
    random = np.random.default_rng(3)
    knots = random.uniform(0.0, 1.0, (FRAMES // 30 + 2, len(shapes))) ** 3
    at = np.arange(FRAMES) / 30.0
    weights = np.stack([np.interp(at, np.arange(len(knots)), knot) for knot in knots.T], axis=1)
    motion = np.tensordot(weights, shapes, axes=1)
    return shapes[::2][:25], motion + NOISE * random.standard_normal(motion.shape), RATE


def from_take(path: Path, folder: Path) -> tuple[Array, Array, float]:
    """The same of a take and the ICT databank."""
    performance, _ = capture_markers(path)
    bank = read_bank(folder)
    face = bank.face
    points = [p for p in performance.points if p in face.points.ids]
    rows = [performance.points.index(p) for p in points]
    scale = databank_scale(points, performance.neutral[rows], face)
    fields = face.points.at(bank.displacements)[:, face.points.index(points)]
    rate = (len(performance) - 1) / float(performance.time[-1])
    return fields, scale * performance.motion[:, rows], rate


def measure(fields: Array, motion: Array, variance: Array, problem: Blend) -> dict[str, float]:
    """Median seconds a frame of each solver over rounds that take turns."""
    count = len(fields)
    weigh = np.repeat(variance**-0.5, 3)
    matrix = np.concatenate([(fields.reshape(count, -1) * weigh).T, np.eye(count) / WEIGHT])
    chosen = np.linspace(0, len(motion) - 1, BVLS_FRAMES).astype(int)
    wanted = motion[chosen].reshape(len(chosen), -1) * weigh

    def bvls() -> None:
        for row in wanted:
            lsq_linear(matrix, np.concatenate([row, np.zeros(count)]), (0.0, 1.0), method="bvls")

    ways: dict[str, tuple[Callable[[], object], int]] = {
        "bvls": (bvls, len(chosen)),
        "ga": (lambda: published(problem), len(motion)),
        "repaired": (lambda: genetic(problem), len(motion)),
        "bounded": (lambda: bounded(problem), len(motion)),
    }
    times: dict[str, list[float]] = {name: [] for name in ways}
    for _ in range(ROUNDS + 1):
        for name, (way, frames) in ways.items():
            begin = perf_counter()
            way()
            times[name].append((perf_counter() - begin) / frames)
    return {name: float(np.median(each[1:])) for name, each in times.items()}


def curve(fields: Array, motion: Array, problem: Blend, plot: Path | None) -> None:
    """Tell, and draw, the error at the markers (mm, root mean square) against generations."""

    def error(weights: Array) -> float:
        left = motion - np.tensordot(weights, fields, axes=1)
        return float(np.sqrt((left**2).sum(axis=-1).mean()))

    rows = [
        (n, error(published(problem, generations=n)), error(genetic(problem, generations=n)))
        for n in GENERATIONS
    ]
    exact = error(bounded(problem))
    table = Table("generations", "published, mm", "repaired, mm", title=f"exact {exact:.3f} mm")
    for n, plain, mended in rows:
        table.add_row(str(n), f"{plain:.3f}", f"{mended:.3f}")
    Console().print(table)
    if plot is not None:
        draw(plot, rows, exact)


def draw(path: Path, rows: list[tuple[int, float, float]], exact: float) -> None:
    """A PNG: generations to the right on a logarithmic scale, error upwards from zero."""
    wide, high, rim = 900, 560, 70
    picture = Image.new("RGB", (wide, high), "white")
    pen = ImageDraw.Draw(picture)
    top = 1.1 * max(max(row[1:]) for row in rows)

    def at(generations: float, error: float) -> tuple[float, float]:
        right = np.log1p(generations) / np.log1p(rows[-1][0])
        return rim + right * (wide - 2 * rim), high - rim - error / top * (high - 2 * rim)

    pen.line([at(0, top), at(0, 0), at(rows[-1][0], 0)], fill="black", width=2)
    for n, *_ in rows[::2]:
        pen.text((at(n, 0)[0] - 8, high - rim + 8), str(n), fill="black")
    for tick in np.linspace(0.0, top, 6)[1:]:
        pen.text((rim - 45, at(0, tick)[1] - 6), f"{tick:.2f}", fill="black")
        pen.line([at(0, tick), at(rows[-1][0], tick)], fill="#dddddd")
    pen.text((rim, 24), "error at the markers, mm, against generations", fill="black")
    series = (("published", 1, "#c0392b"), ("repaired", 2, "#2471a3"))
    for name, column, colour in series:
        line = [at(row[0], row[column]) for row in rows]
        pen.line(line, fill=colour, width=3)
        pen.text((line[-1][0] - 60, line[-1][1] - 20), name, fill=colour)
    pen.line([at(0, exact), at(rows[-1][0], exact)], fill="#1e8449", width=2)
    pen.text((rim + 10, at(0, exact)[1] + 6), "exact optimum", fill="#1e8449")
    picture.save(path)


if __name__ == "__main__":
    main()

"""How far a databank's vertices slide over the skin from the neutral to the expressions.

    python benchmarks/scan_sliding.py FOLDER [--points found] [--json]

FOLDER holds one person's virtual scans: neutral.ply and others, each with its truth (.npz) and its
points (.json). A vertex of the neutral lies at some place of the true skin; where that skin is in
an expression is known. Sliding is how far off the vertex is there. Both meshes are compared where
scanned, on the narrow face.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path

import numpy as np

from mien.formats.meshes.ply import read_ply
from mien.scan.parameterise import Parameterised, parameterise, parameterise_expression
from mien.scan.surface import Surface
from report import show
from scan_accuracy import NARROW, Array, mien_template, point_finder, skin, to_surface, true_points


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--points", choices=("true", "found"), default="true")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    template = mien_template()
    finder = point_finder(None) if options.points == "found" else None
    scans = sorted(options.folder.glob("*.ply"), key=lambda path: (path.stem != "neutral", path))
    rows = []
    for path in scans:
        mesh, truth = read_ply(path), dict(np.load(path.with_suffix(".npz")))
        beside = json.loads(path.with_suffix(".json").read_text())
        points = finder.find(mesh) if finder else true_points(beside)
        begin = time.perf_counter()
        surface = Surface(mesh)
        places = truth["true_vertices"].astype(float)
        if path.stem == "neutral":
            rest, rest_points = parameterise(template, surface, points), points
            triangles = skin(truth)
            _, nearest = to_surface(rest.vertices, places, triangles)
            corners = triangles[nearest]
            shares = barycentric(rest.vertices, places[corners])
            scanned = truth["vertex_scanned"][corners].all(axis=1) & (corners < NARROW).all(axis=1)
            lies = rest.reliable & template.outside & scanned
            at_rest = head(np.einsum("vk,vkx->vx", shares, places[corners]), truth)
            known = {"seconds": time.perf_counter() - begin}
            continue
        own = parameterise(template, surface, points)
        begin = time.perf_counter()
        done = parameterise_expression(template, rest, rest_points, surface, points)
        seconds = time.perf_counter() - begin
        true = np.einsum("vk,vkx->vx", shares, places[corners])
        both = lies & truth["vertex_scanned"][corners].all(axis=1)
        moved = np.linalg.norm(head(true, truth) - at_rest, axis=1)[both]
        distance, _ = to_surface(done.vertices[both & done.reliable], places, skin(truth))
        rows.append(
            {
                "sliding_mm": off(done, true, both),
                "sliding_alone_mm": off(own, true, both),
                "motion_mm": float(moved.mean()),
                "distance_mm": float(distance.mean()),
                "seconds": seconds,
            }
        )
        print(path.stem, {key: round(value, 3) for key, value in rows[-1].items()}, flush=True)
    figures = {key: float(np.mean([row[key] for row in rows])) for key in rows[0]}
    figures |= {"faces": float(len(rows)), "neutral_seconds": known["seconds"]}
    show("scan_sliding", f"{options.folder}: {options.points} points", figures, options.json)


def off(done: Parameterised, true: Array, where: Array) -> float:
    """Mean distance of vertices from where their skin truly is."""
    return float(np.linalg.norm(done.vertices - true, axis=1)[where].mean())


def head(places: Array, truth: dict[str, Array]) -> Array:
    """Places in the true head's own axes."""
    return (places - truth["t"]) @ truth["R"]


def barycentric(places: Array, corners: Array) -> Array:
    """(N, 3) weights of ``places`` (N, 3), laid into the planes of triangles (N, 3, 3)."""
    a, b, c = np.moveaxis(corners, 1, 0)
    ab, ac, ap = b - a, c - a, places - a
    d00, d01, d11 = (ab * ab).sum(1), (ab * ac).sum(1), (ac * ac).sum(1)
    d20, d21 = (ap * ab).sum(1), (ap * ac).sum(1)
    room = np.maximum(d00 * d11 - d01 * d01, 1e-12)
    second, third = (d11 * d20 - d01 * d21) / room, (d00 * d21 - d01 * d20) / room
    return np.stack([1.0 - second - third, second, third], axis=1)


if __name__ == "__main__":
    main()

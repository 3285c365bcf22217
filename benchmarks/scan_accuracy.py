"""How truly a raw scan becomes a consistent mesh.

    python benchmarks/scan_accuracy.py --scan smile.ply --truth smile.npz [--generic mien] [--json]

A virtual scanner's scan, its truth (.npz: true surface, what was scanned) and the points beside it
(.json). --generic ict brings the narrow face of the ICT face model onto the scan, whose vertices
are known in the truth, --generic mien the generic face. Distance: of the scanned vertices to the
true surface. Correspondence: to their own true place; with --generic mien of the ibug68 points that
were not given. Several scans are averaged.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.cli.scanning import detect_once
from mien.face.face import FeaturePoints
from mien.face.library import generic_face
from mien.face.mesh import Mesh
from mien.formats.meshes.ply import read_ply
from mien.numeric.normals import vertex_normals
from mien.scan.parameterise import Parameterised, ScanPoints, parameterise
from mien.scan.points import PointFinder, Reference
from mien.scan.projection import PROJECTIONS, Settings
from mien.scan.surface import Surface
from mien.scan.template import Template, face_template, make_template
from report import show

Array = NDArray[np.float64]

NARROW, NARROW_FACES, SKIN = 6706, 6560, 11248
"""The ICT model's narrow face comes first, its skin before eyes, teeth and shells."""
MM = 10.0
"""Millimetres in a unit of the ICT model."""
TRIMESH_RAYS = 200

IBUG_LANDMARKS = (
    127, 234, 93, 132, 58, 136, 150, 176, 152, 400, 379, 365, 288, 361, 323, 454, 356,
    70, 63, 105, 66, 107, 336, 296, 334, 293, 300, 168, 197, 5, 4, 75, 97, 2, 326, 305,
    33, 160, 158, 133, 153, 144, 362, 385, 387, 263, 373, 380,
    61, 39, 37, 0, 267, 269, 291, 405, 314, 17, 84, 181, 78, 82, 13, 312, 308, 317, 14, 87,
)  # fmt: skip
"""The usual reading of the 68 points on the detector's mesh. Its jaw line (the first 17) is a
silhouette and none of the skin: it is left out."""
JAW = 17


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scan", type=Path, nargs="+", required=True)
    parser.add_argument("--truth", type=Path, nargs="+", required=True)
    parser.add_argument("--generic", choices=("ict", "mien"), default="mien")
    parser.add_argument("--points", choices=("true", "found"), default="true")
    parser.add_argument(
        "--reference",
        type=Path,
        help="a scan with known points (.json beside) that found ones mean",
    )
    parser.add_argument("--projection", choices=tuple(PROJECTIONS), default="normals")
    parser.add_argument("--ict", type=Path, help="the folder of the ICT face model")
    parser.add_argument("--no-trimesh", action="store_true", help="leave out the slow comparison")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    ict = options.generic == "ict"
    template = ict_template(options.ict or ict_folder()) if ict else mien_template()
    finder = point_finder(options.reference) if options.points == "found" else None

    rows: list[dict[str, float]] = []
    for scan, truth_file in zip(options.scan, options.truth, strict=True):
        truth = dict(np.load(truth_file))
        beside = json.loads(scan.with_suffix(".json").read_text())
        mesh = read_ply(scan)
        points = finder.find(mesh) if finder else true_points(beside)
        parameterise(template, Surface(mesh), points, options.projection)
        begin = time.perf_counter()
        done = parameterise(template, Surface(mesh), points, options.projection)
        row = {"seconds": time.perf_counter() - begin}
        row["point_mm"] = point_error(points, beside)
        row |= ict_figures(done, truth) if ict else mien_figures(done, template, truth, beside)
        if not options.no_trimesh:
            row["trimesh_seconds"] = trimesh_seconds(done, template, mesh)
            row["trimesh_ratio"] = row["seconds"] / row["trimesh_seconds"]
        rows.append(row)
    figures = {key: float(np.mean([row[key] for row in rows])) for key in rows[0]}
    names = ", ".join(scan.stem for scan in options.scan)
    title = f"{names}: {options.generic} generic, {options.points} points, {options.projection}"
    show("scan_accuracy", title, figures, options.json)


def ict_folder() -> Path:
    """Where the ICT face model lies: $MIEN_TEST_DATA/ict, or shared/data/ict beside the project."""
    named = [Path(os.environ["MIEN_TEST_DATA"], "ict")] if "MIEN_TEST_DATA" in os.environ else []
    beside = [folder / "shared" / "data" / "ict" for folder in Path(__file__).resolve().parents]
    for folder in (*named, *beside):
        if (folder / "ict_face.npz").is_file():
            return folder
    raise SystemExit("no ICT face model: name its folder with --ict")


def ict_template(folder: Path) -> Template:
    """The narrow face of the ICT model as it is, with the FDP points on it."""
    with np.load(folder / "ict_face.npz") as stored:
        vertices = MM * stored["neutral"][:NARROW].astype(float)
        faces = stored["faces"][:NARROW_FACES]
    quads = faces[faces[:, 3] >= 0]
    triangles = np.concatenate([faces[:, :3], quads[:, [0, 2, 3]]]).astype(np.int32)
    fdp = json.loads((folder / "points.json").read_text())["fdp"]
    own = {name: point["vertex"] for name, point in fdp.items() if point["vertex"] < NARROW}
    corners = np.repeat(np.array(list(own.values()), np.int32)[:, None], 3, axis=1)
    weights = np.tile([1.0, 0.0, 0.0], (len(own), 1))
    return make_template(vertices, triangles, FeaturePoints(tuple(own), corners, weights), 0)


def mien_template() -> Template:
    """The generic face, subdivided twice."""
    return face_template(generic_face().face)


def true_points(beside: dict[str, Any]) -> ScanPoints:
    """The FDP points the scanner saw, where they truly are."""
    seen = [name for name in beside["fdp"] if beside["fdp_scanned"][name]]
    return ScanPoints(tuple(seen), np.array([beside["fdp"][name] for name in seen]))


def point_finder(reference: Path | None) -> PointFinder:
    """Finds points as ``mien scan points`` does, with ``reference`` as its --like."""
    if reference is None:
        return PointFinder(detect_once())
    known = true_points(json.loads(reference.with_suffix(".json").read_text()))
    return PointFinder(detect_once(), Reference(read_ply(reference), known))


def point_error(points: ScanPoints, beside: dict[str, Any]) -> float:
    """Mean distance of the points from their true places."""
    shared = [name for name in points.ids if name in beside["fdp"]]
    true = np.array([beside["fdp"][name] for name in shared])
    return float(np.linalg.norm(points.of(shared) - true, axis=1).mean())


def ict_figures(done: Parameterised, truth: dict[str, Any]) -> dict[str, float]:
    """Over the vertices that were scanned."""
    seen = truth["vertex_scanned"][:NARROW]
    places = done.vertices[seen]
    distance, _ = to_surface(places, truth["true_vertices"].astype(float), skin(truth))
    apart = np.linalg.norm(places - truth["true_vertices"][:NARROW][seen], axis=1)
    return {"distance_mm": distance.mean(), "correspondence_mm": apart.mean()}


def mien_figures(
    done: Parameterised, template: Template, truth: dict[str, Any], beside: dict[str, Any]
) -> dict[str, float]:
    """Over the outer samples whose nearest true triangle is in the scanned narrow face."""
    triangles = skin(truth)
    distance, nearest = to_surface(done.vertices, truth["true_vertices"].astype(float), triangles)
    scanned = truth["vertex_scanned"][triangles].all(axis=1) & (triangles < NARROW).all(axis=1)
    inside = scanned[nearest] & template.outside
    ibug = np.array(beside["ibug68"])
    given = np.array(list(beside["fdp"].values()))
    apart = np.linalg.norm(ibug[:, None] - given[None], axis=2).min(axis=1)
    asked = np.flatnonzero((apart > 0.5) & (np.arange(len(ibug)) >= JAW))
    miss = np.linalg.norm(done.vertices[np.array(IBUG_LANDMARKS)[asked]] - ibug[asked], axis=1)
    return {
        "distance_mm": distance[inside].mean(),
        "correspondence_mm": miss.mean(),
        "measured_share": done.reliable[inside].mean(),
        "ibug_points": float(len(asked)),
    }


def skin(truth: dict[str, Any]) -> NDArray[np.int32]:
    """(T, 3) true triangles of the skin."""
    triangles: NDArray[np.int32] = truth["true_triangles"]
    return triangles[(triangles < SKIN).all(axis=1)]


def to_surface(
    places: Array, vertices: Array, triangles: NDArray[np.int32], candidates: int = 20
) -> tuple[Array, NDArray[np.intp]]:
    """Distance (N,) of ``places`` to a mesh, and the nearest triangle (N,)."""
    corners = vertices[triangles]
    _, near = cKDTree(corners.mean(axis=1)).query(places, candidates)
    repeated = np.repeat(places, candidates, axis=0)
    closest = trimesh.triangles.closest_point(corners[near].reshape(-1, 3, 3), repeated)
    apart = np.linalg.norm(closest - repeated, axis=1).reshape(near.shape)
    best = apart.argmin(axis=1)
    rows = np.arange(len(places))
    return apart[rows, best], near[rows, best]


def trimesh_seconds(done: Parameterised, template: Template, mesh: Mesh) -> float:
    """What trimesh's pure-Python rays take for the same looks at the scan: its index, and every
    vertex both ways in every pass, by a sample of them."""
    scan = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    begin = time.perf_counter()
    rays = trimesh.ray.ray_triangle.RayMeshIntersector(scan)
    places = done.subdivided
    normals = vertex_normals(places, template.refined_triangles)
    rays.intersects_location(places[:1], normals[:1], multiple_hits=False)
    index = time.perf_counter() - begin
    sample: Sequence[int] = np.linspace(0, len(places) - 1, TRIMESH_RAYS).astype(int).tolist()
    begin = time.perf_counter()
    for sign in (1.0, -1.0):
        rays.intersects_location(places[sample], sign * normals[sample], multiple_hits=False)
    looks = len(Settings().passes) + 1
    return index + (time.perf_counter() - begin) * looks * len(places) / TRIMESH_RAYS


if __name__ == "__main__":
    main()

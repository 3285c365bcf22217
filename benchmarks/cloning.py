"""How true motion stays that is cloned to another mesh and back.

    python benchmarks/cloning.py [--ict FOLDER] [--json]

The 25 faces of the ICT model's databank go from the ICT narrow face to the generic face's own mesh
and back. Error: of the motion that returned, over the motion that left, mean over the vertices and
faces. The trivial case (the same mesh) is measured beside it: onto itself, and onto a person of
the model, whose motion is known, with local size and with size 1.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from mien.face.face import Face, FeaturePoints, Material, Part
from mien.face.library import generic_face
from mien.sculpt.cloning import clone
from report import show
from scan_accuracy import MM, NARROW, Array, ict_folder, ict_template

PERSON = "person4"


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ict", type=Path, help="the folder of the ICT face model")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    folder = options.ict or ict_folder()
    face, generic = ict_face(folder), generic_face().face
    motions = databank(folder)
    begin = time.perf_counter()
    there = clone(face, motions, generic)
    seconds = time.perf_counter() - begin
    back = clone(generic, there, face)
    other = ict_face(folder, person(folder))
    figures = {
        "round_trip": missed(back, motions),
        "motion_mm": float(np.linalg.norm(motions, axis=2).mean()),
        "identity": missed(clone(face, motions, face), motions),
        "person_size_one": missed(clone(face, motions, other, turn=False, size=False), motions),
        "person_local": missed(clone(face, motions, other), motions),
        "seconds": seconds,
    }
    show("cloning", "ICT narrow face to the generic face and back", figures, options.json)


def missed(found: Array, true: Array) -> float:
    """Mean error over mean motion."""
    return float(np.linalg.norm(found - true, axis=2).mean() / np.linalg.norm(true, axis=2).mean())


def ict_face(folder: Path, moved: Array | float = 0.0) -> Face:
    """The narrow face as a face of ours; eyes where the model has its eyeballs."""
    template = ict_template(folder)
    with np.load(folder / "ict_face.npz") as stored:
        part, neutral = stored["vertex_part"], MM * stored["neutral"].astype(float)
        names = [str(name) for name in stored["part_names"]]
    eyes = {
        f"eye_{side}": neutral[part == names.index(f"eyeball_{letter}")].mean(axis=0)
        for side, letter in (("left", "L"), ("right", "R"))
    }
    origin = (eyes["eye_left"] + eyes["eye_right"]) / 2.0
    count = len(template.vertices)
    return Face(
        vertices=template.vertices + moved - origin,
        parts=(Part("skin", "skin", 0, count, template.triangles),),
        materials={"skin": Material()},
        colours=np.full((count, 3), 0.5),
        occlusion=np.ones(count),
        points=FeaturePoints(
            template.points.ids, template.points.vertices, template.points.weights
        ),
        pivots={
            "head": np.array([0.0, -120.0, -80.0]),
            "jaw": np.array([0.0, -20.0, -60.0]),
            **{name: place - origin for name, place in eyes.items()},
        },
    )


def databank(folder: Path) -> Array:
    """(25, V, 3) mm motion of the narrow face."""
    faces = json.loads((folder / "databank25.json").read_text())["faces"]
    with np.load(folder / "ict_face.npz") as stored:
        names = [str(name) for name in stored["expr_names"]]
        shapes = stored["expr_q"][:, :NARROW].astype(float) * _scales(stored["expr_scale"])
    rows = [
        sum(weight * shapes[names.index(name)] for name, weight in face["weights"].items())
        for face in faces.values()
    ]
    return MM * np.array(rows)


def person(folder: Path) -> Array:
    """(V, 3) mm by which a person of the model differs from its mean."""
    weights = json.loads((folder / "persons.json").read_text())["persons"][PERSON]
    with np.load(folder / "ict_identity.npz") as stored:
        modes = stored["id_q"][:, :NARROW].astype(float) * _scales(stored["id_scale"])
    return MM * np.tensordot(np.array(weights), modes, axes=1)


def _scales(scale: Any) -> Array:
    return np.asarray(scale, dtype=float)[:, None, None]


if __name__ == "__main__":
    main()

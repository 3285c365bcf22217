"""[Z]: scans on one mesh, markers, genetic blending, retargeting."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mien
from mien.face.character import Character
from mien.face.databank import Databank
from mien.face.face import Face
from mien.face.library import generic_face
from mien.face.mesh import Mesh
from mien.mapping.blend import blend, learn_misfit
from mien.mapping.bounded import bounded
from mien.mapping.genetic import genetic, published
from mien.mapping.reconstruct import Reconstruction, databank_scale, reconstruct
from mien.numeric.closest import nearest
from mien.numeric.noise import noise_of
from mien.numeric.steady import steady
from mien.performance.performance import Performance
from mien.scan.bank import build_bank
from mien.scan.parameterise import ScanPoints, parameterise
from mien.scan.performer import performer_face
from mien.scan.picture import draw, drawable, mark
from mien.scan.surface import Surface
from mien.scan.template import Template, face_template
from mien.view.renderer import Renderer
from reproduction.scanner import NOISE as SCAN_NOISE
from reproduction.scanner import SHIFT, TURN, scan
from reproduction.sheet import Picture, Results, Table, chart, grid
from reproduction.stage import Array
from reproduction.suit import NOISE, RATE, SHOWN, VIEW, Take, act, worn_places

PERSON, PERFORMER = "woman", "man"
EXPRESSIONS = (
    *("smile", "sad", "anger", "surprise", "disgust", "fear", "laugh", "brows_up", "pucker"),
    *("wide", "jaw_open"),
)
GENERATIONS = (0, 10, 20, 35, 70, 140, 300, 1000, 3000, 8000)
PAIRS = {
    "mouth corners": ("8.3", "8.4"),
    "outer brows": ("4.5", "4.6"),
    "nose tip and chin": ("9.3", "2.1"),
    "cheek bones": ("5.3", "5.4"),
}
WAYS: Mapping[str, dict[str, Any]] = {
    "as published: genetic, 70 generations": {"solver": "published", "residual": False},
    "the same, and what it leaves by a residual": {"solver": "published"},
    "genetic, mended, with the residual": {"solver": "genetic"},
    "bounded least squares, with the residual (default)": {},
}
COARSE, DENSE = 2, 3
"""Loop steps that make a scanner's density, of the bank and of figure 2."""


def results() -> Results:
    """Everything [Z] shows, from nothing."""
    template = face_template(generic_face().face)
    person, performer = mien.load_character(PERSON), mien.load_character(PERFORMER)
    ids = _on_skin(template.points.ids, person, performer)
    names = (*EXPRESSIONS, *(key for key in person.keys.names if key.startswith("viseme_")))
    shown = names[:6], names[11:17]
    bank, take = _bank(person, ids, names), act(performer, template)
    return {
        "figure_1": _raw(person, ids, shown),
        "scan_noise": SCAN_NOISE,
        **_stages(person, template, ids),
        "figure_3": _consistent(bank, shown),
        "faces": len(bank.names),
        "triangles": len(bank.face.triangles),
        "figure_4": _markers(performer, take),
        "rate": f"{RATE:.0f}",
        "marker_noise": NOISE,
        "floor": f"{NOISE * (8.0 / np.pi) ** 0.5:.2f}",
        "head": Table(["head's motion removed by", "mm"], list(take.head.items())),
        **_scale(take.performance, bank),
        **_generations(take.performance, bank),
        **_reconstructed(take, bank, _own_face(performer, template, ids), template),
    }


def _on_skin(ids: Sequence[str], *people: Character) -> tuple[str, ...]:
    """Feature points that are the same place of skin on all: a hair line is not."""
    generic = generic_face().face.points
    return tuple(
        fdp
        for fdp in ids
        if all(
            np.array_equal(generic.vertices[generic.index([fdp])], p.vertices[p.index([fdp])])
            for p in (person.face.points for person in people)
        )
    )


def _narrow(template: Template) -> NDArray[np.bool_]:
    """(W,) what a scanner sees of the refined skin, between chin and hair line, from ear to ear."""
    places, face = template.refinement @ template.vertices, generic_face().face
    low, high = face.point("2.1")[1] - 8.0, face.point("11.1")[1]
    x, y, z = places.T
    return template.outside & (y > low) & (y < high) & (z > -20.0) & (np.abs(x) < 70.0)


def _raw(person: Character, ids: Sequence[str], shown: Sequence[Sequence[str]]) -> Picture:
    rows = [[_drawn(scan(person, key, ids, COARSE)[0]) for key in row] for row in shown]
    return grid(rows, ["expressions", "visemes"], 190)


def _drawn(mesh: Mesh) -> Picture:
    return draw(drawable(_upright(mesh)), VIEW)


def _upright(mesh: Mesh) -> Mesh:
    """A scan in the head frame, which only we know."""
    return Mesh((mesh.vertices - SHIFT) @ TURN, mesh.triangles)


def _stages(
    person: Character, template: Template, ids: Sequence[str]
) -> dict[str, Picture | Table | int]:
    scanned, given = scan(person, "smile", ids, DENSE)
    mesh = _upright(scanned)
    points = ScanPoints(given.ids, (given.places - SHIFT) @ TURN)
    surface = Surface(mesh)
    normals = parameterise(template, surface, points)
    cylinder = parameterise(template, surface, points, "cylinder")
    coarse, fine = template.triangles, template.refined_triangles
    stages = (
        ("(a) scan", "699,392", mesh.triangles, mesh.vertices),
        ("(b) generic mesh", "1,485", coarse, template.vertices),
        ("(d) deformed to the points", "1,485", coarse, normals.deformed),
        ("(e) Loop's subdivision, twice", "23,760", fine, normals.subdivided),
        ("(f) cylindrical projection", "23,760", fine, cylinder.vertices),
        ("ours: along the normals", "", fine, normals.vertices),
    )
    pictures = [draw(drawable(Mesh(places, each)), VIEW) for _, _, each, places in stages]
    skin = (person.face.vertices + person.keys["smile"])[: len(template.vertices)]
    true = template.refinement @ skin
    seen = normals.reliable & cylinder.reliable & _narrow(template)
    rows = []
    for name, theirs, triangles, places in stages:
        whole = len(places) == len(true)
        off = _off(places[seen], mesh) if whole else ""
        apart = float(np.linalg.norm((places - true)[seen], axis=1).mean()) if whole else ""
        rows.append([name, theirs, len(triangles), off, apart])
    head = ["", "triangles, paper", "triangles, here", "to the scan", "from its true place"]
    marked = mark(pictures[0], VIEW, points.places)
    return {
        "figure_2": grid([[*pictures[:2], marked], pictures[2:5], pictures[5:]], "", 300),
        "stages": Table(head, rows),
        "points": len(points.ids),
    }


def _off(places: Array, mesh: Mesh) -> float:
    """mm, mean distance to the surface of a mesh."""
    triangle, weights = nearest(places, mesh.vertices, mesh.triangles)
    there = np.einsum("nk,nkx->nx", weights, mesh.vertices[mesh.triangles[triangle]])
    return float(np.linalg.norm(places - there, axis=1).mean())


def _bank(person: Character, ids: Sequence[str], names: Sequence[str]) -> Databank:
    load = partial(scan, person, ids=ids, density=COARSE)
    faces = {name: partial(load, name) for name in names}
    return build_bank(generic_face(), PERSON, partial(load, None), faces)


def _consistent(bank: Databank, shown: Sequence[Sequence[str]]) -> Picture:
    renderer = Renderer(bank.face)

    def face(name: str) -> Picture:
        moved = bank.face.vertices + bank.displacements[bank.names.index(name)]
        return renderer.render(moved, VIEW)

    return grid([[face(name) for name in row] for row in shown], ["expressions", "visemes"], 190)


def _own_face(performer: Character, template: Template, ids: Sequence[str]) -> Face:
    """The performer's own neutral, scanned, in the databank's topology."""
    mesh, points = scan(performer, None, ids, COARSE, seed=1)
    rest = parameterise(template, Surface(mesh), points)
    return performer_face(generic_face().face, template, rest, mesh)


def _markers(performer: Character, take: Take) -> Picture:
    attached = Renderer(performer.face).render(performer.face.vertices, VIEW)
    frame = take.frames[SHOWN.index("surprise")]
    moved = take.performance.neutral + take.performance.motion[frame]
    room = np.full_like(attached, 24)
    return grid([[mark(attached, VIEW, worn_places(performer)), mark(room, VIEW, moved)]], "", 330)


def _scale(performance: Performance, bank: Databank) -> dict[str, Table | str]:
    def apart(pair: tuple[str, str]) -> tuple[float, float]:
        i, j = (performance.points.index(fdp) for fdp in pair)
        theirs = bank.face.point(pair[0]) - bank.face.point(pair[1])
        worn = performance.neutral[i] - performance.neutral[j]
        return float(np.linalg.norm(worn)), float(np.linalg.norm(theirs))

    lengths = {name: apart(pair) for name, pair in PAIRS.items()}
    return {
        "scale": f"{databank_scale(list(performance.points), performance.neutral, bank.face):.3f}",
        "distances": Table(
            ["distance", "(a) capture", "(b) databank", "ratio"],
            [[name, worn, theirs, theirs / worn] for name, (worn, theirs) in lengths.items()],
        ),
    }


def _generations(performance: Performance, bank: Databank) -> dict[str, Picture | str]:
    """The error that blending leaves at the markers, by how long it went on."""
    points = list(performance.points)
    scale = databank_scale(points, performance.neutral, bank.face)
    rows = bank.face.points.index(points)
    fields = bank.face.points.at(bank.displacements.astype(float))[:, rows]
    motion = scale * performance.motion
    noise = np.full(len(points), max(noise_of(motion), 1e-3))
    motion, left = steady(motion, RATE)
    variance = (left * noise) ** 2 + learn_misfit(fields, motion, left * noise, bounded)
    problem = blend(fields, motion, variance, RATE)

    def error(weights: Array) -> float:
        missed = motion - np.tensordot(weights, fields, axes=1)
        return float(np.sqrt((missed**2).sum(axis=-1).mean()))

    exact = error(bounded(problem))
    plain = [error(published(problem, generations=n)) for n in GENERATIONS]
    mended = [error(genetic(problem, generations=n)) for n in GENERATIONS]
    return {
        "figure_6": chart(
            GENERATIONS,
            {"as published": plain, "mended": mended, "least squares": [exact] * len(plain)},
            across="generations",
            up="error at the markers, mm",
            logarithmic=True,
        ),
        "at_70": f"{plain[GENERATIONS.index(70)]:.2f}",
        "at_8000": f"{plain[-1]:.2f}",
        "mended": f"{mended[-1]:.2f}",
        "exact": f"{exact:.2f}",
    }


def _reconstructed(
    take: Take, bank: Databank, own: Face, template: Template
) -> dict[str, Picture | Table]:
    done = {
        name: reconstruct(take.performance, bank, face=own, **how) for name, how in WAYS.items()
    }
    turn, renderer = take.performance.head()[0], Renderer(own)

    def row(found: Reconstruction) -> list[Picture]:
        moved = {f: own.vertices + found.motion(f) for f in take.frames}
        return [renderer.render(places @ turn[f].T, VIEW) for f, places in moved.items()]

    first, *_, last = done.values()
    narrow = _narrow(template)
    nothing = float(np.linalg.norm(take.skin[:, narrow], axis=-1).mean())
    return {
        "figure_7": grid(
            [take.snapshots, row(first), row(last)], ["performer", "as published", "ours"], 190
        ),
        "errors": Table(
            ["", "mm"],
            [
                ["doing nothing", nothing],
                *([name, _missed(found, take, narrow)] for name, found in done.items()),
            ],
        ),
    }


def _missed(found: Reconstruction, take: Take, narrow: NDArray[np.bool_]) -> float:
    """mm, mean over the take and the narrow face."""
    errors = [
        np.linalg.norm(found.motion(frame)[: len(true)] - true, axis=-1)[narrow].mean()
        for frame, true in zip(take.sampled, take.skin, strict=True)
    ]
    return float(np.mean(errors))

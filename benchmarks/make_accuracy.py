"""How good the key models are that deformation transfer makes.

    python benchmarks/make_accuracy.py --data FOLDER [--json]

FOLDER holds ``ict`` (the ICT-FaceKit face with persons) and ``characters`` (heads by others). Error
is the mean vertex error over the mean true motion, over vertices seen from outside that move over
5 % of the shape's most in truth or result, mean over 43 shapes (ARKit's less gaze and tongue);
doing nothing is 1.

No artist between: facecap's triangles are laid on three ICT persons, where ICT's own shapes are
the truth; source is the generic ICT face. Beside it the motion of the feature points spread by
radial basis functions, and the partners' motion without a solve (expression cloning). Between two
artists' heads the error measures their taste as well.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from heads import Ict, Piece, assemble
from mien.face.character import Character
from mien.face.face import Face
from mien.face.library import generic_face
from mien.numeric import rbf
from mien.numeric.facing import ClosestPoints
from mien.numeric.normals import vertex_normals
from mien.numeric.raster import rasterize
from mien.rig.importer import import_character
from mien.sculpt.transfer.artist import follow
from mien.sculpt.transfer.correspondence import correspond, shared_points
from mien.sculpt.transfer.lids import close_lids
from mien.sculpt.transfer.make import make
from mien.sculpt.transfer.outside import outside
from mien.sculpt.transfer.skin import Skin, on_skin, skin_of
from mien.sculpt.transfer.solve import Transfer
from mien.vocabulary.arkit import names as arkit_names
from report import show

Array = NDArray[np.float64]

PERSONS = ("person1", "person3", "person6")
PICKS = ("3.1", "3.3", "3.7", "3.11", "4.3", "8.3", "9.3", "8.1", "2.2", "2.3", "8.2", "2.1")
"""Twelve picks as a user gives them; what comes in pairs is mirrored."""
MIRRORED = ("3.2", "3.4", "3.12", "3.8", "4.4", "8.4")
LAID = 6.0
"""mm within which facecap's vertices lie on ICT, or are left out."""
TURNED = np.cos(np.radians(102.0))
NAMES = sorted(n for n in arkit_names() if not n.startswith(("eyeLook", "tongueOut")))
"""The 43 shapes, in the order in which they are compared."""
GIVEN = (3, 5, 10)
"""How many shapes or poses an artist gives."""
IN_A_POSE = 6
DRAWS = 4
ANIMALS = ("fox", "koala", "triceratops")


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument(
        "--points", type=Path, default=Path(__file__).parent.parent / "tests" / "points"
    )
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    ict = Ict(options.data / "ict")
    others = options.data / "characters"
    humans = {
        "facecap": import_character(others / "facecap/facecap_plain.glb", units="face").character,
        "ict": import_character(others / "humans/ict_facekit_parts.glb", units="cm").character,
        "makehuman": import_character(
            others / "humans/makehuman_caucasian_male_units.glb", units="dm"
        ).character,
    }
    figures = without_artist(ict, humans["facecap"].face)
    figures |= between_artists(humans["ict"], humans["facecap"])
    figures |= by_example(humans["ict"], humans["facecap"])
    figures |= blinks(humans, others / "animals", options.points)
    figures |= times(ict.face())
    show("make_accuracy", "Key models made by deformation transfer", figures, options.json)


@dataclass(frozen=True)
class Head:
    """A face, its skin and its 43 shapes on that skin."""

    face: Face
    skin: Skin
    shapes: Array
    """(43, N, 3) mm."""
    seen: NDArray[np.bool_]
    """(N,) skin that is seen from outside, with all else in its place: sockets lie behind eyes."""


def merged(names: Sequence[str], fields: Array) -> dict[str, Array]:
    """The 43 shapes by ARKit's names; halves of browInnerUp and cheekPuff are summed."""
    shapes: dict[str, Array] = {}
    for name, field in zip(names, fields, strict=True):
        spelt = name.replace("_L", "Left").replace("_R", "Right")
        for whole in ("browInnerUp", "cheekPuff"):
            spelt = whole if spelt.startswith(whole) else spelt
        if spelt in NAMES:
            shapes[spelt] = shapes.get(spelt, 0.0) + np.asarray(field, dtype=float)
    return shapes


def head(character: Character) -> Head:
    """A character as a head."""
    skin = skin_of(character.face)
    shapes = merged(character.keys.names, character.keys.displacements)
    fields = skin.gather(np.stack([shapes[n] for n in NAMES]))
    return Head(character.face, skin, fields, seen_skin(character.face, skin))


def seen_skin(face: Face, skin: Skin) -> NDArray[np.bool_]:
    """(N,) what of a skin is seen past eyes, teeth and lashes."""
    whole = outside(face.vertices, np.concatenate([part.triangles for part in face.parts]))
    seen = np.zeros(len(skin.vertices), dtype=bool)
    seen[skin.welded[whole[skin.rows]]] = True
    return seen


def without_artist(ict: Ict, facecap: Face) -> dict[str, float]:
    """Figures on three persons, means."""
    source = head(ict.character())
    rows: list[dict[str, float]] = []
    for person, triangles, place in laid(ict, source, facecap):
        target = on_person(ict, source, person, triangles, place, None)
        few = on_person(ict, source, person, triangles, place, (*PICKS, *MIRRORED))
        bare, contact = transferred(source, target), transferred(source, target, contact=True)
        rows.append(
            {
                "relative_error": error(target, contact),
                "before_contact": error(target, bare),
                "twelve_picks": error(few, transferred(source, few, contact=True)),
                "rbf_points": error(target, by_points(source, target)),
                "cloning": error(target, cloned(source, target)),
                "inverted_per_10000": inverted(target, contact),
                "inverted_in_truth": inverted(target, target.shapes),
            }
        )
    return {name: float(np.mean([row[name] for row in rows])) for name in rows[0]}


def laid(
    ict: Ict, source: Head, facecap: Face
) -> Iterator[tuple[str, NDArray[np.int32], tuple[NDArray[np.int32], Array]]]:
    """For each person facecap's triangles, and corners (N, 3) and weights (N, 3) of where its
    vertices lie on the ICT skin."""
    skin = skin_of(facecap)
    warped = correspond(facecap, source.face, skin, source.skin).warped
    surface = ClosestPoints(source.skin.vertices, source.skin.triangles)
    found = surface(warped, vertex_normals(warped, skin.triangles), 18.0)
    kept = (found.distance < LAID)[skin.triangles].all(axis=1)
    corners = source.skin.triangles[found.triangle]
    for person in PERSONS:
        yield person, skin.triangles[kept], (corners, found.weights)


def on_person(
    ict: Ict,
    source: Head,
    person: str,
    triangles: NDArray[np.int32],
    place: tuple[NDArray[np.int32], Array],
    ids: Sequence[str] | None,
) -> Head:
    """A laid mesh as a head with feature points ``ids`` (all)."""
    own = ict.face(person)
    skin = skin_of(own)
    corners, weights = place
    used, local = np.unique(triangles, return_inverse=True)
    vertices = np.einsum("ncx,nc->nx", skin.vertices[corners[used]], weights[used])
    truth = np.einsum("kncx,nc->knx", source.shapes[:, corners[used]], weights[used])
    pieces = [Piece("skin", vertices, local.reshape(-1, 3).astype(np.int32))]
    for part in own.parts:
        if part.follows.startswith("eye"):
            own_triangles = (part.triangles - part.first).astype(np.int32)
            run = own.vertices[part.first : part.last]
            pieces.append(Piece(part.name, run, own_triangles, part.follows))
    at = own.points.at(own.vertices)
    places = {
        fdp: place
        for fdp, place in zip(own.points.ids, at, strict=True)
        if (ids is None and on_skin(fdp)) or fdp in (ids or ())
    }
    face = assemble(pieces, places, (own.pivots["eye_left"], own.pivots["eye_right"]))
    whole = np.zeros((len(truth), len(face.vertices), 3))
    whole[:, : len(used)] = truth
    laid_skin = skin_of(face)
    return Head(face, laid_skin, laid_skin.gather(whole), seen_skin(face, laid_skin))


def transferred(source: Head, target: Head, contact: bool = False) -> Array:
    """(43, N, 3) by this program."""
    pair = correspond(source.face, target.face, source.skin, target.skin)
    reach = np.linalg.norm(source.shapes, axis=2).max(axis=0)
    made = Transfer(source.skin, target.skin, pair, reach)(source.shapes)
    if contact:
        made, _ = close_lids(
            source.face, source.skin, source.shapes, target.face, target.skin, made
        )
    return made


def cloned(source: Head, target: Head) -> Array:
    """(43, N, 3) each vertex as its partner."""
    pair = correspond(source.face, target.face, source.skin, target.skin)
    return np.stack([pair.partner @ (pair.scale[:, None] * field) for field in source.shapes])


def by_points(source: Head, target: Head) -> Array:
    """(43, N, 3) the feature points' motion spread by radial basis functions, held by forty places
    of the head that no shape moves."""
    ids = shared_points(source.face, target.face)
    whole = source.skin.spread(source.shapes, len(source.face.vertices))
    motion = source.face.points.at(whole)[:, source.face.points.index(ids)]
    places = target.face.points.at(target.face.vertices)[target.face.points.index(ids)]
    still = np.flatnonzero(np.linalg.norm(target.shapes, axis=2).max(axis=0) < 0.05)
    still = still[:: max(1, len(still) // 40)]
    places = np.concatenate([places, target.skin.vertices[still]])
    motion = np.concatenate([motion, np.zeros((len(motion), len(still), 3))], axis=1)
    spread = rbf.influence(places, target.skin.vertices)
    return np.stack([spread @ field for field in motion])


def error(truth: Head, made: Array) -> float:
    """Mean over the shapes."""
    return float(np.mean(errors(truth, made)))


def errors(truth: Head, made: Array) -> Array:
    """(43,) of each shape."""
    seen = truth.seen
    found = []
    for true, guess in zip(truth.shapes[:, seen], made[:, seen], strict=True):
        moved, moves = np.linalg.norm(true, axis=1), np.linalg.norm(guess, axis=1)
        counts = (moved > 0.05 * moved.max()) | (moves > 0.05 * moves.max())
        apart = np.linalg.norm(true - guess, axis=1)
        found.append(apart[counts].mean() / moved[counts].mean())
    return np.array(found)


def inverted(target: Head, made: Array) -> float:
    """Triangles turned by over 102 degrees, per 10,000 and shape. mouthClose closes what jawOpen
    opened, and is judged on it: alone it drives the lips through each other whoever made it."""
    before = _normals(target.skin, target.skin.vertices)
    made = made.copy()
    made[NAMES.index("mouthClose")] += made[NAMES.index("jawOpen")]
    turned = [
        ((before * _normals(target.skin, target.skin.vertices + field)).sum(axis=1) < TURNED).mean()
        for field in made
    ]
    return 1e4 * float(np.mean(turned))


def _normals(skin: Skin, vertices: Array) -> Array:
    a, b, c = (vertices[skin.triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None])


def between_artists(ict: Character, facecap: Character) -> dict[str, float]:
    """Each from the other, with lids closed."""
    first, second = head(ict), head(facecap)
    return {
        "ict_to_facecap": error(second, transferred(first, second, contact=True)),
        "facecap_to_ict": error(first, transferred(second, first, contact=True)),
        "generic_to_ict": error(first, from_generic(first)),
        "generic_to_facecap": error(second, from_generic(second)),
    }


def from_generic(target: Head) -> Array:
    """(43, N, 3) from mien's own generic face."""
    return transferred(head(generic_face()), target, contact=True)


def by_example(ict: Character, facecap: Character) -> dict[str, float]:
    """What shapes that an artist gives tell of the rest, mean of both directions and of DRAWS
    draws: named ones, judged on the shapes not given beside plain transfer; and poses of
    IN_A_POSE shapes each, unnamed and of unknown weights, judged on all shapes."""
    heads = head(ict), head(facecap)
    rows: list[dict[str, float]] = []
    for source, target in (heads, heads[::-1]):
        made = transferred(source, target, contact=True)
        plain = errors(target, made)
        random = np.random.default_rng(0)
        for _ in range(DRAWS):
            row = {"poses_0": float(plain.mean())}
            for count in GIVEN:
                given = random.choice(len(NAMES), count, replace=False)
                own = {NAMES[k]: target.shapes[k] for k in given}
                kept = np.setdiff1d(np.arange(len(NAMES)), given)
                named = errors(target, follow(made, NAMES, target.skin, own, {}).made)
                row[f"named_{count}_plain"] = float(plain[kept].mean())
                row[f"named_{count}"] = float(named[kept].mean())
                row[f"named_{count}_given"] = float(named[given].max())
                poses = {str(k): mixed(target, random) for k in range(count)}
                shown = errors(target, follow(made, NAMES, target.skin, {}, poses).made)
                row[f"poses_{count}"] = float(shown.mean())
            rows.append(row)
    return {name: float(np.mean([row[name] for row in rows])) for name in rows[0]}


def mixed(head: Head, random: np.random.Generator) -> Array:
    """(N, 3) a pose of a head: some of its shapes at once."""
    some = random.choice(len(NAMES), IN_A_POSE, replace=False)
    return np.tensordot(random.uniform(0.4, 1.0, IN_A_POSE), head.shapes[some], axes=1)


def blinks(humans: Mapping[str, Character], animals: Path, points: Path) -> dict[str, float]:
    """Eyeball still seen from the front in a blink, percent of what is seen at rest, the worst
    eye; and the lips' gap."""
    faces = {name: character.face for name, character in humans.items()}
    for name in ANIMALS:
        file = animals / name / "obj" / "base.obj"
        found = import_character(file, points=points / f"{name}.toml", units="face")
        faces[name] = found.character.face
    seen = {name: still_seen(face, name) for name, face in faces.items()}
    figures = {f"blink_{name}_pct": value for name, value in seen.items()}
    figures["blink_pixels_pct"] = max(seen[name] for name in humans)
    figures["blink_animals_pct"] = max(seen[name] for name in ANIMALS)
    return figures


def still_seen(face: Face, name: str) -> float:
    """Percent of an eyeball's pixels, the worse eye."""
    both = ("eyeBlinkLeft", "eyeBlinkRight")
    keys = make(face, generic_face(), both, name).character.keys
    shut = face.vertices + keys.displacements.astype(float).sum(axis=0)
    before, after = eyeball_pixels(face, face.vertices), eyeball_pixels(face, shut)
    if not any(before):
        raise SystemExit(f"{name}: no eyeballs were found on import; nothing can be judged")
    return 100.0 * max(a / b for a, b in zip(after, before, strict=True) if b > 0)


def eyeball_pixels(face: Face, vertices: Array) -> tuple[int, int]:
    """Pixels of the left and right eyeball as seen from in front, ten in a millimetre."""
    triangles = np.concatenate([part.triangles for part in face.parts])
    owner = np.repeat(
        [part.follows for part in face.parts], [len(part.triangles) for part in face.parts]
    )
    middle = (face.pivots["eye_left"] + face.pivots["eye_right"]) / 2.0
    screen = (vertices - middle) * [10.0, -10.0, 1.0] + [600.0, 400.0, 1000.0]
    two_sided = np.ones(len(triangles), dtype=bool)
    ids, _ = rasterize(screen.astype(np.float32), triangles, two_sided, 1200, 800)
    seen = owner[ids[ids >= 0]]
    return int((seen == "eye_left").sum()), int((seen == "eye_right").sum())


def times(face: Face) -> dict[str, float]:
    """Seconds of one core, to make ARKit's 52 shapes for the ICT head."""
    generic = generic_face()
    make(face, generic, arkit_names(), "warm")
    start = time.process_time()
    make(face, generic, arkit_names(), "ict")
    seconds = time.process_time() - start
    source, target = skin_of(generic.face), skin_of(face)
    rows = [generic.keys.names.index(name) for name in arkit_names()]
    motion = source.gather(generic.keys.displacements[rows])
    pair = correspond(generic.face, face, source, target)
    reach = np.linalg.norm(motion, axis=2).max(axis=0)
    start = time.process_time()
    Transfer(source, target, pair, reach)(motion)
    together = time.process_time() - start
    start = time.process_time()
    for field in motion[:4]:
        Transfer(source, target, pair, reach)(field[None])
    apart = (time.process_time() - start) / 4 * len(motion)
    return {
        "seconds": seconds,
        "transfer_seconds": together,
        "separate_ratio": apart / together,
        "vertices": float(len(face.vertices)),
        "skin_vertices": float(len(target.vertices)),
    }


if __name__ == "__main__":
    main()

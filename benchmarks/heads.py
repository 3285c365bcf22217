"""Heads other people made, as faces of mien: for benchmarks, from a folder of test data."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character, KeyModels
from mien.face.face import Face, FeaturePoints, Material, Part
from mien.numeric.facing import ClosestPoints

Array = NDArray[np.float64]

ICT = Path("ict")
_OFF = frozenset({"3.5", "3.6", "7.1"})
_SKIN, _EYE, _TOOTH = (0.62, 0.42, 0.34), (0.75, 0.75, 0.72), (0.7, 0.68, 0.62)


@dataclass(frozen=True)
class Piece:
    """One part of a head: vertices (N, 3) mm and triangles (T, 3) among them."""

    name: str
    vertices: Array
    triangles: NDArray[np.int32]
    follows: str = "head"


def assemble(
    pieces: Sequence[Piece], places: Mapping[str, Array], eyes: tuple[Array, Array]
) -> Face:
    """A face of ``pieces`` (its skin first), feature points at ``places`` and eyes with centres
    ``eyes`` (left, right), all in one frame whose axes are the head frame's."""
    origin = (eyes[0] + eyes[1]) / 2.0
    skin = pieces[0]
    ids = tuple(fdp for fdp in places if fdp not in _OFF)
    found = ClosestPoints(skin.vertices, skin.triangles)(np.array([places[fdp] for fdp in ids]))
    parts, first = [], 0
    for piece in pieces:
        last = first + len(piece.vertices)
        triangles = (piece.triangles + first).astype(np.int32)
        material = piece.name.partition("_")[0]
        parts.append(Part(piece.name, material, first, last, triangles, piece.follows))
        first = last
    colours = {"skin": _SKIN, "eye": _EYE, "teeth": _TOOTH}
    vertices = np.concatenate([piece.vertices for piece in pieces]) - origin
    return Face(
        vertices=vertices,
        parts=tuple(parts),
        materials={part.material: Material() for part in parts},
        colours=np.concatenate(
            [
                np.tile(colours.get(part.material, _SKIN), (part.last - part.first, 1))
                for part in parts
            ]
        ),
        occlusion=np.ones(first),
        points=FeaturePoints(ids, skin.triangles[found.triangle], found.weights),
        pivots={
            "head": np.array([0.0, -110.0, -80.0]),
            "jaw": np.array([0.0, -20.0, -55.0]),
            "eye_left": eyes[0] - origin,
            "eye_right": eyes[1] - origin,
        },
    )


class Ict:
    """The ICT face: persons, each with the same 55 shapes."""

    def __init__(self, folder: Path) -> None:
        self._face = np.load(folder / "ict_face.npz")
        self._identity = np.load(folder / "ict_identity.npz")
        self.points = json.loads((folder / "points.json").read_text())["fdp"]
        self.persons = json.loads((folder / "persons.json").read_text())["persons"]
        quads = self._face["faces"].astype(np.int64)
        fans = np.concatenate([quads[:, :3], quads[quads[:, 3] >= 0][:, [0, 2, 3]]])
        self._owner = np.concatenate(
            [self._face["face_part"], self._face["face_part"][quads[:, 3] >= 0]]
        )
        self._triangles = fans.astype(np.int32)
        self.unit = float(self._face["unit_mm"])
        self.names = tuple(str(name) for name in self._face["expr_names"])

    def vertices(self, person: str) -> Array:
        """(26719, 3) mm."""
        neutral = self._face["neutral"].astype(float)
        if person != "generic":
            weights = np.asarray(self.persons[person], dtype=float)
            modes = self._identity["id_q"][: len(weights)].astype(float)
            modes *= self._identity["id_scale"][: len(weights), None, None]
            neutral = neutral + np.tensordot(weights, modes, axes=1)
        return neutral * self.unit

    def displacements(self) -> Array:
        """(55, 26719, 3) mm, of every person."""
        scale = self._face["expr_scale"][:, None, None] * self.unit
        return np.asarray(self._face["expr_q"].astype(float) * scale)

    def piece(self, vertices: Array, name: str, parts: Sequence[int], follows: str) -> Piece:
        """The ``parts`` (numbers) as one piece."""
        used, local = np.unique(self._triangles[np.isin(self._owner, parts)], return_inverse=True)
        return Piece(name, vertices[used], local.reshape(-1, 3).astype(np.int32), follows)

    PIECES = (
        ("skin", (0, 1, 2, 3, 4), "head"),
        ("gums", (5,), "head"),
        ("teeth", (6,), "head"),
        ("eye_left", (7,), "eye_left"),
        ("eye_right", (8,), "eye_right"),
    )

    def rows(self) -> NDArray[np.intp]:
        """The vertices of the face, in its order."""
        return np.concatenate(
            [np.unique(self._triangles[np.isin(self._owner, parts)]) for _, parts, _ in self.PIECES]
        )

    def face(self, person: str = "generic", ids: Sequence[str] | None = None) -> Face:
        """A person in the head frame, with feature points ``ids`` (all there are)."""
        vertices = self.vertices(person)
        pieces = [self.piece(vertices, *piece) for piece in self.PIECES]
        places = {
            fdp: vertices[given["vertex"]]
            for fdp, given in self.points.items()
            if ids is None or fdp in ids
        }
        left, right = (_middle(vertices[21451:23021]), _middle(vertices[23021:24591]))
        return assemble(pieces, places, (left, right))

    def character(self, person: str = "generic") -> Character:
        """A person with all 55 shapes."""
        shapes = self.displacements()[:, self.rows()].astype(np.float32)
        keys = KeyModels(self.names, shapes)
        return Character(person, self.face(person), keys, self.names)


def _middle(vertices: Array) -> Array:
    """Of the box about an eyeball: a mean would lie towards its denser front."""
    return np.asarray((vertices.min(axis=0) + vertices.max(axis=0)) / 2.0)

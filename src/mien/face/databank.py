"""A databank: expressions of one person as meshes in which the same vertex is the same skin point.

It is kept as a character is (``character``), so that whatever takes a character takes a databank.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character, KeyModels
from mien.face.face import Face
from mien.face.shape_space import PUPIL_DISTANCE, ShapeSpace, generic_space
from mien.numeric.procrustes import align, rigid
from mien.numeric.rotation import to_vector
from mien.vocabulary.landmarks import feature_points

_SIZES = (0.6, 1.7)
"""Performer over databank: beyond, it is the unit that is wrong."""
_ASIDE = 3.0
"""mm by which a landmark may lie beside its feature point."""
_TURNED, _SHIFTED = 0.3, 60.0
"""Radians and mm between two faces beyond which they stand in different frames; less may be their
own difference."""


@dataclass(frozen=True, slots=True, eq=False)
class Databank:
    """K faces of one person beside the neutral [Z] §2. Remembered by identity, as characters."""

    name: str
    face: Face
    """The person's neutral, with feature points, in the head frame."""
    names: tuple[str, ...]
    """(K) such as "smile", "v06"; the neutral is not among them."""
    displacements: NDArray[np.float32]
    """(K, V, 3) mm from the neutral."""

    def __post_init__(self) -> None:
        wanted = (len(self.names), len(self.face.vertices), 3)
        if self.displacements.shape != wanted or not self.names:
            raise ValueError(f"faces of shape {self.displacements.shape}, expected {wanted}")

    def character(self) -> Character:
        """The same as a character that has every face as an example."""
        return Character(
            self.name, self.face, KeyModels(self.names, self.displacements), self.names
        )


def databank(character: Character) -> Databank:
    """A character's examples as a databank. Raises ValueError where it has none."""
    rows = [character.keys.names.index(name) for name in character.examples]
    return Databank(
        character.name, character.face, character.examples, character.keys.displacements[rows]
    )


def performer_face(bank: Databank, vertices: NDArray[np.float64]) -> Face:
    """The databank's face with a performer's own neutral ``vertices`` (V, 3), mm, of the same
    topology. It is turned into the head frame where it plainly stands in another.

    Raises ValueError, for a user to read, where it has another topology or size.
    """
    theirs = bank.face.vertices
    if vertices.shape != theirs.shape:
        raise ValueError(
            f"has {len(vertices)} vertices and the databank {len(theirs)}; build both from one mesh"
        )
    size = 1.0 / align(vertices, theirs).scale
    if not _SIZES[0] < size < _SIZES[1]:
        raise ValueError(f"is {size:.2g} times the databank's size; export it in millimetres")
    pose = rigid(vertices, theirs)
    turn = np.linalg.norm(to_vector(pose.rotation))
    if turn > _TURNED or np.linalg.norm(pose.shift) > _SHIFTED:
        vertices = pose(vertices)
    onto = align(theirs, vertices)
    pivots = {name: onto(place) for name, place in bank.face.pivots.items()}
    return replace(bank.face, vertices=vertices, pivots=pivots)


def shape_space(bank: Databank) -> ShapeSpace:
    """What the tracker knows of faces, with the databank's person as the one who is likeliest and
    her faces as expressions; others still differ as people do.

    Raises ValueError where the databank was not built on the generic face: its skin's first
    vertices have to be the detector's landmarks.
    """
    generic = generic_space()
    face, count = bank.face, len(generic.neutral)
    if len(face.vertices) < count:
        raise ValueError(f"{bank.name} was not built on the generic face")
    marked = [(fdp, row) for fdp, row in feature_points().items() if fdp in face.points.ids]
    places = face.points.at(face.vertices)[face.points.index([fdp for fdp, _ in marked])]
    apart = np.linalg.norm(face.vertices[[row for _, row in marked]] - places, axis=1)
    if not marked or np.median(apart) > _ASIDE:
        raise ValueError(f"{bank.name} was not built on the generic face")
    eyes = face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    return replace(
        generic,
        neutral=face.vertices[:count] * scale,
        expression=bank.displacements[:, :count].astype(float) * scale,
        names=bank.names,
        spread=np.full(len(bank.names), generic.spread.mean()),
    )

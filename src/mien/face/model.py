"""A model: what a character's file holds before anybody knows where its face is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Ints

Fields = Mapping[int, NDArray[np.float32]]


@dataclass(frozen=True, slots=True)
class ModelPart:
    """One run of triangles, placed in the world of its file."""

    name: str
    vertices: Array
    """(V, 3) at weights zero, in the file's world and unit."""
    triangles: Ints
    """(T, 3) counter-clockwise seen from outside."""
    colours: Array
    """(V, 3) linear RGB albedo, 0..1."""
    node: int | None = None
    """The node of a glTF file that places it."""
    primitive: int = 0
    """Which of its mesh's primitives it is."""


@dataclass(frozen=True, slots=True)
class Bind:
    """How much of a mesh's morph target goes with a shape."""

    mesh: int
    target: int
    weight: float = 1.0


@dataclass(frozen=True, slots=True)
class Shape:
    """One thing a file can do with its face, under the file's own name."""

    name: str
    fields: Fields
    """(V, 3) displacement of each part it moves, by number of the part."""
    binds: tuple[Bind, ...] = ()
    expression: str = ""
    """Name of the VRM expression it is, or empty."""


@dataclass(frozen=True, slots=True)
class Hooks:
    """Nodes of a glTF file that turn head and eyes."""

    head: int | None = None
    eyes: tuple[int | None, int | None] = (None, None)
    """Left, right."""
    vrm: int | None = None
    """0 or 1 where the file is a VRM of that version."""
    bones: Mapping[str, int] = field(default_factory=dict)
    """Nodes of VRM's humanoid bones by their VRM 1.0 names."""


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """Parts and shapes, axes and unit of whoever made them; +y is up."""

    name: str
    parts: tuple[ModelPart, ...]
    shapes: tuple[Shape, ...]
    unit: float | None = None
    """Millimetres in a unit, where the format says."""
    forward: int | None = None
    """1 where the format says that faces look to +z, -1 to -z, None where it does not say."""
    notes: tuple[str, ...] = ()
    """What was mended or odd, for a person to read."""
    hooks: Hooks = Hooks()
    overrides: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """What VRM expressions take "blink", "lookAt" and "mouth" away: "block" or "blend"."""
    head_place: Array | None = None
    """(3,) where the joint stands about which the head turns, if there is one."""
    source: bytes | None = None
    """The whole file as one GLB, for formats that can be animated as they are."""

    @property
    def vertices(self) -> Array:
        """(V, 3) of all parts, in their order."""
        return np.concatenate([part.vertices for part in self.parts])

    @property
    def triangles(self) -> Ints:
        """(T, 3) into ``vertices``."""
        first = np.cumsum([0, *(len(part.vertices) for part in self.parts)])[:-1]
        return np.concatenate(
            [part.triangles + start for part, start in zip(self.parts, first, strict=True)]
        ).astype(np.int32)

    def dense(self, shape: Shape) -> NDArray[np.float32]:
        """(V, 3) displacement of all vertices."""
        return np.concatenate(
            [
                shape.fields.get(i, np.zeros((len(part.vertices), 3), np.float32))
                for i, part in enumerate(self.parts)
            ]
        ).astype(np.float32)

"""A plain triangle mesh, as a scanner gives it: no parts, no feature points, no head frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Ints


@dataclass(frozen=True, slots=True)
class Mesh:
    """Vertices and triangles in the axes and the unit of whoever made them."""

    vertices: Array
    """(V, 3), finite."""
    triangles: Ints
    """(T, 3) three different vertices each, counter-clockwise seen from outside."""
    colours: Array | None = None
    """(V, 3) linear RGB, 0..1."""
    unit: str = ""
    """Name of the unit of length, where the file says."""

    def compact(self, keep: NDArray[np.bool_]) -> Mesh:
        """The triangles where ``keep`` (T,), and no vertices but theirs."""
        triangles = self.triangles[keep]
        used = np.zeros(len(self.vertices), bool)
        used[triangles] = True
        number = np.cumsum(used) - 1
        return Mesh(
            self.vertices[used],
            number[triangles].astype(np.int32),
            None if self.colours is None else self.colours[used],
            self.unit,
        )

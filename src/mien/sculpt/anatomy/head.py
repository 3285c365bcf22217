"""A head in one pose: cage, skin and what it does."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.numeric.normals import vertex_normals
from mien.sculpt.acting.ease import eased
from mien.sculpt.acting.expression import Expression
from mien.sculpt.acting.pose import posed_cage
from mien.sculpt.acting.wrinkles import wrinkles
from mien.sculpt.anatomy.cage import cage
from mien.sculpt.anatomy.neutral import neutral_cage
from mien.sculpt.anatomy.skin import clear_of_eyes
from mien.sculpt.proportions import Proportions

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Head:
    """Sculpting frame, mm."""

    proportions: Proportions
    expression: Expression
    cage: Array
    """(count, 3)"""
    skin: Array
    """(fine, 3)"""
    normals: Array
    """(fine, 3)"""

    def mirrored(self) -> Head:
        """The same head in a looking glass."""
        mesh = cage()
        flip = np.array([-1, 1, 1])
        return replace(
            self,
            expression=self.expression.mirrored(),
            cage=self.cage[mesh.mirror] * flip,
            skin=self.skin[mesh.fine_mirror] * flip,
            normals=self.normals[mesh.fine_mirror] * flip,
        )

    def posed(self, expression: Expression) -> Head:
        """This neutral head with ``expression`` on it. Poses of the right side are mirror images
        of those of the left, to the last bit."""
        if expression.is_right_sided():
            return self.posed(expression.mirrored()).mirrored()
        places = posed_cage(self.cage, self.proportions, expression)
        eye = self.proportions.eye
        moved = self.skin + cage().subdivision.matrix @ (places - self.cage)
        moved += wrinkles(self.skin, self.normals, expression)
        skin = eased(self.skin, clear_of_eyes(moved, eye), eye)
        head = _head(self.proportions, expression, places, skin)
        return _symmetrised(head) if expression.is_symmetric() else head


def neutral_head(proportions: Proportions) -> Head:
    """The head at rest, its own mirror image."""
    places = neutral_cage(proportions)
    skin = clear_of_eyes(cage().subdivision.matrix @ places, proportions.eye)
    return _symmetrised(_head(proportions, Expression(), places, skin))


def _head(proportions: Proportions, expression: Expression, places: Array, skin: Array) -> Head:
    triangles = cage().subdivision.triangles
    return Head(
        proportions, expression, places, skin, vertex_normals(skin, triangles.astype(np.int32))
    )


def _symmetrised(head: Head) -> Head:
    other = head.mirrored()
    return replace(
        head,
        cage=0.5 * (head.cage + other.cage),
        skin=0.5 * (head.skin + other.skin),
        normals=0.5 * (head.normals + other.normals),
    )

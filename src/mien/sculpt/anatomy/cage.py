"""The cage: the coarse mesh every head is sculpted on.

    0 .. 467        the detector's landmarks (the mask)
    then            15 rings of 36 from the silhouette over the skull to the neck
                    5 rings of 20 and one closing vertex: the mouth bag
                    2 rings of 16: the thickness of the lids, left and right

Loop's subdivision keeps these vertices first, so that landmark i is skin vertex i.
"""

from __future__ import annotations

from collections import defaultdict, deque
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from mien.numeric.biharmonic import uniform_laplacian
from mien.numeric.loop import Subdivision, subdivide
from mien.vocabulary import topology

Array = NDArray[np.float64]
Index = NDArray[np.intp]

RINGS, AROUND = 15, len(topology.SILHOUETTE)
BAG_RINGS, LIP_AROUND, LID_AROUND = 5, 20, 16

LIDS: tuple[Index, Index] = (topology.LID_LOOPS, topology.mirrored(topology.LID_LOOPS))
"""(4, 16) each: margin, roll, crease, orbit of the left and of the right eye."""
LIPS = topology.LIP_LOOPS


@dataclass(frozen=True, slots=True)
class Cage:
    """Connectivity only; positions are arrays (count, 3) beside it."""

    count: int
    triangles: Index
    rings: Index
    """(15, 36), each starting at the midline on top and going round by the subject's left."""
    bag: Index
    """(5, 20) behind the inner edge of the lips, position by position."""
    bag_end: int
    lid_inner: Index
    """(2, 16) behind the lid margins, left and right."""
    mirror: Index
    """(count,) partner on the other side."""
    laplacian: sparse.csr_matrix
    subdivision: Subdivision
    fine_mirror: Index
    """Partner of each vertex of the subdivided mesh."""

    def label(self, vertices: Index) -> Array:
        """(fine,) 1 on the subdivided surface of ``vertices``, fading over one triangle."""
        marked = np.zeros(self.count)
        marked[vertices] = 1.0
        return np.asarray(self.subdivision.matrix @ marked)

    def symmetrised(self, positions: Array) -> Array:
        """Mean of cage ``positions`` (count, 3) and their mirror image."""
        return np.asarray(0.5 * (positions + positions[self.mirror] * [-1, 1, 1]))


@cache
def cage() -> Cage:
    """The cage; there is only one."""
    base = topology.LANDMARKS
    rings = base + np.arange(RINGS * AROUND).reshape(RINGS, AROUND)
    base += rings.size
    bag = base + np.arange(BAG_RINGS * LIP_AROUND).reshape(BAG_RINGS, LIP_AROUND)
    bag_end = base + bag.size
    lid_inner = bag_end + 1 + np.arange(2 * LID_AROUND).reshape(2, LID_AROUND)
    count = int(lid_inner[-1, -1]) + 1

    skull_strips = np.vstack([topology.SILHOUETTE, rings])
    bag_strips = np.vstack([LIPS[0], bag])
    end = np.roll(bag[-1], -1)
    triangles = np.concatenate(
        [
            topology.TRIANGLES,
            *(_strip(a, b, 0) for a, b in pairwise(skull_strips)),
            *(_strip(a, b, LIP_AROUND // 4) for a, b in pairwise(bag_strips)),
            np.stack([bag[-1], end, np.full(LIP_AROUND, bag_end)], axis=1),
            *(_strip(lids[0], inner) for lids, inner in zip(LIDS, lid_inner, strict=True)),
        ]
    )
    triangles = _wound_alike(triangles)
    mirror = np.arange(count)
    mirror[: topology.LANDMARKS] = topology.MIRROR
    mirror[rings] = rings[:, -np.arange(AROUND) % AROUND]
    mirror[bag] = bag[:, (LIP_AROUND // 2 - np.arange(LIP_AROUND)) % LIP_AROUND]
    mirror[lid_inner] = lid_inner[::-1]
    subdivision = subdivide(triangles, count)
    return Cage(
        count,
        triangles,
        rings,
        bag,
        bag_end,
        lid_inner,
        mirror,
        uniform_laplacian(triangles, count),
        subdivision,
        _fine_mirror(mirror, subdivision.edges),
    )


def _strip(inner: Index, outer: Index, midline: int | None = None) -> Index:
    """Triangles between two closed loops. Where both cross the midline at position ``midline``
    the diagonals change there, so that the strip is its own mirror image."""
    here = np.arange(len(inner))
    there = (here + 1) % len(inner)
    a, b, c, d = inner[here], inner[there], outer[there], outer[here]
    far = np.zeros(len(inner), bool)
    if midline is not None:
        far = (here - midline) % len(inner) >= len(inner) // 2
    first = np.where(far[:, None], np.stack([a, d, c], 1), np.stack([a, d, b], 1))
    second = np.where(far[:, None], np.stack([a, c, b], 1), np.stack([b, d, c], 1))
    return np.concatenate([first, second])


def _wound_alike(triangles: Index) -> Index:
    """All triangles wound as the first one, which is the detector's and known to be right."""
    users: dict[tuple[int, int], list[int]] = defaultdict(list)
    for row, (a, b, c) in enumerate(triangles.tolist()):
        for edge in ((a, b), (b, c), (c, a)):
            users[min(edge), max(edge)].append(row)
    wound = triangles.copy()
    seen, queue = {0}, deque([0])
    while queue:
        a, b, c = wound[queue.popleft()].tolist()
        for here, there in ((a, b), (b, c), (c, a)):
            for row in users[min(here, there), max(here, there)]:
                if row in seen:
                    continue
                other = wound[row].tolist()
                if other[(other.index(here) + 1) % 3] == there:
                    wound[row] = wound[row, ::-1]
                seen.add(row)
                queue.append(row)
    return wound


def _fine_mirror(mirror: Index, edges: Index) -> Index:
    number = {(a, b): len(mirror) + row for row, (a, b) in enumerate(edges.tolist())}
    partners = np.sort(mirror[edges], axis=1).tolist()
    return np.concatenate([mirror, [number[a, b] for a, b in partners]])

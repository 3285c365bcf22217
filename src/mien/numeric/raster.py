"""A z-buffer: which triangle is seen through each sample of a picture."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]
Flags = NDArray[np.bool_]

NOTHING = -1
"""The triangle of a sample through which nothing is seen."""


def rasterize(
    screen: Floats, triangles: Ints, two_sided: Flags, width: int, height: int
) -> tuple[Ints, Floats]:
    """Visible triangles.

    ``screen`` (V, 3): x to the right and y down in samples, the centre of the first sample being
    (0.5, 0.5), and a nearness that is linear on the screen, larger where nearer, and above zero.
    ``triangles`` (T, 3) counter-clockwise as seen; ``two_sided`` (T,) are seen from behind too.
    Of equally near triangles the first is seen.

    Returns the index of the triangle (height, width), NOTHING where there is none, and its
    nearness (height, width), 0 where there is none.
    """
    ids = np.full((height, width), NOTHING, dtype=np.int32)
    nearness = np.zeros((height, width), dtype=np.float32)
    fill(np.ascontiguousarray(screen, dtype=np.float32), triangles, two_sided, ids, nearness)
    return ids, nearness


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def fill(screen: Floats, triangles: Ints, two_sided: Flags, ids: Ints, nearness: Floats) -> None:
    """As ``rasterize``, into ``ids`` and ``nearness``, which must come cleared.

    Each row of a triangle is cut to the span between its edges first: most triangles of a head
    are small and many are slivers, whose boxes are nearly empty.
    """
    height, width = ids.shape
    # The slack lets both neighbours own a sample that lies on their edge: no cracks.
    half, slack = np.float32(0.5), np.float32(1e-3)
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, az = screen[i, 0], screen[i, 1], screen[i, 2]
        bx, by, bz = screen[j, 0], screen[j, 1], screen[j, 2]
        cx, cy, cz = screen[k, 0], screen[k, 1], screen[k, 2]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        # y runs down, so what faces us turns the other way round.
        if area == 0.0 or (area > 0.0 and not two_sided[t]):
            continue
        top = max(0, int(np.ceil(min(ay, by, cy) - half)))
        bottom = min(height - 1, int(np.floor(max(ay, by, cy) - half)))
        leftmost = max(np.float32(0.0), min(ax, bx, cx) - half)
        rightmost = min(np.float32(width - 1), max(ax, bx, cx) - half)
        if bottom < top or rightmost < leftmost:
            continue
        scale = np.float32(1.0) / area
        z_x = ((bz - az) * (cy - ay) - (cz - az) * (by - ay)) * scale
        z_y = ((cz - az) * (bx - ax) - (bz - az) * (cx - ax)) * scale
        # dx/dy of each edge; an edge along a row bounds nothing there.
        ab = (bx - ax) / (by - ay) if by != ay else np.float32(0.0)
        bc = (cx - bx) / (cy - by) if cy != by else np.float32(0.0)
        ca = (ax - cx) / (ay - cy) if ay != cy else np.float32(0.0)
        for y in range(top, bottom + 1):
            py = np.float32(y) + half
            low, high = np.float32(1e9), np.float32(-1e9)
            if (py >= ay) != (py >= by):
                x = ax + (py - ay) * ab
                low, high = min(low, x), max(high, x)
            if (py >= by) != (py >= cy):
                x = bx + (py - by) * bc
                low, high = min(low, x), max(high, x)
            if (py >= cy) != (py >= ay):
                x = cx + (py - cy) * ca
                low, high = min(low, x), max(high, x)
            first = int(np.ceil(max(leftmost, low - half - slack)))
            last = int(np.floor(min(rightmost, high - half + slack)))
            z_row = az + (py - ay) * z_y + (half - ax) * z_x
            for column in range(first, last + 1):
                z = z_row + np.float32(column) * z_x
                if z > nearness[y, column]:
                    nearness[y, column] = z
                    ids[y, column] = t

"""What the tracker saw in a frame, for people who look over its shoulder."""

from __future__ import annotations

import numpy as np

from mien.capture.tracker.person import Person
from mien.capture.tracker.track import Found
from mien.capture.tracker.visibility import contour, visible_triangles
from mien.performance.trace import Trace

_AXIS = 45.0
"""mm of each axis that is drawn."""
_SQUARE = np.array([[-1.5, -1.5], [1.5, -1.5], [1.5, 1.5], [-1.5, 1.5]])
"""Pixels, what marks a point of the skin."""


def trace(person: Person, found: Found) -> Trace:
    """The fitted mesh as far as it faces the camera, the texels that were compared, the points that
    were found again, the outline with the edges it was drawn to, and the head's axes."""
    state, lens = found.state, person.lens()
    shape = person.neutral + np.tensordot(state.weights, person.space.expression, axes=1)
    vertices = shape @ state.rotation.T + state.translation
    pixels = lens.project(vertices)
    shown = person.space.triangles[visible_triangles(vertices, person.space.triangles)]
    edges = np.sort(np.concatenate([shown[:, [0, 1]], shown[:, [1, 2]], shown[:, [2, 0]]]), axis=1)
    tips = np.concatenate([np.zeros((1, 3)), _AXIS * np.eye(3)])
    curves = {"silhouette": pixels[contour(vertices, person.space.triangles)]}
    curves |= {f"edge {i}": ends for i, ends in enumerate(found.edges)}
    boxes = {f"point {i}": place + _SQUARE for i, place in enumerate(found.points)}
    return Trace(
        curves=curves,
        boxes=boxes,
        points=lens.project(person.texels.take(found.used).seen(state)),
        wire=pixels[np.unique(edges, axis=0)],
        axes=lens.project(tips @ state.rotation.T + state.translation),
        notes=found.notes,
    )

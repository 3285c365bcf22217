"""Meeting a performer: who it is, where the camera stands, how the face looks at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import HeadModel, fit_heads
from mien.capture.landmarks import Calibration
from mien.capture.track import KEPT
from mien.capture.tracker.bundle import Rest, View, refine
from mien.capture.tracker.crop import Crop
from mien.capture.tracker.look import take
from mien.capture.tracker.person import Person, person
from mien.capture.tracker.solve import Term
from mien.capture.tracker.state import State
from mien.capture.tracker.track import Tracker, anchors
from mien.capture.tracker.trust import Trust
from mien.face.shape_space import ShapeSpace, generic_space
from mien.numeric.biharmonic import Handles, spread, uniform_laplacian
from mien.numeric.rotation import angle_between
from mien.vocabulary.landmarks import FACE_LANDMARKS

Array = NDArray[np.float64]
Index = NDArray[np.intp]

ROWS = np.array([row for row, landmark in enumerate(KEPT) if landmark < FACE_LANDMARKS])
"""Rows of a landmark track that lie on the face."""
VERTICES = np.array(KEPT)[ROWS]
"""Their vertices in the generic space."""

VIEWS = 12
_FARTHEST = 38.0
"""Degrees from rest beyond which a view shows too little of the same skin."""
_CALM = 0.75
"""Share of a take's frames that may serve as views: strong expressions pass for shape, and a brow
that is lowered in every bow of the head for one that juts out."""
_POSE_SIGMA = (np.array([0.05, 0.02, 0.005]), 10.0)
"""Radians about x, y and z, and mm, by which landmarks may place the face at rest wrongly. Networks
err alike to the left and to the right: of roll they know most, of pitch least."""
_FREE_MODES = 30
_ROUNDS = (0, 0, 0, 1, 1, 1)
_IDENTITY_SIGMA = np.array([1.0, 1.0, 2.0])
"""mm along x, y, z of the landmarks' neutral."""


class Crops(Protocol):
    """The faces of a take, by their number among those seen."""

    def __getitem__(self, index: int, /) -> Crop:
        """One of them."""


@dataclass(frozen=True, slots=True)
class Meeting:
    """What is known of a performer once met."""

    person: Person
    rest: State
    crop: Crop
    """Of the frame at rest."""


def generic_person(
    known: Calibration, size: tuple[int, int], space: ShapeSpace | None = None
) -> Person:
    """The person of ``space``, or of the generic face's, that the landmarks' calibration
    describes. Its vertices are the detector's landmarks."""
    space = space or generic_space()
    places = known.model[ROWS]
    neutral = space.person(space.identify(VERTICES, places, _IDENTITY_SIGMA))
    handles = Handles(len(neutral))
    handles.add(VERTICES, places - neutral[VERTICES], 0.3)
    neutral += spread(
        uniform_laplacian(space.triangles.astype(np.intp), len(neutral)), handles, 0.01
    )
    corners = np.repeat(VERTICES[:, None], 3, axis=1).astype(np.int32)
    shares = np.tile([1.0, 0.0, 0.0], (len(VERTICES), 1))
    return person(space, neutral, (corners, shares), ROWS, known.focal, size)


def meet(
    somebody: Person,
    points: Array,
    rest: slice,
    crops: Crops,
    trust: Trust | None = None,
) -> Meeting:
    """Get to know ``somebody`` from landmarks (F, N, 2) in pixels, of which frames ``rest`` are
    neutral, and their ``crops``."""
    trust = trust or Trust()
    middle = (rest.start + rest.stop) // 2
    usual = np.median(points[rest], axis=0)
    state = _at_rest(somebody, usual)
    somebody = _excused(somebody, usual, state)
    if not trust.meeting:
        return Meeting(somebody, state, crops[middle])
    states = _alone(somebody, points)
    chosen = spread_views(states, state.rotation)
    start = Tracker(somebody, [take(somebody, crops[middle], state)], state, trust)
    views = [View(crops[i], states[i], points[i]) for i in chosen.tolist()]

    def known(who: Person, at_rest: State, view: View, own: State) -> list[Term]:
        return anchors(_excused(who, usual, at_rest), view.points, own, trust)

    modes = somebody.space.identity[:_FREE_MODES]
    met, state, _ = refine(
        somebody,
        Rest(crops[middle], state, _POSE_SIGMA),
        views,
        start.rows,
        modes,
        trust.texture,
        _ROUNDS,
        known,
    )
    return Meeting(_excused(met, usual, state), state, crops[middle])


def spread_views(states: Sequence[State], rest: Array) -> Index:
    """Frames that lie far from each other and from the rotation ``rest`` (3, 3), but not too far,
    and in which the face does not act much."""
    rotations = np.array([state.rotation for state in states])
    acting = np.array([np.linalg.norm(state.weights) for state in states])
    away = np.degrees(angle_between(rest, rotations))
    near = np.flatnonzero((away < _FARTHEST) & (acting <= np.quantile(acting, _CALM)))
    gap = away[near]
    chosen: list[int] = []
    for _ in range(min(VIEWS, len(near))):
        best = int(near[np.argmax(gap)])
        if best in chosen:
            break
        chosen.append(best)
        turn = np.degrees(angle_between(rotations[best], rotations[near]))
        gap = np.minimum(gap, turn)
    return np.array(sorted(chosen), dtype=np.intp)


def _at_rest(somebody: Person, usual: Array) -> State:
    """The pose in which the neutral face shows the landmarks ``usual`` (N, 2)."""
    shapes = np.zeros((0, len(usual), 3))
    model = HeadModel(somebody.landmarks.neutral, shapes, np.arange(len(usual)))
    fit = fit_heads(model, ((usual - somebody.centre) / somebody.focal)[None])
    return State(fit.rotation[0], fit.translation[0], np.zeros(len(somebody.space.names)))


def _excused(somebody: Person, usual: Array, state: State) -> Person:
    """``somebody`` whose landmarks are known to miss what they miss at rest."""
    pixels = somebody.focal / state.translation[2]
    shown = somebody.lens().project(somebody.landmarks.seen(state))
    return replace(somebody, offset=(usual - shown) / pixels)


def _alone(somebody: Person, points: Array) -> list[State]:
    """What the landmarks of every frame tell by themselves."""
    shapes = somebody.landmarks.fields()
    model = HeadModel(somebody.landmarks.neutral, shapes, np.arange(points.shape[1]))
    fit = fit_heads(model, (points - somebody.centre) / somebody.focal)
    return [State(*each) for each in zip(fit.rotation, fit.translation, fit.weights, strict=True)]

"""Following a face from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import HeadModel, fit_heads
from mien.capture.tracker.crop import Crop
from mien.capture.tracker.landmark_term import LandmarkTerm
from mien.capture.tracker.look import Look, pictures, take, visible
from mien.capture.tracker.person import Person
from mien.capture.tracker.point_term import PointTracks, corners
from mien.capture.tracker.prior_term import MotionTerm, PriorTerm
from mien.capture.tracker.silhouette_term import SilhouetteTerm, folds, match
from mien.capture.tracker.solve import Term, solve, step
from mien.capture.tracker.state import State
from mien.capture.tracker.texture_term import Normaliser, TextureTerm
from mien.capture.tracker.trust import Trust
from mien.numeric.rotation import angle_between

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]
Index = NDArray[np.intp]


ANCHOR_SIGMA = 4.0
"""mm, of a landmark's place."""
PREDICTOR_SIGMA = 1.0
"""mm, of its motion."""
MOTION_SIGMA = (0.05, 8.0, 0.3)
"""Radians, mm and weight by which a frame may differ from what the one before lets expect."""
POINT_SIGMA, SILHOUETTE_SIGMA = 0.5, 1.0
"""mm, of a point's place, and of an edge across the outline."""
LEVELS = (0, 1, 1)
"""Of looks, one Gauss-Newton step each."""
SAMPLES = 1800
EVERY, DOUBT = 15, 1.3
"""Every so many frames, and where looks agree so much less than usual, the landmarks' own pose is
tried too."""
KEY_APART, KEY_FROM, KEY_NEARER = 15.0, 28.0, 8.0
"""Degrees: between looks that are kept, from rest until another look may serve, and by which that
one must be nearer."""
SURE = 1.1
"""Times the usual disagreement beyond which a look is not kept."""


@dataclass(frozen=True, slots=True)
class Found:
    """One frame's result."""

    state: State
    missed: Array
    """(N, 2) mm by which the landmarks miss the state."""
    cost: float
    """How badly the looks agree."""
    used: Index
    """Texels that were compared."""
    points: Array
    """(N, 2) pixels, where points of the skin were found again."""
    edges: Array
    """(N, 2, 2) pixels, a place of the outline and the edge that was found across it."""
    notes: tuple[str, ...]
    """Short words for a person: "recovered"."""


class Tracker:
    """Follows one person; frames come in one by one."""

    def __init__(self, person: Person, looks: list[Look], start: State, trust: Trust | None = None):
        self.person, self.trust = person, trust or Trust()
        self.looks = list(looks)
        self.state, self.missed = start, person.offset
        self.rows = _samples(person, looks[0]) if looks else np.zeros(0, dtype=np.intp)
        self.sampled = person.texels.take(self.rows)
        self.tracks = _tracks(person, looks[0]) if looks and self.trust.points else None
        self._folds = folds(person.space.triangles)
        self._costs: list[float] = []
        self._count = 0
        self._lost = False

    def step(self, crop: Crop, points: Array) -> Found:
        """The next frame: its crop and its landmarks (N, 2) in pixels of the frame."""
        blurred = pictures(crop, float(self.state.translation[2]), self.person.focal)
        if self.tracks is not None:
            self.tracks.follow(crop)
        anew = self._lost or not self.trust.predictor
        notes = ("recovered",) if self._lost else ()
        guess = self.absolute(points) if anew else self._predict(points)
        aligned = self._align(crop, blurred, points, guess)
        self._count, self._lost = self._count + 1, False
        doubtful = self._count % EVERY == 0 or aligned.cost > DOUBT * self._usual()
        if self.trust.retry and doubtful:
            again = self._align(crop, blurred, points, self.absolute(points))
            if again.cost < aligned.cost:
                aligned = again
        self._costs = [*self._costs[-29:], aligned.cost]
        self.state = aligned.state
        self.missed = self._miss(points, self.state)
        if self.trust.keyframes:
            self._keep(crop, aligned)
        tracked = self._renew(aligned)
        edges = aligned.edges / crop.scale + crop.origin
        return Found(self.state, self.missed, aligned.cost, aligned.used, tracked, edges, notes)

    def lose(self) -> None:
        """No face was seen: the next one is met without asking where the last one was."""
        self._lost = True
        if self.tracks is not None:
            self.tracks.lose()

    def absolute(self, points: Array) -> State:
        """What the landmarks (N, 2) alone tell, whatever came before."""
        person = self.person
        directions = (points - person.centre) / person.focal
        model = HeadModel(
            person.landmarks.neutral,
            person.landmarks.fields(),
            np.arange(len(points)),
        )
        fit = fit_heads(model, directions[None])
        state = State(fit.rotation[0], fit.translation[0], fit.weights[0])
        return solve(state, self._alone(points, state), 2)

    def _usual(self) -> float:
        return float(np.median(self._costs)) if len(self._costs) > 10 else np.inf

    def _keep(self, crop: Crop, aligned: Aligned) -> None:
        """Remember how the face looks from a side not seen before."""
        if aligned.cost < SURE * self._usual() and len(self._costs) > 10:
            turns = self._turns(aligned.state)
            if min(turns) > KEY_APART:
                self.looks.append(take(self.person, crop, aligned.state))

    def _prior(self) -> PriorTerm:
        return PriorTerm(self.person.space.spread * self.trust.spread)

    def _predict(self, points: Array) -> State:
        terms = landmarks(self.person, points, self.state, self.missed, PREDICTOR_SIGMA, 1.0)
        return solve(self.state, [terms, *self._tracked(), self._prior()], 3)

    def _tracked(self) -> list[Term]:
        """What the points of the skin tell that were found again."""
        if self.tracks is None or not self.tracks.held.any():
            return []
        sigma = POINT_SIGMA * self.person.focal / float(self.state.translation[2])
        return [self.tracks.term(self.person.lens(), sigma, self.trust.points)]

    def _renew(self, aligned: Aligned) -> Array:
        """Where the points that were found again lie; then the next ones are taken up."""
        if self.tracks is None:
            return np.zeros((0, 2))
        tracked = self.tracks.places[self.tracks.held]
        self.tracks.renew(self.person.lens(), self.state, aligned.seen[self.tracks.rows])
        return tracked

    def _alone(self, points: Array, state: State) -> list[Term]:
        """Landmarks that must tell everything."""
        offset = self.person.offset
        return [landmarks(self.person, points, state, offset, 1.0, 1.0), self._prior()]

    def _miss(self, points: Array, state: State) -> Array:
        person = self.person
        pixels = person.focal / state.translation[2]
        shown = person.lens().project(person.landmarks.seen(state))
        return np.asarray((points - shown) / pixels)

    def _align(
        self, crop: Crop, blurred: tuple[Floats, ...], points: Array, guess: State
    ) -> Aligned:
        person, trust = self.person, self.trust
        if not self.looks or trust.texture == 0.0:
            alone = solve(guess, self._alone(points, guess), 3)
            nowhere = np.zeros(len(person.chart), dtype=bool)
            return Aligned(alone, 0.0, np.flatnonzero(nowhere), nowhere, np.zeros((0, 2, 2)))
        look = self._nearest(guess)
        seen = look.seen & visible(person, crop, guess, 0.2)
        normalise = Normaliser(person.chart, seen)
        others = [*anchors(person, points, guess, trust), *self._tracked()]
        if trust.motion:
            others.append(MotionTerm(guess, *MOTION_SIGMA))
        state = guess
        terms = [
            TextureTerm(
                person.chart,
                person.texels,
                self.sampled,
                self.rows,
                blurred[level],
                person.lens(crop),
                normalise,
                normalise(look.levels[level]),
                trust.texture,
            )
            for level in range(len(blurred))
        ]
        across = self._outline(crop, blurred[-1], guess)
        for level in LEVELS:
            state = step(state, [terms[level], *across, *others])
        cost = terms[-1].cost(state)
        edges = across[0].pairs(state) if across else np.zeros((0, 2, 2))
        used = self.rows[normalise.inner[self.rows]]
        return Aligned(state, cost, used, seen, edges)

    def _outline(self, crop: Crop, picture: Floats, state: State) -> list[SilhouetteTerm]:
        weight = self.trust.silhouette
        if not weight:
            return []
        return [match(self.person, self._folds, crop, picture, state, SILHOUETTE_SIGMA, weight)]

    def _turns(self, state: State) -> list[float]:
        return [
            float(np.degrees(angle_between(look.state.rotation, state.rotation)))
            for look in self.looks
        ]

    def _nearest(self, state: State) -> Look:
        """The look at rest, unless another is much nearer: only that one's pose is sure."""
        turns = self._turns(state)
        best = int(np.argmin(turns))
        if turns[0] > KEY_FROM and turns[best] < turns[0] - KEY_NEARER:
            return self.looks[best]
        return self.looks[0]


def landmarks(
    person: Person, points: Array, state: State, missed: Array, sigma: float, weight: float
) -> LandmarkTerm:
    """What landmarks (N, 2) tell about ``state``, less what they ``missed`` (N, 2), mm; ``sigma``
    in mm."""
    pixels = person.focal / float(state.translation[2])
    seen = points - missed * pixels
    sigmas = np.full(len(points), sigma * pixels)
    return LandmarkTerm(person.landmarks, person.lens(), seen, sigmas, weight=weight)


def anchors(person: Person, points: Array, state: State, trust: Trust) -> list[Term]:
    """What landmarks (N, 2) and prior say of a frame about ``state``."""
    anchor = landmarks(person, points, state, person.offset, ANCHOR_SIGMA, trust.anchor)
    return [anchor, PriorTerm(person.space.spread * trust.spread)]


@dataclass(frozen=True, slots=True)
class Aligned:
    """A state, and how badly the looks agree there."""

    state: State
    cost: float
    used: Index
    seen: Bools
    """(M,) texels seen here and in the look that was compared."""
    edges: Array
    """(N, 2, 2) pixels of the crop."""


def _tracks(person: Person, look: Look) -> PointTracks:
    """Points on the corners of a look."""
    mask = look.seen
    rows = corners(person.chart, Normaliser(person.chart, mask)(look.levels[-1]), mask)
    return PointTracks(rows, person.texels.take(rows))


def _samples(person: Person, look: Look) -> Index:
    """Texels that are compared: the strongest edges of a look, and as many on a raster."""
    chart = person.chart
    every = np.flatnonzero(chart.inner & look.seen)
    right, down = chart.slopes(Normaliser(chart, look.seen)(look.levels[1]), every)
    strong = every[np.argsort(-(right**2 + down**2))[: SAMPLES // 2]]
    raster = every[:: max(1, len(every) // (SAMPLES // 2))]
    return np.unique(np.concatenate([strong, raster]))

"""The pose of the resting frame, and the shape of whoever rests in it, from several views at once.

Landmarks place the face at rest a few degrees wrong, and its look then sits on the wrong skin. Any
view from another side shows the mistake: the look at rest, carried there, does not fit. Unknown are
the common pose at rest and identity (C) and each view's own pose and expression (U):

    [ sum A_i   B_1 .. B_n ] [ common ]
    [ B_i'      D_i        ] [ own_i  ]      own_i eliminated (Schur complement)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.crop import Crop
from mien.capture.tracker.look import Look, pictures, take, visible
from mien.capture.tracker.person import Person
from mien.capture.tracker.solve import WEIGHT_MAX, Term
from mien.capture.tracker.state import Sites, State
from mien.capture.tracker.texture_term import Normaliser, TextureTerm
from mien.numeric.gauss_newton import normal_equations

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class View:
    """A frame in which the face is seen from some side."""

    crop: Crop
    state: State
    points: Array
    """(N, 2) its landmarks, pixels of the frame."""


Known = Callable[[Person, State, View, State], Sequence[Term]]
"""What else is known of a view, landmarks and prior: of a person in a state at rest, the view, and
its state now. What landmarks miss at rest depends on where the face lies there."""


@dataclass(frozen=True, slots=True)
class Rest:
    """The frame at rest, and how far to trust what is known of it."""

    crop: Crop
    state: State
    pose_sigma: tuple[Array, float]
    """Radians (3,) and mm."""


def refine(
    person: Person,
    rest: Rest,
    views: Sequence[View],
    rows: NDArray[np.intp],
    identity: Array,
    weight: float,
    rounds: Sequence[int],
    known: Known,
) -> tuple[Person, State, list[State]]:
    """Person, state at rest and state of every view after one Gauss-Newton step for each entry of
    ``rounds``, a level of looks. ``identity`` (B, V, 3) are the modes left free, one standard
    deviation each; ``rows`` the texels compared, ``weight`` of each."""
    state, states = rest.state, [view.state for view in views]
    modes = np.zeros(len(identity))
    bare, fixed = person, state
    for level in rounds:
        common_sites = person.chart.sites(
            person.neutral, np.concatenate([person.space.expression, identity])
        )
        look = take(person, rest.crop, state)
        count = 6 + len(modes)
        normal, right = np.zeros((count, count)), np.zeros(count)
        normal[np.diag_indices(count)] = (
            np.concatenate(
                [
                    rest.pose_sigma[0],
                    np.full(3, rest.pose_sigma[1]),
                    np.ones(len(modes)),
                ]
            )
            ** -2.0
        )
        right -= normal.diagonal() * np.concatenate([_off(state, fixed), modes])
        solved = []
        for view, own in zip(views, states, strict=True):
            others = known(person, state, view, own)
            parts = _blocks(
                person, rest.crop, state, look, view, own, others, common_sites, rows, level, weight
            )
            a, b, d, g, h = parts
            back = np.linalg.solve(d, np.column_stack([b.T, h]))
            normal += a - b @ back[:, :-1]
            right += g - b @ back[:, -1]
            solved.append(back)
        common = np.linalg.solve(normal, right)
        for i, back in enumerate(solved):
            moved = states[i].moved(np.asarray(back[:, -1] - back[:, :-1] @ common, dtype=float))
            states[i] = replace(moved, weights=np.clip(moved.weights, 0.0, WEIGHT_MAX))
        state = state.moved(np.concatenate([common[:6], np.zeros(len(state.weights))]))
        modes = modes + common[6:]
        neutral = bare.neutral + np.tensordot(modes, identity, axes=1)
        person = reshaped(bare, neutral)
    return person, state, states


def reshaped(person: Person, neutral: Array) -> Person:
    """``person`` with another face at rest."""
    chart = person.chart
    return replace(
        person,
        neutral=neutral,
        texels=chart.sites(neutral, person.space.expression),
        landmarks=person.attach(neutral),
    )


def _off(state: State, fixed: State) -> Array:
    from mien.numeric.rotation import to_vector

    return np.concatenate(
        [to_vector(state.rotation @ fixed.rotation.T), state.translation - fixed.translation]
    )


def _blocks(
    person: Person,
    rest: Crop,
    at_rest: State,
    look: Look,
    view: View,
    own: State,
    others: Sequence[Term],
    sites: Sites,
    rows: NDArray[np.intp],
    level: int,
    weight: float,
) -> tuple[Array, Array, Array, Array, Array]:
    """A (C, C), B (C, U), D (U, U) and the right sides g (C,), h (U,) of one view."""
    shapes = len(own.weights)
    normalise = Normaliser(person.chart, look.seen & visible(person, view.crop, own, 0.3))
    nothing = np.zeros(sites.shapes.shape[2] - shapes)
    sampled = sites.take(rows)

    def term(crop: Crop, state: State, wanted: NDArray[np.float32]) -> TextureTerm:
        picture = pictures(crop, float(state.translation[2]), person.focal)[level]
        return TextureTerm(
            person.chart,
            sites,
            sampled,
            rows,
            picture,
            person.lens(crop),
            normalise,
            wanted,
            weight,
        )

    there = replace(own, weights=np.concatenate([own.weights, nothing]))
    here = replace(at_rest, weights=np.concatenate([at_rest.weights, nothing]))
    forward = term(view.crop, there, normalise(look.levels[level]))
    now = forward.linearize(there)
    seen = normalise(forward.look(there))
    back = term(rest, here, seen).linearize(here)
    trust = now.weights()
    mine = now.jacobian[:, : 6 + shapes]
    common = np.concatenate([-back.jacobian[:, :6], np.zeros((len(rows), len(nothing)))], axis=1)
    common[:, 6:] = now.jacobian[:, 6 + shapes :] - back.jacobian[:, 6 + shapes :]
    heavy = mine * trust[:, None]
    d, h = normal_equations([t.linearize(own) for t in others], 6 + shapes)
    d += heavy.T @ mine
    h -= heavy.T @ now.residual
    pressed = ((own.weights <= 0.0) & (h[6:] < 0.0)) | ((own.weights >= WEIGHT_MAX) & (h[6:] > 0.0))
    d[6 + np.flatnonzero(pressed), 6 + np.flatnonzero(pressed)] += 1e9
    heavy_common = common * trust[:, None]
    return (
        heavy_common.T @ common,
        heavy_common.T @ mine,
        d,
        -(heavy_common.T @ now.residual),
        h,
    )

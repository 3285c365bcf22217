"""Motion as FAPs, [C] eq. 3, and FAPs as motion of any character that has feature points.

    S       the performer's motion from neutral, at feature points     Delta S
    C       what each FAP does there, at the performer's size          C_fap (face.fap_basis)
    alpha   values of the FAPs, under what faces can do                alpha, alpha_l, alpha_u

    minimise  sum_qx ((C alpha - S)_qx / sigma_qx)^2 + sum_r ((K alpha)_r / usual_r)^2

The second sum is ours, and counts for nothing where the points are sure: along the line of sight
nothing is measured, and a FAP that shows in nothing that was measured is at rest; the two edges of
a lip go together, and a lower lip that falls far has a jaw that falls with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character
from mien.face.face import Face
from mien.face.fap_basis import FapBasis
from mien.face.fap_targets import basis_of, fap_models, fap_weights, is_fap
from mien.face.library import generic_face
from mien.mapping.joint import head_on_neck
from mien.mapping.settings import Settings
from mien.mapping.sight import Rows, Sight, compare, seen
from mien.numeric.qp import kkt_residual, solve_boxes
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.vocabulary.fap import PER_UNIT, column, simple, with_head_and_gaze
from mien.vocabulary.fapu import measure

Array = NDArray[np.float64]

_USUAL, _USUAL_DEPTH = 0.5, 0.2
"""What a FAP usually does, of what it can do at most: less in depth, where a head that nods a
little would be taken for lips that are sucked in."""
_EDGES, _CORNERS, _JAW, _POUT, _BOSS = 120.0, 50.0, 80.0, 150.0, 100.0
_KIN = (
    *(({52: 1.0, 5: -1.0}, _EDGES), ({57: 1.0, 10: -1.0}, _EDGES), ({58: 1.0, 11: -1.0}, _EDGES)),
    *(({51: 1.0, 4: -1.0}, _EDGES), ({55: 1.0, 8: -1.0}, _EDGES), ({56: 1.0, 9: -1.0}, _EDGES)),
    *(({59: 1.0, 12: -1.0}, _EDGES), ({60: 1.0, 13: -1.0}, _EDGES)),
    *(({53: 1.0, 6: -1.0}, _CORNERS), ({54: 1.0, 7: -1.0}, _CORNERS)),
    *(({5: 1.0, 3: 1.0}, _JAW), ({10: 1.0, 3: 0.9}, _JAW), ({11: 1.0, 3: 0.9}, _JAW)),
    *(({12: 1.0, 3: 0.3}, 2 * _JAW), ({13: 1.0, 3: 0.3}, 2 * _JAW)),
    *(({17: 1.0, 6: 0.6, 7: 0.6}, _POUT), ({16: 1.0, 6: 0.6, 7: 0.6}, _POUT)),
    ({18: 1.0}, _BOSS),
)
"""Sums of FAPs that are usually small, and how small: outer edges of the lips against the inner,
the lower lip and the corners against the jaw, lips that pout where the mouth narrows; the
chin's boss, to which nothing is left that the jaw explains."""
_FEWEST = 8
_NOT_SKIN = frozenset({"3.5", "3.6", "7.1"})
"""Pupils turn with the gaze and the neck with the head."""
_LIDS = {"lid_left": (19, 21), "lid_right": (20, 22)}
_CHUNK = 256


@dataclass(frozen=True, slots=True)
class FapFit:
    """The FAPs of a performance."""

    values: Array
    """(F, 66) FAPs 3 to 68."""
    kkt: Array
    """(F,) certificate: how far from the minimum, in parts of what each FAP can do."""
    residual: Array
    """(F,) mm, root mean square motion that no FAP expressed."""


class FapProgramme:
    """The quadratic programme for one performer. It has no memory: a frame is solved alone as in
    a take, only that each starts from the bounds at which the one before it stood."""

    def __init__(
        self, header: Performance, basis: FapBasis, face: Face, settings: Settings | None = None
    ) -> None:
        """``header`` is any performance of the performer; ``basis`` and ``face`` the FAPs as a
        face of ours does them. Raises InputError where the two have too few points in common."""
        self.settings = settings or Settings()
        common = [p for p in header.points if p in face.points.ids and p not in _NOT_SKIN]
        if len(common) < _FEWEST:
            raise InputError(
                f"only {len(common)} of the performance's points are feature points of MPEG-4; at "
                f"least {_FEWEST} are needed for FAPs"
            )
        self.rows: Rows = compare(header, common)
        neutral = header.neutral[self.rows.points]
        fields = _at_size(common, neutral, basis, face)
        reach = np.array([fap.reach for fap in simple()])
        # A FAP whose own point was not measured would only be moved by others' leavings.
        known = np.array([fap.point in common for fap in simple()])
        self._solved = np.flatnonzero(fields.any(axis=(1, 2)) & known)
        self._reach = reach[self._solved]
        stretch = max(self.settings.gain, 1.0)
        bounds = stretch * np.array([(fap.lower, fap.upper) for fap in simple()])[self._solved]
        lower, upper = bounds.T / self._reach
        self.bounds: tuple[Array, Array] = lower, upper
        ends = np.sort(fields[self._solved][..., 1, None] * bounds[:, None])
        self._farthest = np.moveaxis(ends.sum(axis=0), -1, 0)
        self.fields = self.rows(fields[self._solved]) * self._reach[:, None, None]
        self._sight = Sight(self.fields, self.rows.precision)
        self._prior = _prior()[np.ix_(self._solved, self._solved)]
        self._prior *= self._reach[:, None] * self._reach

    def problem(self, performance: Performance, part: slice) -> tuple[Array, Array]:
        """Hessians (U, N, N), U = 1 where all frames share one, and linear parts (F, N), in parts
        of what each FAP can do."""
        sight = seen(performance.unseen[part])
        alike = bool((sight == sight[:1]).all())
        gram = self._sight.gram(sight[:1] if alike else sight)
        motion = self._motion(performance, part)
        # What is beyond all FAPs would be made up for by others: an upper lip would go up where
        # the lower can go no farther down.
        motion[..., 1] = np.clip(motion[..., 1], *self._farthest)
        return gram + self._prior, -self._sight.onto(self.rows(motion), sight)

    def __call__(self, performance: Performance) -> FapFit:
        """The FAPs of every frame, lids as the performer's closures tell where they do, head and
        gaze as measured."""
        frames = len(performance)
        values = np.zeros((frames, len(simple())))
        kkt, residual = np.zeros(frames), np.zeros(frames)
        for first in range(0, frames, _CHUNK):
            part = slice(first, min(first + _CHUNK, frames))
            hessians, linear = self.problem(performance, part)
            found = solve_boxes(hessians, linear, *self.bounds)
            kkt[part] = kkt_residual(hessians, linear, found, *self.bounds)
            residual[part] = self._residual(performance, part, found)
            values[part, self._solved] = found * self._reach
        if not performance.vocabulary:
            _close_lids(values, performance)
        return FapFit(
            with_head_and_gaze(values, performance.head()[0], performance.gaze), kkt, residual
        )

    def _motion(self, performance: Performance, part: slice) -> Array:
        return performance.motion[part][:, self.rows.points] * self.settings.gain

    def _residual(self, performance: Performance, part: slice, found: Array) -> Array:
        shown = np.tensordot(found, self.fields, axes=1)
        left = self._motion(performance, part) - shown[:, : len(self.rows.points)]
        along = (left * performance.unseen[part][:, None]).sum(axis=-1)
        return np.asarray(np.sqrt(((left**2).sum(axis=-1) - along**2).clip(0.0).mean(axis=1)))


class FapMapper:
    """One character driven through FAPs: its curves are the weights of ``fap_models``."""

    def __init__(
        self, character: Character, header: Performance, settings: Settings | None = None
    ) -> None:
        """Raises InputError where the character lacks feature points or the performance has too
        few of them."""
        self.settings = settings or Settings()
        self.character = character
        self._names = fap_models(character).names
        generic = generic_face()
        self._programme = (
            None
            if header.vocabulary == "fap"
            else FapProgramme(header, basis_of(generic), generic.face, self.settings)
        )

    def __call__(self, performance: Performance) -> Curves:
        """Curves of the character for every frame of ``performance``; FAPs that came as such pass
        as they are."""
        if self._programme is None:
            values, residual = performance.shapes * self.settings.gain, np.zeros(len(performance))
        else:
            fit = self._programme(performance)
            values, residual = fit.values, fit.residual
        rotation, translation = head_on_neck(performance, self.character.face)
        return Curves(
            character=self.character.name,
            names=self._names,
            time=performance.time,
            weights=fap_weights(self.character, values),
            rotation=rotation,
            translation=translation,
            gaze=performance.gaze,
            lost=performance.lost,
            residual=residual,
        )


def parted(curves: Curves, character: Character) -> Curves:
    """``curves`` of FAPs with lips and lids that were smoothed into each other parted again; other
    curves as they are."""
    own = character.keys.names
    if not any(is_fap(name) and name not in own for name in curves.names):
        return curves
    columns = [curves.names.index(name) for name in fap_models(character).names]
    values = np.zeros((len(curves), len(simple())))
    for fap in simple():
        if fap.name in curves.names:
            values[:, column(fap.number)] = (
                fap.reach * curves.weights[:, curves.names.index(fap.name)]
            )
    weights = curves.weights.copy()
    weights[:, columns] = fap_weights(character, values)
    return replace(curves, weights=weights)


def fap_values(performance: Performance) -> Array:
    """(F, 66) FAPs of a performance; as they came where it speaks FAP. Raises InputError."""
    if performance.vocabulary == "fap":
        return performance.shapes
    generic = generic_face()
    return FapProgramme(performance, basis_of(generic), generic.face)(performance).values


def _prior() -> Array:
    """(66, 66) quadratic form of what FAPs usually do, per value squared."""
    reach = np.array([fap.reach for fap in simple()])
    part = np.array([_USUAL_DEPTH if fap.axis == 2 else _USUAL for fap in simple()])
    prior = np.diag((part * reach) ** -2.0)
    for together, usual in _KIN:
        row = np.zeros(len(reach))
        for number, factor in together.items():
            row[column(number)] = factor / usual
        prior += np.outer(row, row)
    return prior


def _at_size(points: Sequence[str], neutral: Array, basis: FapBasis, face: Face) -> Array:
    """(66, P, 3) mm of a value of 1 at ``points`` (P) of a performer with that ``neutral``
    (P, 3)."""
    rows = face.points.index(points)
    own = face.points.at(face.vertices)[rows]
    performer = measure(points, neutral)
    ratio = np.array([fap.size(performer) for fap in simple()]) / basis.size
    # Where the performer lacks the points for a length, the overall size stands in.
    ratio = np.where(np.isfinite(ratio), ratio, _spread(neutral) / _spread(own))
    return np.asarray(ratio[:, None, None] * face.points.at(basis.fields)[:, rows])


def _spread(places: Array) -> float:
    return float(np.sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean()))


def _close_lids(values: Array, performance: Performance) -> None:
    """Whoever looks knows closures better than the margins' points: the upper lid does the rest.
    Eyes are opened wide together: one that is by itself is not believed."""
    known = [performance.scalars[name] for name in _LIDS if name in performance.scalars]
    stare = np.minimum(np.max(known, axis=0, initial=-np.inf), 0.0)
    for name, (upper, lower) in _LIDS.items():
        if name in performance.scalars:
            shut = np.maximum(performance.scalars[name], stare)
            values[:, column(upper)] = PER_UNIT * shut - values[:, column(lower)]

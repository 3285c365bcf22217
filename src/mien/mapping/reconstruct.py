"""A performance becomes a dense surface: a databank's faces blended, the rest carried along [Z] §4.

The motion of the performer's feature points is turned into the axes of the face it lands on,
brought to the size of the databank (``databank_scale``), smoothed, blended (``blend``) and, with
what the blend leaves over (``residual``), brought back to the performer's size.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.databank import Databank
from mien.face.face import Face
from mien.mapping.blend import Solver, blend, learn_misfit
from mien.mapping.bounded import bounded
from mien.mapping.genetic import genetic, published
from mien.mapping.residual import believe, spread
from mien.numeric.noise import noise_of
from mien.numeric.procrustes import align
from mien.numeric.steady import steady
from mien.performance.performance import Performance

Array = NDArray[np.float64]

SOLVERS: Mapping[str, Solver] = MappingProxyType(
    {"bounded": bounded, "genetic": genetic, "published": published}
)
"""The first is the default."""
_FEWEST = 8
_LEAST_NOISE = 1e-4
"""mm, cleaned captures have none to speak of."""
_PAIRS = (("8.3", "8.4"), ("4.5", "4.6"), ("9.3", "2.1"), ("5.3", "5.4"))
"""Mouth corners, outer brows, nose tip and chin, cheek bones: a set of markers has no eyes."""
_HARD = ("teeth", "gum", "tongue", "eye")


@dataclass(frozen=True, slots=True)
class Reconstruction:
    """What F frames of a performance do to a face of the databank's topology.

    The surface moves by sum_k weights_k displacement_k / scale + spread @ rest.
    """

    face: Face
    """The face it lands on: the databank's, or the performer's own."""
    bank: Databank
    weights: Array
    """(F, K) of the databank's faces."""
    scale: float
    """The databank's size over the performer's."""
    spread: NDArray[np.float32]
    """(V, P) how far each vertex follows each marker's share of the rest."""
    rest: Array
    """(F, P, 3) mm."""
    missed: Array
    """(F,) mm, root mean square motion of the markers that is not shown."""

    def motion(self, frame: int) -> Array:
        """(V, 3) mm, displacement from the neutral of ``face``, in its axes."""
        blended = np.tensordot(self.weights[frame], self.bank.displacements, axes=1)
        return np.asarray(blended / self.scale + self.spread @ self.rest[frame])


def reconstruct(
    performance: Performance,
    bank: Databank,
    *,
    face: Face | None = None,
    solver: str | Solver = "bounded",
    smooth: bool = True,
    residual: bool = True,
) -> Reconstruction:
    """The surface a performance shows, from the faces of ``bank``.

    ``face`` is the performer's own neutral in the databank's topology; ``solver`` one of SOLVERS
    by name, or another; ``smooth`` takes the markers' noise out in time; ``residual`` False leaves
    the blend alone. Raises InputError for an unknown solver, a face of another topology, too few
    common points, or motion that was seen without depth.
    """
    solve = _solver(solver)
    face = bank.face if face is None else face
    points = _compared(performance, bank, face)
    rows = [performance.points.index(point) for point in points]
    on_bank, on_face = bank.face.points.index(points), face.points.index(points)
    worn, places = performance.neutral[rows], face.points.at(face.vertices)[on_face]
    scale = databank_scale(points, worn, bank.face)
    motion = performance.motion[:, rows] @ align(worn, places).rotation.T
    noise = np.full(len(points), max(noise_of(motion), _LEAST_NOISE))
    if smooth:
        motion, left = steady(motion, _rate(performance))
        noise = noise * left
    fields = bank.face.points.at(bank.displacements)[:, on_bank]
    misfit = learn_misfit(fields, scale * motion, scale * noise, bounded)
    variance = scale**2 * noise**2 + misfit
    weights = solve(blend(fields, scale * motion, variance, _rate(performance)))
    left_over = motion - np.tensordot(weights, fields, axes=1) / scale
    rest = believe(left_over, places, noise) if residual else np.zeros_like(motion)
    missed = left_over - spread(places, places) @ rest
    felt = spread(face.vertices, places)
    felt[_hard(face)] = 0.0
    rms = np.sqrt((missed**2).sum(axis=-1).mean(axis=-1))
    return Reconstruction(face, bank, weights, scale, felt, rest, rms)


def _solver(named: str | Solver) -> Solver:
    if not isinstance(named, str):
        return named
    if named not in SOLVERS:
        raise InputError(f"--mapping {named}: with a databank there are {', '.join(SOLVERS)}")
    return SOLVERS[named]


def _compared(performance: Performance, bank: Databank, face: Face) -> list[str]:
    """The feature points all three have."""
    source = performance.source or "the take"
    if performance.unseen.any():
        raise InputError(
            f"{source}: one camera saw no depth and --databank needs it; let the databank act as a "
            "character (-c BANK.npz)"
        )
    if face.vertices.shape != bank.face.vertices.shape:
        raise InputError(
            f"a face of {len(face.vertices)} vertices and a databank of "
            f"{len(bank.face.vertices)}; build both from the same generic mesh"
        )
    points = [p for p in performance.points if p in face.points.ids and p in bank.face.points.ids]
    if len(points) < _FEWEST:
        raise InputError(
            f"{source}: {len(points)} of its feature points are on {bank.name}; at least "
            f"{_FEWEST} are needed"
        )
    return points


def databank_scale(points: list[str], worn: Array, face: Face) -> float:
    """[Z] §4.1: the mean of four ratios of distances between feature points, the databank's over
    the performer's ``worn`` (P, 3); of those whose points are known. Raises InputError for none."""
    theirs = face.points.at(face.vertices)[face.points.index(points)]
    ratios = []
    for first, second in _PAIRS:
        if first in points and second in points:
            i, j = points.index(first), points.index(second)
            ratios.append(
                float(np.linalg.norm(theirs[i] - theirs[j]) / np.linalg.norm(worn[i] - worn[j]))
            )
    if not ratios:
        pairs = ", ".join(f"{first} and {second}" for first, second in _PAIRS)
        raise InputError(f"no scale can be told: none of {pairs} is among the markers")
    return float(np.mean(ratios))


def _rate(performance: Performance) -> float:
    frames = len(performance)
    return (frames - 1) / float(performance.time[-1] - performance.time[0]) if frames > 1 else 0.0


def _hard(face: Face) -> NDArray[np.bool_]:
    """(V,) what is no skin and must not bend."""
    hard = np.zeros(len(face.vertices), dtype=bool)
    for part in face.parts:
        hard[part.first : part.last] = part.name.startswith(_HARD)
    return hard

"""Radial basis functions with an affine part: the smoothest field through scattered values.

    f(x) = sum_i c_i phi(|x - x_i|) + A x + b,   sum_i c_i = 0,   sum_i c_i x_i = 0

phi(r) = r is the biharmonic and phi(r) = r³ the triharmonic spline of three-dimensional space
(Carr et al., Reconstruction and Representation of 3D Objects with Radial Basis Functions, 2001).
The side conditions leave whatever is affine to the affine part, so that affine fields are met
exactly and nothing grows without bound far away.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import lstsq
from scipy.spatial.distance import cdist

Array = NDArray[np.float64]
Kernel = Literal["biharmonic", "triharmonic"]

# Signed so that both are positive definite on what the side conditions leave: smoothing adds.
_PROFILES: dict[Kernel, Callable[[Array], Array]] = {
    "biharmonic": lambda r: -r,
    "triharmonic": lambda r: r**3,
}
_ROWS = 1 << 22
"""Distances held at a time when a field is evaluated."""


@dataclass(frozen=True, slots=True)
class Field:
    """A fitted field."""

    centres: Array
    """(N, 3) in lengths of ``scale`` about ``origin``."""
    coefficients: Array
    """(N + 4, D): of the centres, then b and the columns of A."""
    kernel: Kernel
    origin: Array
    scale: float

    def __call__(self, points: Array) -> Array:
        """Values (M, D) at ``points`` (M, 3)."""
        places = (np.asarray(points, dtype=float) - self.origin) / self.scale
        step = max(1, _ROWS // len(self.centres))
        values = np.empty((len(places), self.coefficients.shape[1]))
        for i in range(0, len(places), step):
            basis = _basis(places[i : i + step], self.centres, self.kernel)
            values[i : i + step] = basis @ self.coefficients
        return values


def fit(
    centres: ArrayLike,
    values: ArrayLike,
    kernel: Kernel = "biharmonic",
    smoothing: ArrayLike = 0.0,
) -> Field:
    """The field with ``values`` (N, D) at ``centres`` (N, 3).

    ``smoothing`` (N,) or one number: 0 meets the values exactly; the larger it is the more a
    value may be missed for a smoother field. It has no unit, for centres are measured in their
    own spread. Where the centres lie in a plane, the least affine part is taken. Raises ValueError
    for shapes that do not go together, no centres, or numbers that are not finite.
    """
    centres = np.asarray(centres, dtype=float)
    values = np.asarray(values, dtype=float)
    if centres.ndim != 2 or centres.shape[1] != 3 or not len(centres):
        raise ValueError(f"centres of shape {centres.shape} are not (N, 3)")
    if values.ndim != 2 or len(values) != len(centres):
        raise ValueError(f"values of shape {values.shape} for {len(centres)} centres")
    if not (np.isfinite(centres).all() and np.isfinite(values).all()):
        raise ValueError("a centre or a value is not a number")
    origin = centres.mean(axis=0)
    scale = float(np.sqrt(((centres - origin) ** 2).sum(axis=1).mean())) or 1.0
    places = (centres - origin) / scale
    count = len(places)
    system = np.zeros((count + 4, count + 4))
    system[:count] = _basis(places, places, kernel)
    system[count:, :count] = system[:count, count:].T
    system[range(count), range(count)] += np.asarray(smoothing, dtype=float)
    right = np.concatenate([values, np.zeros((4, values.shape[1]))])
    # Least squares: centres in a plane, or two at one place, make the system singular.
    coefficients = lstsq(system, right, lapack_driver="gelsy")[0]
    return Field(places, coefficients, kernel, origin, scale)


def influence(
    centres: ArrayLike,
    points: Array,
    kernel: Kernel = "biharmonic",
    smoothing: ArrayLike = 0.0,
) -> Array:
    """(M, N) matrix that takes values at ``centres`` (N, 3) to values at ``points`` (M, 3): the
    same fit for many sets of values. Raises ValueError as ``fit``."""
    return fit(centres, np.eye(len(np.asarray(centres))), kernel, smoothing)(points)


def _basis(points: Array, centres: Array, kernel: Kernel) -> Array:
    """(M, N + 4): the kernel at every centre, 1, and the coordinates."""
    profile = _PROFILES[kernel](cdist(points, centres))
    return np.hstack([profile, np.ones((len(points), 1)), points])

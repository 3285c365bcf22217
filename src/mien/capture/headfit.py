"""Head pose and expression fitted together to the picture of a face's points.

Fitting the pose first and calling the rest expression makes an opening mouth tip the head and a
turning head smile. Here Gauss-Newton finds both at once on the performer's own neutral plus the
sculpted shapes of the generic face, from x and y alone: what a network says of depth is not used.

    symbol                     name
    Y = R (X + sum w_k D_k) + t    place of a point in the camera frame (OpenCV axes), mm
    m                          the point in the picture as a ray (x/z, y/z)
    r = m Y_z - Y_xy           residual in mm at the point's depth; linear in Y

No frame looks at another: F frames at once or one at a time give the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mien.capture.descent import descend, first_pose

Array = NDArray[np.float64]

FRONTAL = np.diag([1.0, -1.0, -1.0])
"""camera_from_head of a face that looks straight into the camera."""


@dataclass(frozen=True, slots=True)
class FitSettings:
    """How much each thing is trusted."""

    residual_sigma: float = 1.0
    """mm, spread of a landmark about the model."""
    knee: float = 2.5
    """Cauchy knee in residual sigmas."""
    weight_sigma: float = 0.3
    """Prior spread of a shape's weight about zero."""
    weight_max: float = 1.2
    rounds: int = 3


@dataclass(frozen=True, slots=True)
class HeadModel:
    """What is fitted: N points of a neutral face and K shapes that move them."""

    neutral: Array
    """(N, 3) mm, head frame."""
    shapes: Array
    """(K, N, 3) mm."""
    rigid: NDArray[np.intp]
    """Rows that expressions leave alone; they give the first pose."""
    by_point: Array = field(init=False, repr=False)
    """(N, 3, K) the shapes once more, as one pass over the points needs them."""

    def __post_init__(self) -> None:
        by_point = np.ascontiguousarray(self.shapes.transpose(1, 2, 0))
        object.__setattr__(self, "by_point", by_point)


@dataclass(frozen=True, slots=True)
class HeadFit:
    """Pose and weights of F frames."""

    rotation: Array
    """(F, 3, 3) camera_from_head."""
    translation: Array
    """(F, 3) mm, camera frame."""
    weights: Array
    """(F, K)"""


_RIGID_ROUNDS = 3
_CHUNK = 64
"""Frames fitted at a time, which bounds the memory their normal equations take."""


def fit_heads(model: HeadModel, rays: Array, settings: FitSettings | None = None) -> HeadFit:
    """Fit ``model`` to ``rays`` (F, N, 2) of its points; each frame on its own."""
    settings = settings or FitSettings()
    parts = [
        _fit(model, rays[first : first + _CHUNK], settings)
        for first in range(0, max(len(rays), 1), _CHUNK)
    ]
    return HeadFit(*(np.concatenate(values) for values in zip(*parts, strict=True)))


def _fit(model: HeadModel, rays: Array, settings: FitSettings) -> tuple[Array, Array, Array]:
    """The pose of the rigid points first, then pose and weights together."""
    trust = settings.residual_sigma, settings.knee
    prior = settings.weight_sigma**-2.0, settings.weight_max
    neutral, rays = np.ascontiguousarray(model.neutral), np.ascontiguousarray(rays)
    rigid, seen = neutral[model.rigid], np.ascontiguousarray(rays[:, model.rigid])
    rotation, translation = pose = first_pose(rigid, seen)
    stiff, none = np.zeros((len(rigid), 3, 0)), np.zeros((len(rays), 0))
    weights = np.zeros((len(rays), len(model.shapes)))
    try:
        descend(rigid, stiff, seen, *pose, none, trust, prior, _RIGID_ROUNDS)
        descend(neutral, model.by_point, rays, *pose, weights, trust, prior, settings.rounds)
    except np.linalg.LinAlgError as error:
        raise ArithmeticError("a frame's points tell no pose") from error
    return rotation, translation, weights


def motion_from_neutral(neutral: Array, rays: Array, fit: HeadFit) -> Array:
    """Displacement (F, N, 3) of every point from the posed neutral, in the head frame, mm.

    Only what the picture shows: nothing along the camera's axis.
    """
    posed = neutral @ np.swapaxes(fit.rotation, 1, 2) + fit.translation[:, None]
    seen = rays * posed[..., 2:] - posed[..., :2]
    return np.asarray(seen @ fit.rotation[:, :2])


def residuals(model: HeadModel, rays: Array, fit: HeadFit) -> Array:
    """(F, N, 2) mm by which a fit misses its picture."""
    shape = model.neutral + np.tensordot(fit.weights, model.shapes, axes=1)
    place = shape @ np.swapaxes(fit.rotation, 1, 2) + fit.translation[:, None]
    return np.asarray(rays * place[..., 2:] - place[..., :2])

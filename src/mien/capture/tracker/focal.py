"""The focal length of a camera nobody measured, from how landmarks move as the head turns.

A near face shrinks faster towards its far side than a far one, so that with a wrong focal length no
one face explains all views. The neutral is fitted anew for each guess (capture/neutral.py); what it
leaves unexplained, together with what cameras usually are, is least at the likeliest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from mien.capture.headfit import fit_heads, residuals
from mien.capture.landmarks import USUAL_FOCAL
from mien.capture.neutral import Ground, head_model, own_neutral, refine
from mien.capture.track import LandmarkTrack

Array = NDArray[np.float64]

SECONDS = 10.0
"""Of a take that are looked at."""
_FRAMES = 60
_ROUNDS = 2
_LEAST, _MOST = 0.5, 3.0
"""Picture widths."""
_USUAL_SPREAD = 0.35
"""Standard deviation of the logarithm of focal lengths that people's cameras have."""
_OBSERVATIONS = 120.0
"""Landmarks of all frames that count as independent; neighbours share the network's errors."""
_SIGMA, _KNEE = 1.0, 2.5
"""mm of a landmark, and its Cauchy knee in sigmas."""
_EXACT = 0.03
"""Of the logarithm: three per cent of the focal length."""


def estimate(track: LandmarkTrack, rest: slice, ground: Ground) -> float:
    """Likeliest focal length in pixels. ``rest`` are the neutral ones among the frames that show a
    face. A head that never turns tells nothing: a usual camera comes out."""
    seen = np.flatnonzero(~track.lost)
    first = seen[track.time[seen] <= track.time[seen[0]] + SECONDS]
    chosen = first[np.unique(np.linspace(0, len(first) - 1, _FRAMES).astype(int))]
    neutral = own_neutral(track.points[seen][rest], ground)
    centre = np.array(track.size, dtype=float) / 2.0
    pixels = track.points[chosen, :, :2].astype(float) - centre
    usual = USUAL_FOCAL * track.size[0]

    def unlikely(logarithm: float) -> float:
        rays = pixels / (usual * np.exp(logarithm))
        prior = 0.5 * (logarithm / _USUAL_SPREAD) ** 2
        return prior + _OBSERVATIONS * _unexplained(neutral, rays, ground)

    bounds = np.log(np.array([_LEAST, _MOST]) / USUAL_FOCAL)
    found = minimize_scalar(unlikely, bounds=bounds, method="bounded", options={"xatol": _EXACT})
    return float(usual * np.exp(found.x))


def _unexplained(neutral: Array, rays: Array, ground: Ground) -> float:
    """Mean Cauchy cost of a landmark that the best neutral leaves."""
    model = head_model(refine(neutral, rays, ground, _ROUNDS), ground)
    seen = rays[:, : len(model.neutral)]
    missed = residuals(model, seen, fit_heads(model, seen))
    far = (missed**2).sum(axis=-1) / (_SIGMA * _KNEE) ** 2
    return float(0.5 * _KNEE**2 * np.log1p(far).mean())

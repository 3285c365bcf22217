"""A reconstructed surface as a character that acts it: what was reconstructed is what plays.

The databank's faces become morph targets, brought to the performer's size; what the blend left
over and the markers told becomes the principal components of its field over the skin, as many as
it takes to miss nothing that can be seen. Curves then carry a performance of any length.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character, KeyModels
from mien.mapping.joint import head_on_neck
from mien.mapping.reconstruct import Reconstruction
from mien.performance.curves import Curves
from mien.performance.performance import Performance

Array = NDArray[np.float64]

_MISSED = 0.03
"""mm, root mean square over skin and frames, that the components may leave out."""
_TOLD = 2.5
"""mm, standard error of a point that wore no marker."""


def act_surface(
    surface: Reconstruction, performance: Performance, name: str
) -> tuple[Character, Curves]:
    """A character called ``name`` and the curves with which it acts the ``surface`` that was
    reconstructed from ``performance``. Morph targets are the databank's faces, then "rest_01" and
    so on."""
    levels, shares = components(surface)
    rest = np.einsum("vp,cpx->cvx", surface.spread, shares.astype(np.float32))
    faces = surface.bank.displacements / np.float32(surface.scale)
    names = surface.bank.names + tuple(f"rest_{i:02d}" for i in range(1, len(rest) + 1))
    character = Character(
        name, surface.face, KeyModels(names, np.concatenate([faces, rest])), names, whole=True
    )
    rotation, translation = head_on_neck(performance, surface.face)
    return character, Curves(
        character=name,
        names=names,
        time=performance.time,
        weights=np.concatenate([surface.weights, levels], axis=1),
        rotation=rotation,
        translation=translation,
        gaze=performance.gaze,
        lost=performance.lost,
        residual=surface.missed,
    )


def components(surface: Reconstruction) -> tuple[Array, Array]:
    """Levels (F, C), none above 1, and shares of the markers (C, P, 3) mm of the principal
    components of the rest, as it is felt over the skin."""
    felt = surface.spread.astype(float)
    metric = felt.T @ felt / max(float(felt.any(axis=1).sum()), 1.0)
    values, axes = np.linalg.eigh(metric)
    root = axes * np.sqrt(np.clip(values, 0.0, None)) @ axes.T
    field = np.einsum("fpx,pq->fqx", surface.rest, root).reshape(len(surface.rest), -1)
    left, strengths, _ = np.linalg.svd(field, full_matrices=False)
    missed = np.sqrt(np.cumsum((strengths**2)[::-1])[::-1] / len(field))
    levels = left[:, missed > _MISSED]
    levels = levels / np.maximum(np.abs(levels).max(axis=0, initial=0.0), 1e-12)
    own = np.einsum("fc,fpx->cpx", levels, surface.rest)
    return levels, own / np.maximum((levels**2).sum(axis=0), 1e-12)[:, None, None]


def told_points(surface: Reconstruction, performance: Performance) -> Performance:
    """``performance`` with the motion of all feature points of the surface: a set of markers wears
    none on inner lips and lids, and the databank knows how they go along."""
    face, points = surface.face, surface.face.points
    still = points.at(face.vertices)
    faces = points.at(surface.bank.displacements) / surface.scale
    felt = points.at(np.repeat(surface.spread.T[..., None], 3, axis=-1))[..., 0]
    motion = np.tensordot(surface.weights, faces, axes=1)
    motion += np.einsum("pq,fpx->fqx", felt, surface.rest)
    sigma = np.full((len(points.ids), 3), _TOLD)
    for row, point in enumerate(points.ids):
        if point in performance.points:
            sigma[row] = performance.sigma[performance.points.index(point)]
    return replace(
        performance, points=points.ids, neutral=still, motion=motion, sigma=sigma, spans=()
    )

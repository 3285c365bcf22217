"""What faces look like and how they move: a neutral mesh, identities and expressions.

    symbol                                name
    S_id = neutral + sum b_i I_i          a person at rest, b ~ N(0, 1)
    S    = S_id + sum w_k D_k             that person's expression, w_k ~ N(0, spread_k²)

[C] §2.1 calls this the prior p(X), §2.2 S_exp = S_id + dS. The generic face's own space ships with
mien; ``face.databank.shape_space`` makes one of a person whose faces were scanned.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.library import generic_face
from mien.vocabulary.landmarks import FACE_LANDMARKS
from mien.vocabulary.topology import SILHOUETTE, TRIANGLES

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

IDENTITY_FILE = Path(__file__).parent / "data" / "identity.npz"
PUPIL_DISTANCE = 63.0
"""mm between the pupils of everybody in the generic face's space: one camera has no scale."""
_SPREAD = 0.18
"""Prior spread of an expression's weight where nothing else is known."""


@dataclass(frozen=True, slots=True)
class ShapeSpace:
    """V vertices, I identities, K expressions; head frame, mm."""

    neutral: Array
    """(V, 3) the mean person at rest."""
    triangles: Ints
    """(T, 3) of the skin, counter-clockwise seen from outside: no eyes, no mouth bag, no hair."""
    narrow: NDArray[np.bool_]
    """(T,) the narrow face, whose look can be followed: what lies near ears and hair cannot."""
    identity: Array
    """(I, V, 3) one standard deviation each, uncorrelated."""
    expression: Array
    """(K, V, 3) displacements at weight 1."""
    names: tuple[str, ...]
    """(K)"""
    spread: Array
    """(K,) standard deviation of each weight about zero."""

    def person(self, coefficients: Array) -> Array:
        """(V, 3) the person at rest with identity ``coefficients`` (I,)."""
        return np.asarray(self.neutral + np.tensordot(coefficients, self.identity, axes=1))

    def identify(self, vertices: NDArray[np.intp], places: Array, sigma: Array) -> Array:
        """(I,) the likeliest identity that puts ``vertices`` (N,) at ``places`` (N, 3), whose
        standard errors are ``sigma`` (3,) or (N, 3) mm."""
        weight = np.broadcast_to(1.0 / np.asarray(sigma, dtype=float), places.shape).ravel()
        modes = self.identity[:, vertices].reshape(len(self.identity), -1) * weight
        missing = (places - self.neutral[vertices]).ravel() * weight
        normal = modes @ modes.T + np.eye(len(modes))
        return np.asarray(np.linalg.solve(normal, modes @ missing))


def principal_modes(shapes: Array, count: int) -> tuple[Array, Array]:
    """Mean (V, 3) and the ``count`` leading modes (count, V, 3), one standard deviation each, of
    ``shapes`` (N, V, 3). Raises ValueError where fewer than two shapes are given."""
    if len(shapes) < 2:
        raise ValueError("modes need two shapes at least")
    mean = shapes.mean(axis=0)
    flat = (shapes - mean).reshape(len(shapes), -1)
    _, size, modes = np.linalg.svd(flat, full_matrices=False)
    count = min(count, len(shapes) - 1)
    scaled = modes[:count] * size[:count, None] / np.sqrt(len(shapes) - 1)
    return mean, scaled.reshape(count, *mean.shape)


@cache
def generic_space() -> ShapeSpace:
    """The generic face's space; its vertices are the detector's 468 landmarks. Shared: do not
    write into its arrays."""
    generic = generic_face()
    with np.load(IDENTITY_FILE, allow_pickle=False) as stored:
        identity = stored["steps"].astype(float) * stored["scale"][:, None, None]
    rows = [generic.keys.names.index(name) for name in generic.examples]
    eyes = generic.face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    return ShapeSpace(
        neutral=generic.face.vertices[:FACE_LANDMARKS] * scale,
        triangles=TRIANGLES.astype(np.int32),
        narrow=np.asarray(~np.isin(TRIANGLES, SILHOUETTE).any(axis=1)),
        identity=identity,
        expression=generic.keys.displacements[rows][:, :FACE_LANDMARKS].astype(float) * scale,
        names=generic.examples,
        spread=np.full(len(rows), _SPREAD),
    )

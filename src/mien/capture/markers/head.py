"""Taking the head's own motion out of markers.

A frame's pose is the rigid motion that lays the markers at rest on those seen, each trusted as
far as it keeps its place: jig markers decide, the skin helps where a jig marker is hidden, and
without a jig the calm skin (forehead, nose bridge) decides. Heads are heavy: the pose is smoothed
over as long a window as the take's own head motion allows (``numeric.steady``).

[Z] §3 takes rotation from three jig markers and translation from the nose tip, frame by frame;
it is kept for comparison (``by_nose_tip``). The nose tip is not at rest in the head, and three
noisy points shake the face.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.numeric.rotation import from_vector, to_vector
from mien.numeric.steady import steady

Array = NDArray[np.float64]

_LEVER = 80.0
"""mm, from the middle of a face to its rim: how far a radian moves it."""
_SKIN = 0.05
"""What skin counts for beside a jig, of what its own calm would give it."""
_ROUNDS = 8
_OUTLIER = 3.0
"""Standard errors at which a marker begins to count less: swapped ones must not turn the head."""
_LEAST = 0.05
"""mm, no marker is trusted beyond."""


@dataclass(frozen=True, slots=True)
class HeadMotion:
    """Rigid motion of the head through F frames."""

    rotation: Array
    """(F, 3, 3) room_from_rest: from where the head is at rest to where it is."""
    translation: Array
    """(F, 3) mm."""

    def undo(self, places: Array) -> Array:
        """Places (F, M, 3) in the room as they would be with the head at rest."""
        return np.asarray((places - self.translation[:, None]) @ self.rotation)


def find_head_motion(
    places: Array, jig: NDArray[np.bool_], rate: float
) -> tuple[HeadMotion, Array]:
    """The head's motion in ``places`` (F, M, 3), NaN where unseen, and the markers' median places
    with it undone (M, 3); ``jig`` (M,) tells which are fixed to the skull.

    Rest is the median pose. At least three markers must be seen in a frame; others repeat the
    pose before.
    """
    seen = np.asarray(np.isfinite(places).all(axis=-1))
    fullest = int(np.argmax(seen.sum(axis=1)))
    shape = np.where(seen[fullest][:, None], places[fullest], np.nan)
    trust = np.ones(places.shape[1])
    for _ in range(_ROUNDS):
        motion = _fit(places, shape, trust)
        still = motion.undo(places)
        shape = np.nanmedian(still, axis=0)
        apart = np.linalg.norm(still - shape, axis=-1)
        # 1.54: from the median of a distance in space to one coordinate's standard error.
        spread = np.nanmedian(apart, axis=0) / 1.54 + _LEAST
        trust = _trust(spread, jig)
        doubt = np.maximum(apart / (_OUTLIER * 1.7 * spread), 1.0)
        trust = trust / np.nan_to_num(doubt, nan=np.inf)
    motion = _steady(_fit(places, shape, trust), np.nanmean(shape, axis=0), rate)
    return motion, shape


def by_nose_tip(places: Array, jig: NDArray[np.bool_], nose: int) -> HeadMotion:
    """[Z] §3: rotation from the jig alone, translation from marker ``nose``, against the first
    frame that shows them. Frames in which one is hidden repeat the one before. Raises ValueError
    where no frame shows them all."""
    needed = jig.copy()
    needed[nose] = True
    known = np.asarray(np.isfinite(places[:, needed]).all(axis=(1, 2)))
    if not known.any():
        raise ValueError("no frame shows the jig and the nose tip")
    first = places[int(np.argmax(known))]
    turn = _fit(places, first, jig.astype(float)).rotation
    shift = places[:, nose] - turn @ first[nose]
    last = _last(known)
    return HeadMotion(turn[last], shift[last])


def _trust(spread: Array, jig: NDArray[np.bool_]) -> Array:
    """(M,) weight of each marker. The skin's motion is no noise: calm markers count by the fourth
    power, lest the many that move outvote them."""
    if jig.sum() < 3:
        return np.asarray(spread.min() ** 2 * spread**-4.0)
    return np.where(jig, 1.0, _SKIN) * spread**-2.0


def _fit(places: Array, shape: Array, trust: Array) -> HeadMotion:
    """Weighted rigid motions from ``shape`` (M, 3) to every frame; ``trust`` (M,) or (F, M)."""
    known = np.isfinite(places).all(axis=-1) & np.isfinite(shape).all(axis=-1)
    weight = np.where(known, trust, 0.0)
    there, here = np.nan_to_num(places), np.nan_to_num(shape)
    total = np.maximum(weight.sum(axis=1), 1e-12)[:, None]
    to_mean = np.einsum("fm,fmx->fx", weight, there) / total
    from_mean = weight @ here / total
    spread = np.einsum(
        "fm,fmx,fmy->fxy", weight, there - to_mean[:, None], here - from_mean[:, None]
    )
    left, _, right = np.linalg.svd(spread)
    left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
    rotation = left @ right
    translation = to_mean - np.einsum("fxy,fy->fx", rotation, from_mean)
    last = _last((weight > 0).sum(axis=1) >= 3)
    return HeadMotion(rotation[last], translation[last])


def _steady(motion: HeadMotion, centre: Array, rate: float) -> HeadMotion:
    """The motion through a running parabola, about ``centre`` (3,) of the markers."""
    middle = motion.rotation[len(motion.rotation) // 2]
    vectors = to_vector(middle.T @ motion.rotation)
    path = motion.translation + motion.rotation @ centre
    pose, _ = steady(np.concatenate([_LEVER * vectors, path], axis=1), rate)
    rotation = middle @ from_vector(pose[:, :3] / _LEVER)
    return HeadMotion(rotation, pose[:, 3:] - rotation @ centre)


def _last(known: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(F,) the last frame that is known, or the first of all."""
    frames = np.where(known, np.arange(len(known)), -1)
    return np.where((last := np.maximum.accumulate(frames)) < 0, int(np.argmax(known)), last)

"""A performance made from motion that is known: by whoever has some, by tests and benchmarks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from mien.performance.performance import Performance, Span

Array = NDArray[np.float64]


def acted(
    points: Sequence[str],
    neutral: Array,
    motion: Array,
    *,
    sigma: Array,
    unseen: Array | None = None,
    spans: Sequence[Span] = (),
    scalars: Mapping[str, Array] | None = None,
    rate: float = 30.0,
) -> Performance:
    """A performance by a still head that looks straight ahead.

    ``points`` (P) FDP ids at ``neutral`` (P, 3), ``motion`` (F, P, 3) mm in the head frame,
    ``sigma`` (P,) mm; ``unseen`` (F, 3) or (3,) unit directions along which the motion is lost;
    ``rate`` frames a second.
    """
    frames = len(motion)
    blind = np.broadcast_to(np.zeros(3) if unseen is None else unseen, (frames, 3)).copy()
    along = (motion * blind[:, None]).sum(axis=-1, keepdims=True)
    return Performance(
        points=tuple(points),
        neutral=neutral,
        time=np.arange(frames) / rate,
        motion=motion - along * blind[:, None],
        sigma=np.repeat(np.asarray(sigma, dtype=float)[:, None], 3, axis=1),
        rotation=np.tile(np.eye(3), (frames, 1, 1)),
        translation=np.zeros((frames, 3)),
        gaze=np.zeros((frames, 2, 2)),
        confidence=np.ones(frames),
        lost=np.zeros(frames, dtype=bool),
        unseen=blind,
        spans=tuple(spans),
        scalars=dict(scalars or {}),
    )

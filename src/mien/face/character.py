"""A character: a face with key models, and how it likes to be driven."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Face


@dataclass(frozen=True, slots=True)
class KeyModels:
    """Sculpted faces as displacement fields from one neutral."""

    names: tuple[str, ...]
    """(K) such as "smile", "blink_left", "jaw_open"."""
    displacements: NDArray[np.float32]
    """(K, V, 3) mm in the head frame."""

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        """(V, 3) displacement of one key model. Raises KeyError."""
        if name not in self.names:
            raise KeyError(name)
        return np.asarray(self.displacements[self.names.index(name)])


@dataclass(frozen=True, slots=True, eq=False)
class Character:
    """A face that can act. Characters are compared and remembered by identity."""

    name: str
    face: Face
    keys: KeyModels
    examples: tuple[str, ...]
    """Names of the key models that are the mapping's target examples [B] §4 (the thirteen)."""

    def surface(self, weights: Array) -> Array:
        """Vertices (V, 3) at key-model ``weights`` (K,): neutral plus the weighted sum of
        displacements, [B] eq. 14."""
        return self.face.vertices + np.tensordot(weights, self.keys.displacements, axes=1)

"""A character: a face with key models, and how it likes to be driven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Face
from mien.face.origin import Origin

BLINKS = frozenset({"blink", "blink_left", "blink_right"})
"""What mien's own characters call the key models that shut eyes."""


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
    whole: bool = False
    """Its examples are driven as they are and not in pieces: somebody's file has no others."""
    blinks: frozenset[str] = BLINKS
    """Key models that shut eyes: they split into sides but not into regions, for a lid is one."""
    meanings: Mapping[str, str] = field(default_factory=dict)
    """Key models that stand for a key model of the generic face, whatever they move."""
    speaks: Mapping[str, Mapping[str, tuple[str, ...]]] = field(default_factory=dict)
    """Vocabularies such as "arkit": its names, and the key models that answer to each."""
    looks: Mapping[str, str] = field(default_factory=dict)
    """Key models that turn both eyes "left", "right", "up" and "down", where no node does."""
    origin: Origin | None = None
    """The file it was imported from, where that can be animated as it is."""

    def surface(self, weights: Array) -> Array:
        """Vertices (V, 3) at key-model ``weights`` (K,): neutral plus the weighted sum of
        displacements, [B] eq. 14."""
        return self.face.vertices + np.tensordot(weights, self.keys.displacements, axes=1)

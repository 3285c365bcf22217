"""Where an imported character came from, and what its key models drive there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mien.face.face import Array, Ints
from mien.face.model import Bind, Hooks


@dataclass(frozen=True, slots=True, eq=False)
class Origin:
    """A GLB or VRM file, whole, and the way between it and the head frame."""

    glb: bytes
    binds: Mapping[str, tuple[Bind, ...]]
    """The morph targets that each key model drives, by its name."""
    hooks: Hooks
    turn: Array
    """(3, 3) file_from_head, a rotation."""
    scale: float
    """Millimetres in a unit of the file."""
    centre: Array
    """(3,) the head frame's origin in the file."""
    expressions: Mapping[str, str]
    """VRM expression that a key model is, by its name."""
    overrides: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    """What VRM expressions take "blink", "lookAt" and "mouth" away: "block" or "blend"."""
    order: Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int32))
    """(V,) which of the file's vertices, primitive after primitive, each of the face's is. Not kept
    in a character file."""

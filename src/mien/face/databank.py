"""A databank: expressions of one person as meshes in which the same vertex is the same skin point.

It is kept as a character is (``character``), so that whatever takes a character takes a databank.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character, KeyModels
from mien.face.face import Face


@dataclass(frozen=True, slots=True, eq=False)
class Databank:
    """K faces of one person beside the neutral [Z] §2. Remembered by identity, as characters."""

    name: str
    face: Face
    """The person's neutral, with feature points, in the head frame."""
    names: tuple[str, ...]
    """(K) such as "smile", "v06"; the neutral is not among them."""
    displacements: NDArray[np.float32]
    """(K, V, 3) mm from the neutral."""

    def __post_init__(self) -> None:
        wanted = (len(self.names), len(self.face.vertices), 3)
        if self.displacements.shape != wanted or not self.names:
            raise ValueError(f"faces of shape {self.displacements.shape}, expected {wanted}")

    def character(self) -> Character:
        """The same as a character that has every face as an example."""
        return Character(
            self.name, self.face, KeyModels(self.names, self.displacements), self.names
        )


def databank(character: Character) -> Databank:
    """A character's examples as a databank. Raises ValueError where it has none."""
    rows = [character.keys.names.index(name) for name in character.examples]
    return Databank(
        character.name, character.face, character.examples, character.keys.displacements[rows]
    )

"""A mapper of one's own: build it for a character and a performer, call it with a performance.

python examples/09_add_a_mapper.py
"""

from dataclasses import dataclass, replace

import numpy as np

import mien
from mien.capture.shapes import motion_from_shapes
from mien.face.character import Character
from mien.face.library import generic_face
from mien.mapping import JointMapper, Settings
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.vocabulary.arkit import names


@dataclass(frozen=True)
class Stepped:
    """Maps as the default does, then holds every pose for four frames, as puppets are filmed."""

    inner: JointMapper
    hold: int = 4

    def __call__(self, performance: Performance) -> Curves:
        curves = self.inner(performance)
        held = np.arange(len(curves)) // self.hold * self.hold
        return replace(curves, weights=curves.weights[held])


def stepped(character: Character, header: Performance, settings: Settings) -> Stepped:
    """What ``MAPPERS`` wants: in a checkout, one line there makes it ``--mapping stepped``."""
    return Stepped(JointMapper(character, header, settings))


def main() -> None:
    """An opening mouth in steps."""
    jaw = np.array([name == "jawOpen" for name in names()], dtype=float)
    take = performance_of([ArkitFrame(i / 24, jaw * i / 24) for i in range(25)], "example")
    moved = motion_from_shapes(take, generic_face())
    toy = mien.load_character("toy")
    curves = stepped(toy, moved, Settings())(moved)
    print(f"{len(np.unique(curves.weights, axis=0))} poses in {len(curves)} frames")


if __name__ == "__main__":
    main()

"""A face without any shapes gets key models by deformation transfer, and acts.

python examples/05_make_a_character.py
"""

from dataclasses import replace

import numpy as np

import mien
from mien.face.library import generic_face
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.sculpt.transfer.make import make
from mien.sculpt.transfer.shapes import driven
from mien.vocabulary.arkit import names

SHAPES = ("jawOpen", "mouthSmileLeft", "mouthSmileRight", "eyeBlinkLeft", "eyeBlinkRight")


def main() -> None:
    """Take a longer, wider head for somebody's bare face; lay five of ARKit's shapes on it."""
    man = mien.load_character("man").face
    stretch = np.array([1.06, 1.1, 1.0])
    pivots = {name: place * stretch for name, place in man.pivots.items()}
    bare = replace(man, vertices=man.vertices * stretch, pivots=pivots)
    made = make(bare, generic_face(), SHAPES, "somebody")
    character = driven(made.character, "arkit")

    wide = np.array([name == "jawOpen" for name in names()], dtype=float)
    frames = [ArkitFrame(i / 30, wide * i / 10) for i in range(11)]
    curves = mien.animate(performance_of(frames, "example"), character)
    mien.save(curves, "somebody.glb", character)
    chin = character.face.points.index(["2.1"])
    fall = character.face.points.at(character.keys["jawOpen"])[chin][0]
    print(f"somebody.glb: the chin falls by {-fall[1]:.1f} mm; {len(made.notes)} notes")


if __name__ == "__main__":
    main()

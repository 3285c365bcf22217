"""Any performance drives any face.

    performance = mien.capture("take.mp4")
    curves = mien.animate(performance, "man")
    mien.save(curves, "man.glb")
"""

from mien.face.library import CHARACTERS, load_character
from mien.recipe import animate, capture

__all__ = ["CHARACTERS", "animate", "capture", "load_character"]

"""Any performance drives any face.

performance = mien.capture("take.mp4")
curves = mien.animate(performance, "man")
mien.save(curves, "man.glb", mien.load_character("man"))
"""

# Bound here and not when asked for: the function ``capture`` shares its name with a room, and
# whichever is bound last wins.
from mien.face.library import CHARACTERS, load_character
from mien.formats.save import save
from mien.recipe import animate, capture, film, load_performance, save_performance

__all__ = [
    "CHARACTERS",
    "animate",
    "capture",
    "film",
    "load_character",
    "load_performance",
    "save",
    "save_performance",
]

"""Any performance drives any face.

performance = mien.capture("take.mp4")
curves = mien.animate(performance, "man")
mien.save(curves, "man.glb")
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mien.face.library import CHARACTERS, load_character
    from mien.recipe import animate, capture

__all__ = ["CHARACTERS", "animate", "capture", "load_character"]

_HOME = {
    "CHARACTERS": "mien.face.library",
    "animate": "mien.recipe",
    "capture": "mien.recipe",
    "load_character": "mien.face.library",
}


def __getattr__(name: str) -> object:
    # Found when asked for: ``mien --help`` need not wait for numba and the mathematics.
    if name not in _HOME:
        raise AttributeError(f"module 'mien' has no attribute '{name}'")
    value = getattr(import_module(_HOME[name]), name)
    globals()[name] = value
    return value

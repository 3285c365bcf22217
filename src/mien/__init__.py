"""Any performance drives any face.

performance = mien.capture("take.mp4")
curves = mien.animate(performance, "man")
mien.save(curves, "man.glb", mien.load_character("man"))
"""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mien.face.library import CHARACTERS
    from mien.formats.save import save
    from mien.recipe import animate, capture, film, load_performance, save_performance
    from mien.rig.load import load_character

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

_HOME = dict.fromkeys(__all__, "mien.recipe") | {
    "CHARACTERS": "mien.face.library",
    "load_character": "mien.rig.load",
    "save": "mien.formats.save",
}


class _Front(ModuleType):
    """Finds a public name when it is asked for: ``mien --help`` need not wait for the mathematics.

    The function ``capture`` shares its name with a room, which the import system would put here
    once it is loaded; the function keeps the name.
    """

    def __getattr__(self, name: str) -> object:
        if name not in _HOME:
            raise AttributeError(f"module 'mien' has no attribute '{name}'")
        value = getattr(import_module(_HOME[name]), name)
        setattr(self, name, value)
        return value

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Front

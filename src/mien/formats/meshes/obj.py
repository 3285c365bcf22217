"""A take as a sequence of Wavefront OBJ files, one a frame, for tools that read nothing else.

Vertices carry their colour behind their place (``v x y z r g b``), which Blender, MeshLab and
Houdini understand. All frames share one ``.mtl``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.face import Array, Face
from mien.face.targets import targets
from mien.formats.atomic import whole_folder
from mien.performance.curves import Curves

_MATERIALS = "materials.mtl"


def write_obj_sequence(path: Path, character: Character, curves: Curves) -> None:
    """Write the folder ``path`` with ``frame_00001.obj`` and so on, in metres.

    An earlier sequence there is replaced. Raises OutputError; ValueError where the curves drive
    targets that the character has not.
    """
    poser = Poser(character.face, targets(character, curves.names))
    colours, parts = _colours(character.face), _parts(character.face)
    with whole_folder(path) as folder:
        (folder / _MATERIALS).write_text(_materials(character.face))
        for frame in range(len(curves)):
            head = f"# {character.name}, {curves.time[frame]:.6f} s\nmtllib {_MATERIALS}\n"
            vertices = _vertices(poser.at(curves, frame), colours)
            (folder / f"frame_{frame + 1:05d}.obj").write_text(head + vertices + parts)


def _vertices(places: Array, colours: Array) -> str:
    rows = np.concatenate([1e-3 * places, colours], axis=1)
    return _lines("v %.6f %.6f %.6f %.3f %.3f %.3f\n", rows)


def _parts(face: Face) -> str:
    """The faces of all parts: the same text in every frame."""
    return "".join(
        f"o {part.name}\nusemtl {part.material}\ns 1\n" + _lines("f %d %d %d\n", part.triangles + 1)
        for part in face.parts
    )


def _lines(line: str, rows: NDArray[Any]) -> str:
    # One formatting of everything: four times as fast as numpy.savetxt.
    return line * len(rows) % tuple(rows.ravel().tolist())


def _materials(face: Face) -> str:
    """One material a name, in the mean colour of its parts."""
    text = []
    for name in face.materials:
        runs = [face.colours[p.first : p.last] for p in face.parts if p.material == name]
        if runs:
            r, g, b = np.concatenate(runs).mean(axis=0)
            text.append(f"newmtl {name}\nKd {r:.4f} {g:.4f} {b:.4f}\n")
    return "\n".join(text)


def _colours(face: Face) -> NDArray[np.float64]:
    """(V, 3) sRGB: readers of coloured OBJ take the numbers for what a screen shows."""
    linear = np.clip(face.colours, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)

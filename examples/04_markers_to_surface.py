"""Sparse markers become a dense surface through a databank of faces [Z].

python examples/04_markers_to_surface.py
"""

import numpy as np

import mien
from mien.face.databank import databank
from mien.performance.acted import acted
from mien.recipe import animate_surface

MARKERS = (
    *("4.1", "4.2", "4.3", "4.4", "5.3", "5.4", "8.1", "8.2", "8.3", "8.4", "9.1", "9.2"),
    *("9.3", "2.1", "2.10", "8.5", "8.6", "8.7", "8.8", "11.1"),
)


def main() -> None:
    """The woman wears twenty markers and smiles by half; her other faces say how skin follows."""
    woman = mien.load_character("woman")
    smile, points = woman.keys["smile"], woman.face.points
    rows = points.index(list(MARKERS))
    still, field = points.at(woman.face.vertices)[rows], points.at(smile)[rows]
    level = 0.5 * np.sin(np.linspace(0.0, np.pi, 31)) ** 2
    noise = np.random.default_rng(0).normal(0.0, 0.3, (31, len(MARKERS), 3))
    motion = level[:, None, None] * field + noise
    take = acted(MARKERS, still, motion, sigma=np.full(len(MARKERS), 0.3))

    character, curves = animate_surface(take, databank(woman))
    truth = woman.face.vertices + level.max() * smile
    told = character.surface(curves.weights[level.argmax()])
    skin = woman.face.part("skin")
    off, moved = (
        np.linalg.norm(truth - other, axis=1)[skin.first : skin.last].mean()
        for other in (told, woman.face.vertices)
    )
    mien.save(curves, "surface.glb", character)
    print(f"surface.glb: {off:.2f} mm from the true skin, which moved by {moved:.2f} mm")


if __name__ == "__main__":
    main()

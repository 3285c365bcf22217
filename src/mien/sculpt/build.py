"""From sculptures to the characters that are shipped.

python -m mien.sculpt.build            all of them
python -m mien.sculpt.build man toy    these
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character, KeyModels
from mien.face.face import Face, Part
from mien.face.library import CHARACTERS, GENERIC, character_file
from mien.face.store import write_character
from mien.numeric.biharmonic import uniform_laplacian
from mien.sculpt.acting import jaw
from mien.sculpt.acting.expression import Expression
from mien.sculpt.acting.expressions import KEYS
from mien.sculpt.anatomy.cage import cage
from mien.sculpt.anatomy.head import Head, neutral_head
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.brush import ramp
from mien.sculpt.cast import CAST
from mien.sculpt.materials import MATERIALS
from mien.sculpt.occlusion import sky_seen
from mien.sculpt.points import feature_points
from mien.sculpt.sculpture import Sculpture, moving_parts, skin_solid, still_parts
from mien.sculpt.solid import Solid
from mien.sculpt.unwrap import unwrapped

Array = NDArray[np.float64]

_NECK = np.array([0.0, -104.0, -58.0])
"""What the head turns about, in the sculpting frame: the middle of the collar, so that the neck
leaves it where it entered it."""
_SMOOTHINGS = 3
"""Rounds of averaging over the skin's neighbours, for occlusion."""
_STILL, _MOVES = 0.02, 0.10
"""mm: what a key model moves less stands still, and between the two it fades. Nobody sees it, and
what stands still takes no room in a file."""
_IN_MOUTH = 0.45
"""Strength of the occlusion on the mouth bag."""


def build_character(name: str) -> Character:
    """Sculpt "generic" or one of CHARACTERS anew. Raises KeyError."""
    return sculpted(CAST[name])


def sculpted(sculpture: Sculpture) -> Character:
    """The character of a ``sculpture``."""
    neutral = neutral_head(sculpture.proportions)
    still = still_parts(sculpture, neutral)
    moving = moving_parts(sculpture, neutral, neutral)
    solids = [skin_solid(sculpture, neutral), *still, *moving]
    vertices = np.concatenate([solid.vertices for solid in solids])
    eye = sculpture.proportions.eye
    origin = np.array([0.0, eye.height, eye.depth])
    parts = _parts(solids)
    pivots = {
        "head": _NECK - origin,
        "jaw": jaw.PIVOT - origin,
        "eye_left": np.array([eye.aside, 0.0, 0.0]),
        "eye_right": np.array([-eye.aside, 0.0, 0.0]),
    }
    face = Face(
        vertices=vertices - origin,
        parts=parts,
        materials={part.material: MATERIALS[part.material] for part in parts},
        colours=np.concatenate([np.broadcast_to(s.colours, s.vertices.shape) for s in solids]),
        occlusion=_occlusion(sculpture, neutral, solids),
        points=feature_points(vertices - origin, parts),
        pivots=pivots,
        uv=unwrapped(solids),
    )
    keys = KeyModels(
        tuple(sculpture.keys),
        np.stack([_displacement(sculpture, neutral, solids, name) for name in sculpture.keys]),
    )
    return Character(sculpture.name, face, keys, sculpture.examples)


def _parts(solids: Sequence[Solid]) -> tuple[Part, ...]:
    parts, first = [], 0
    for solid in solids:
        last = first + len(solid.vertices)
        triangles = (solid.triangles + first).astype(np.int32)
        parts.append(Part(solid.name, solid.material, first, last, triangles, solid.follows))
        first = last
    return tuple(parts)


def _posed(sculpture: Sculpture, neutral: Head, solids: Sequence[Solid], pose: Expression) -> Array:
    """(V, 3) all vertices with ``pose`` on the face."""
    head = neutral.posed(pose)
    moved = {solid.name: solid.vertices for solid in moving_parts(sculpture, neutral, head)}
    moved["skin"] = head.skin
    return np.concatenate([moved.get(solid.name, solid.vertices) for solid in solids])


def _displacement(
    sculpture: Sculpture, neutral: Head, solids: Sequence[Solid], name: str
) -> NDArray[np.float32]:
    after = _posed(sculpture, neutral, solids, sculpture.keys[name])
    before = np.concatenate([solid.vertices for solid in solids])
    if name in sculpture.starts:
        before = _posed(sculpture, neutral, solids, sculpture.starts[name])
    motion = after - before
    far = np.linalg.norm(motion, axis=1, keepdims=True)
    return np.asarray(motion * ramp(_STILL, _MOVES, far), dtype=np.float32)


def _occlusion(sculpture: Sculpture, neutral: Head, solids: Sequence[Solid]) -> Array:
    """(V,) baked at rest; what only an open mouth shows is baked in one."""
    triangles = np.concatenate([part.triangles for part in _parts(solids)])
    shut = np.concatenate([solid.vertices for solid in solids])
    opened = _posed(sculpture, neutral, solids, KEYS["jaw_open"])
    closed_sky, open_sky = (sky_seen(v, triangles) for v in (shut, opened))
    inside = np.concatenate([np.full(len(s.vertices), float(s.revealed)) for s in solids])
    label = labels()
    inside[: len(neutral.skin)] = np.clip(3 * label.bag + label.inner_lips, 0, 1)
    strength = np.concatenate([np.full(len(s.vertices), s.shade) for s in solids])
    strength[: len(neutral.skin)] = np.where(label.bag > 0.3, _IN_MOUTH, 1.0)
    sky = closed_sky * (1 - inside) + open_sky * inside
    sky[: len(neutral.skin)] = _smoothed(sky[: len(neutral.skin)])
    return np.asarray(np.clip(1 - (1 - sky) * strength, 0, 1))


def _smoothed(sky: Array) -> Array:
    """Depth tests are grainy where the skin's triangles are large."""
    mesh = cage().subdivision
    near = uniform_laplacian(mesh.triangles, len(sky))
    for _ in range(_SMOOTHINGS):
        sky = sky - 0.5 * (near @ sky)
    return sky


def main(names: Sequence[str]) -> None:
    """Sculpt ``names`` (all where there are none) and write them where the library reads them."""
    for name in names or (GENERIC, *CHARACTERS):
        character = build_character(name)
        write_character(character_file(name), character)
        triangles = len(character.face.triangles)
        size = character_file(name).stat().st_size
        print(
            f"{name}: {triangles} triangles, {len(character.keys.names)} key models, {size} bytes"
        )


if __name__ == "__main__":
    main(sys.argv[1:])

"""The people the generic face may turn out to be: proportions drawn at random, and their modes.

python -m mien.sculpt.people    writes what the shape space reads
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.face.shape_space import IDENTITY_FILE, principal_modes
from mien.sculpt.anatomy.head import neutral_head
from mien.sculpt.cast import CAST
from mien.sculpt.proportions import Brush, Proportions
from mien.vocabulary.landmarks import FACE_LANDMARKS

Array = NDArray[np.float64]

PEOPLE, MODES = 240, 40
_PUPILS = 63.0
_SPREAD: dict[str, dict[str, float]] = {
    "head": {
        "face_width": 0.04,
        "jaw_width": 0.05,
        "midface": 0.06,
        "lower_face": 0.06,
        "chin_up": 3.0,
        "chin_forward": 3.0,
        "cheek": 2.5,
        "nose": 0.10,
        "nose_up": 2.0,
        "nostril": 0.5,
        "brow_up": 1.5,
        "brow_forward": 1.5,
    },
    "eye": {
        "height": 1.2,
        "depth": 1.5,
        "half_width": 1.0,
        "upper": 0.9,
        "lower": 0.8,
        "tilt": 1.0,
        "crease_offset": 0.4,
    },
    "mouth": {
        "half_width": 2.2,
        "height": 2.0,
        "depth": 1.5,
        "corner_depth": 1.5,
        "upper": 1.2,
        "lower": 1.2,
        "fullness": 0.6,
        "bend": 0.7,
    },
}
"""Standard deviations of the measures of adult faces, about the generic one."""
_BUMPS, _BUMP = 10, 2.5
"""Pushes that no measure names, and their standard deviation in mm."""


def draw(base: Proportions, random: np.random.Generator) -> Proportions:
    """Somebody: ``base`` with every measure drawn about its own."""
    varied = {
        part: replace(
            getattr(base, part),
            **{
                name: _near(getattr(getattr(base, part), name), sd, random)
                for name, sd in by.items()
            },
        )
        for part, by in _SPREAD.items()
    }
    bumps = tuple(_bump(random) for _ in range(_BUMPS))
    head = replace(varied["head"], brushes=(*base.head.brushes, *bumps))
    return replace(base, **{**varied, "head": head})


def _near(value: Any, spread: float, random: np.random.Generator) -> Any:
    if isinstance(value, tuple):
        return tuple(float(each + spread * random.normal()) for each in value)
    return float(value + spread * random.normal())


def _bump(random: np.random.Generator) -> Brush:
    """A broad push somewhere on the front of the face."""
    aside, up = random.uniform(0.0, 62.0), random.uniform(-95.0, 75.0)
    centre = (aside, up, 60.0 - 0.011 * aside**2 - 0.003 * up**2)
    radii = tuple(float(r) for r in random.uniform(16.0, 38.0, 3))
    push = random.normal(0.0, 1.0, 3) * np.array([0.5, 0.5, 1.0]) * _BUMP
    return Brush(centre, (radii[0], radii[1], radii[2]), (push[0], push[1], push[2]))


def at_rest(proportions: Proportions) -> Array:
    """(468, 3) the detector's landmarks on that person, head frame, pupils as far apart as the
    generic face's."""
    eye = proportions.eye
    places = neutral_head(proportions).skin[:FACE_LANDMARKS] - [0.0, eye.height, eye.depth]
    return np.asarray(places * (_PUPILS / (2.0 * eye.aside)))


def main() -> None:
    """Draw the people and keep their modes."""
    random = np.random.default_rng(7)
    base = CAST["generic"].proportions
    drawn = np.array([at_rest(draw(base, random)) for _ in range(PEOPLE)])
    _, modes = principal_modes(drawn, MODES)
    scale = np.abs(modes).max(axis=(1, 2)) / 32767
    np.savez_compressed(
        IDENTITY_FILE,
        steps=np.rint(modes / scale[:, None, None]).astype(np.int16),
        scale=scale,
    )
    print(f"{len(drawn)} people, {MODES} modes, {IDENTITY_FILE.stat().st_size} bytes")
    print("mm rms of each mode:", np.sqrt((modes**2).sum(-1).mean(-1)).round(2).tolist())


if __name__ == "__main__":
    main()

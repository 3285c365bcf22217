"""The cast's geometry in every key model, whole and half, and in pairs that people mix."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from itertools import combinations

import numpy as np
import pytest
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.library import CHARACTERS, GENERIC, load_character
from mien.face.pieces import Pieces, split
from mien.mapping.lids import find_lids
from mien.sculpt import soundness
from mien.sculpt.acting.repertoire import go_together
from mien.sculpt.acting.units import STARTS
from mien.sculpt.anatomy.cage import LIPS, cage
from mien.sculpt.anatomy.lips import lip_volumes
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.cast import CAST

Array = NDArray[np.float64]
Weights = dict[str, float]

SKIN = len(cage().fine_mirror)
PAIRS = 200
BLINKS = ("blink_left", "blink_right")
ARKIT_BLINKS = {"eyeBlinkLeft": "blink_left", "eyeBlinkRight": "blink_right"}
LIDS = (0.25, 0.5, 0.75, 1.0)
"""Closures on the way of a blink."""
SHUT = ("pressed", "pucker", "viseme_p", "viseme_f", "mouthClose")


@dataclass(frozen=True)
class Measures:
    """What is measured of a pose; as limits, what is allowed."""

    turned: float = 0.0
    """Skin triangles turned by more than 102 degrees."""
    flat: float = 0.0
    """Skin triangles less than a micrometre high."""
    eyeball: float = 0.2
    """mm that skin reaches into an eyeball."""
    gap: float = 0.3
    """mm between lids that are closed."""
    thin: float = 0.75
    thick: float = 1.3
    """Lips' volumes next to those at rest."""


LIMITS = Measures()


@pytest.fixture(params=(GENERIC, *CHARACTERS), scope="module")
def character(request: pytest.FixtureRequest) -> Character:
    return load_character(request.param)


def posed(character: Character, weights: Weights) -> Array:
    places = character.face.vertices.copy()
    for key, weight in weights.items():
        places += weight * field(character, key)
    return places


def field(character: Character, key: str) -> NDArray[np.float32]:
    """Displacements of a key model with what it starts from."""
    moved = character.keys[key]
    return moved + character.keys["jawOpen"] if key in STARTS else moved


def mixed(character: Character, weights: Weights, shut: float = 1.0) -> tuple[Array, Array]:
    """Vertices of a mixture as the mapping makes it, and (2,) how far it closes the eyes: a blink
    sets how far, up to ``shut``, and what else moves the lids gives way to it."""
    weights = {ARKIT_BLINKS.get(key, key): weight for key, weight in weights.items()}
    closure = np.array([shut * weights.pop(blink, 0.0) for blink in BLINKS])
    pieces = acted(character, weights)
    level = np.array([weights.get(character.keys.names[key], 0.0) for key in pieces.key])
    lids = find_lids(character, pieces)
    assert lids is not None
    wanted = np.where(closure > 0, closure, -np.inf)
    level = lids.mix(level[None], wanted[None])[0]
    places = character.face.vertices + np.tensordot(level, pieces.displacements, axes=1)
    return np.asarray(places), closure


def acted(character: Character, weights: Weights) -> Pieces:
    """The blinks, the pieces of what a character acts, and what else it acts whole."""
    pieces = split(character)
    names = [character.keys.names[key] for key in pieces.key]
    used = np.array([name in weights or name in BLINKS for name in names])
    others = [key for key in weights if key not in character.examples]
    rows = [character.keys.names.index(key) for key in others]
    none = np.full(len(others), -1)
    return Pieces(
        (*np.array(pieces.names)[used].tolist(), *others),
        np.append(pieces.key[used], np.array(rows, dtype=np.intp)),
        np.append(pieces.region[used], none),
        np.append(pieces.side[used], none),
        np.concatenate([pieces.cells[used], np.zeros((len(others), 3, 2), bool)]),
        np.concatenate([pieces.displacements[used], *(field(character, k)[None] for k in others)]),
    )


def measured(character: Character, places: Array, closure: Array) -> Measures:
    face = character.face
    rest = face.vertices[:SKIN]
    skin = places[:SKIN]
    volumes = lip_volumes(skin) / lip_volumes(rest)
    shut = [float(soundness.lid_gap(skin, side)) for side in (0, 1) if closure[side] > 0.98]
    return Measures(
        turned=float((soundness.turned(rest, skin) > 102).sum()),
        flat=float((soundness.thinness(skin) < 0.001).sum()),
        eyeball=_radius(character) - _nearest(character, skin),
        gap=max(shut, default=0.0),
        thin=float(volumes.min()),
        thick=float(volumes.max()),
    )


def _radius(character: Character) -> float:
    return CAST[character.name].proportions.eye.radius


def _nearest(character: Character, skin: Array) -> float:
    """mm from the middle of an eyeball to the nearest skin outside its lids."""
    outer = skin[(labels().lid_inside < 0.02) & (labels().mask > 0.9)]
    ahead = outer[outer[:, 2] > 0]
    pivots = [character.face.pivots[f"eye_{side}"] for side in ("left", "right")]
    return float(min(np.linalg.norm(ahead - pivot, axis=1).min() for pivot in pivots))


def short_of(allowed: Measures, found: Measures) -> dict[str, float]:
    """What of ``found`` is beyond what is ``allowed``."""
    least = ("thin",)
    return {
        name: value
        for name, value in asdict(found).items()
        if (value < getattr(allowed, name) if name in least else value > getattr(allowed, name))
    }


def pairs(character: Character, together: bool, count: int) -> list[tuple[str, str]]:
    """Key models drawn at random among those that go together, or among the others."""
    every = [
        pair for pair in combinations(character.keys.names, 2) if go_together(*pair) == together
    ]
    chosen = np.random.default_rng(10).choice(len(every), min(count, len(every)), replace=False)
    return [every[row] for row in sorted(chosen)]


@pytest.mark.parametrize("weight", [1.0, 0.5])
def test_every_key_model_is_sound(character: Character, weight: float) -> None:
    worse = {}
    for key in character.keys.names:
        places = posed(character, {key: weight})
        shut = np.array([weight * (ARKIT_BLINKS.get(key, key) == blink) for blink in BLINKS])
        found = short_of(LIMITS, measured(character, places, shut))
        if found:
            worse[key] = found
    assert not worse


def test_key_models_that_people_mix_are_sound(character: Character) -> None:
    worse = {}
    for first, second in pairs(character, together=True, count=PAIRS):
        places, closure = mixed(character, {first: 1.0, second: 1.0})
        found = short_of(LIMITS, measured(character, places, closure))
        if found:
            worse[first, second] = found
    assert not worse


def test_every_face_can_blink_on_the_way(character: Character) -> None:
    """... from whatever it was doing: both eyes, whole and in part."""
    worse = {}
    for key in character.examples:
        for shut in LIDS:
            both = dict.fromkeys(BLINKS, 1.0)
            places, closure = mixed(character, {key: 1.0, **both}, shut)
            found = short_of(LIMITS, measured(character, places, closure))
            if found:
                worse[key, shut] = found
    assert not worse


def test_blends_of_the_others_are_sound(character: Character) -> None:
    worse = {}
    for first, second in pairs(character, together=False, count=PAIRS // 2):
        places, closure = mixed(character, {first: 0.5, second: 0.5})
        found = short_of(LIMITS, measured(character, places, closure))
        if found:
            worse[first, second] = found
    assert not worse


def test_lips_meet_at_rest(character: Character) -> None:
    assert soundness.lip_gap(character.face.vertices) < 0.3
    opened = posed(character, {"jaw_open": 1.0})
    assert soundness.lip_gap(opened) > 20


def test_lips_do_not_pass_through_each_other(character: Character) -> None:
    shut = [key for key in SHUT if key in character.keys.names]
    for weights in ({}, *({key: weight} for key in shut for weight in (1.0, 0.5))):
        assert soundness.lip_overlap(posed(character, weights)) < 0.5, weights


def test_lips_pushed_together_are_found_out(character: Character) -> None:
    places = character.face.vertices.copy()
    places[LIPS[:, 11:]] += [0, 2.0, 0]
    assert soundness.lip_overlap(places) > 1.0


def test_teeth_do_not_come_through(character: Character) -> None:
    face = character.face
    rows = [np.arange(p.first, p.last) for p in face.parts if p.name.startswith("teeth")]
    if not rows:
        return
    teeth = np.concatenate(rows)
    speech = [key for key in character.keys.names if key.startswith(("viseme", "mouthClose"))]
    for key in ("smile", "laugh", "jaw_open", *speech):
        for weight in (0.0, 0.5, 1.0):
            places = posed(character, {key: weight})
            assert soundness.teeth_through(places, places[teeth]) < 0.3, (key, weight)
    ahead = face.vertices[teeth] + [0, 0, 15.0]
    assert soundness.teeth_through(face.vertices, ahead) > 1.0


def test_what_does_not_go_together() -> None:
    assert go_together("smile", "blink_left")
    assert go_together("surprise", "blink_right")
    assert go_together("anger", "jaw_open")
    assert not go_together("smile", "pucker")
    assert not go_together("surprise", "jaw_open")
    assert not go_together("anger", "brow_up_left")

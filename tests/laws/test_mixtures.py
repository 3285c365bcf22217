"""Expressions that mix morph targets act as one, and take from others what their artist said."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faces import toy_curves
from guests import document, edited, guest, write_guest
from mien.face.character import Character
from mien.face.model import Hooks
from mien.face.origin import Origin
from mien.face.overrides import for_player, overridden
from mien.face.store import read_character, write_character
from mien.rig.importer import Import, import_character

WORDS = {
    "eyeBlinkLeft": "blinkLeft",
    "jawOpen": "aa",
    "mouthSmileLeft": "happy",
    "mouthPucker": "angry",
}


def _overriding(**ways: dict[str, str]) -> Character:
    origin = Origin(b"glTF", {}, Hooks(0, vrm=1), np.eye(3), 1.0, np.zeros(3), WORDS, ways)
    return replace(guest(), whole=True, origin=origin)


def _curves(**levels: float) -> Any:
    curves = toy_curves(guest(), names=tuple(WORDS))
    row = [levels.get(word, 0.0) for word in WORDS.values()]
    gaze = np.full_like(curves.gaze, 0.2)
    return replace(curves, weights=np.tile(row, (len(curves), 1)), gaze=gaze)


def test_what_blocks_leaves_nothing_and_a_trace_of_it_blocks_nothing() -> None:
    character = _overriding(happy={"blink": "block", "lookAt": "block"})
    full = overridden(_curves(happy=1.0, blinkLeft=0.8, aa=0.5), character)
    assert full.weights[0].tolist() == pytest.approx([0.0, 0.5, 1.0, 0.0])
    assert not full.gaze.any()
    trace = overridden(_curves(happy=0.1, blinkLeft=0.8), character)
    assert trace.weights[0].tolist() == pytest.approx([0.8, 0.0, 0.0, 0.0])
    assert (trace.gaze == 0.2).all()


def test_what_blends_leaves_the_rest_and_players_blend_again() -> None:
    character = _overriding(happy={"mouth": "blend"}, angry={"mouth": "blend"})
    curves = _curves(happy=0.5, angry=0.25, aa=0.8)
    blended = overridden(curves, character)
    assert blended.weights[0, 1] == pytest.approx(0.8 * 0.5 * 0.75)
    np.testing.assert_allclose(for_player(blended, character).weights, curves.weights)


def test_overrides_outlive_the_character_file(tmp_path: Path) -> None:
    character = _overriding(happy={"blink": "block"})
    write_character(tmp_path / "a.character", character)
    origin = read_character(tmp_path / "a.character").origin
    assert origin is not None
    assert origin.overrides == {"happy": {"blink": "block"}}


def _imported(folder: Path, *, rename: bool = True) -> Import:
    """A VRM whose "angry" mixes a sneer that nothing else shows, and whose "happy" only mixes what
    others show."""
    path, points = write_guest(folder)
    names = document(path)["meshes"][0]["extras"]["targetNames"]

    def change(told: Any) -> None:
        node = next(i for i, n in enumerate(told["nodes"]) if n.get("mesh") == 0)

        def expression(**weights: float) -> dict[str, Any]:
            return {
                "morphTargetBinds": [
                    {"node": node, "index": names.index(name), "weight": weight}
                    for name, weight in weights.items()
                ]
            }

        custom = {
            "left": expression(mouthSmileLeft=1.0),
            "right": expression(mouthSmileRight=1.0),
        }
        preset = {
            "blinkLeft": expression(eyeBlinkLeft=1.0),
            "blinkRight": expression(eyeBlinkRight=1.0),
            "aa": expression(jawOpen=1.0),
            "happy": expression(mouthSmileLeft=0.8, mouthSmileRight=0.8, jawOpen=0.1),
            "angry": expression(noseSneerLeft=1.0, jawOpen=0.1),
        }
        head = next(i for i, n in enumerate(told["nodes"]) if n.get("name") == "head")
        told["extensionsUsed"] = ["VRMC_vrm"]
        told["extensions"] = {
            "VRMC_vrm": {
                "humanoid": {"humanBones": {"head": {"node": head}}},
                "expressions": {"preset": preset, "custom": custom},
            }
        }

    vrm = edited(path, change).rename(folder / "guest.vrm")
    return import_character(vrm, points=points)


def test_a_mixture_acts_where_nothing_else_shows_what_it_does(tmp_path: Path) -> None:
    found = _imported(tmp_path)
    acting = set(found.character.examples)
    assert {"angry", "aa", "left", "right", "blinkLeft", "blinkRight"} <= acting
    assert not {"happy", "noseSneerLeft"} & acting
    assert any("happy, noseSneerLeft" in note for note in found.notes)
    # What no expression holds acts under its own name.
    assert "mouthPucker" in acting

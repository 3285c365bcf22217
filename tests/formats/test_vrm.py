"""VRM 0.x and 1.0: expressions that combine targets, and animations for them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faces import toy_curves
from gltf_reader import Reader
from guests import DATA, document, edited, guest, needs_characters, write_quad
from mien.errors import InputError
from mien.face.model import Bind, Hooks
from mien.face.origin import Origin
from mien.formats.gltf.vrm import read_vrm
from mien.formats.gltf.vrma import write_vrma


def _vrm0(told: Any) -> None:
    def group(preset: str, *binds: tuple[int, int, float], name: str = "") -> dict[str, Any]:
        listed = [{"mesh": m, "index": t, "weight": w} for m, t, w in binds]
        return {"name": name or preset, "presetName": preset, "binds": listed}

    told["meshes"][0]["primitives"][0]["extras"] = {"targetNames": ["x", "y", "hide"]}
    told["extensions"] = {
        "VRM": {
            "humanoid": {"humanBones": [{"bone": "head", "node": 0}, {"bone": "hips", "node": 77}]},
            "blendShapeMaster": {
                "blendShapeGroups": [
                    group("neutral"),
                    group("blink_l", (0, 0, 100)),
                    group("joy", (0, 0, 50), (0, 1, 25)),
                    group("unknown", (0, 1, 100), name="Grin"),
                    group("a", (0, 99, 100), (7, 0, 100), (0, 0, -500)),
                ]
            },
        }
    }


def test_expressions_of_0x(tmp_path: Path) -> None:
    model = read_vrm(edited(write_quad(tmp_path / "a.vrm", targets=3), _vrm0))
    shapes = {shape.name: shape for shape in model.shapes}
    assert set(shapes) == {"blinkLeft", "happy", "Grin", "hide"}
    assert shapes["happy"].binds == (Bind(0, 0, 0.5), Bind(0, 1, 0.25))
    field = model.dense(shapes["happy"])
    assert np.allclose(field[:2, 2], [0.5, 0.25])
    assert shapes["hide"].expression == ""
    assert (model.forward, model.unit) == (-1, 1000.0)
    assert model.hooks == Hooks(0, (None, None), 0, {"head": 0})
    assert sum("left out" in note for note in model.notes) == 3


def test_expressions_of_1(tmp_path: Path) -> None:
    def change(told: Any) -> None:
        bind = {"node": 0, "index": 1, "weight": 0.4}
        told["extensions"] = {
            "VRMC_vrm": {
                "humanoid": {"humanBones": {"head": {"node": 0}}},
                "expressions": {"preset": {"aa": {"morphTargetBinds": [bind]}}, "custom": None},
            }
        }

    model = read_vrm(edited(write_quad(tmp_path / "a.vrm"), change))
    assert [shape.name for shape in model.shapes] == ["aa", "shape 0", "shape 1"]
    assert model.dense(model.shapes[0])[1, 2] == pytest.approx(0.4)
    assert (model.forward, model.hooks.vrm) == (1, 1)


def test_a_vrm_without_vrm_is_gltf(tmp_path: Path) -> None:
    model = read_vrm(write_quad(tmp_path / "a.vrm"))
    assert len(model.shapes) == 2
    assert any("no VRM" in note for note in model.notes)


def test_an_animation_carries_expressions_head_and_gaze(tmp_path: Path) -> None:
    plain = guest()
    expressions = {"eyeBlinkLeft": "blinkLeft", "jawOpen": "aa", "mouthPucker": "lookUp"}
    origin = Origin(b"", {}, Hooks(0, vrm=1), np.eye(3), 1000.0, np.zeros(3), expressions)
    curves = toy_curves(plain, names=tuple(expressions))
    write_vrma(tmp_path / "a.vrma", replace(plain, origin=origin), curves)
    told = document(tmp_path / "a.vrma")["extensions"]["VRMC_vrm_animation"]
    assert told["expressions"]["preset"].keys() == {"blinkLeft", "aa"}
    assert told["humanoid"]["humanBones"].keys() == {"hips", "head"}
    (tmp_path / "a.glb").write_bytes((tmp_path / "a.vrma").read_bytes())
    reader = Reader(tmp_path / "a.glb")
    times, places = reader.channels()["aa", "translation"]
    assert np.allclose(times, curves.time, atol=1e-6)
    assert np.allclose(places[:, 0], curves.weights[:, 1], atol=1e-6)
    assert ("lookAt", "rotation") in reader.channels()


def test_only_a_vrm_is_animated_so(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="only VRM"):
        write_vrma(tmp_path / "a.vrma", guest(), toy_curves(guest()))


@needs_characters
@pytest.mark.parametrize("name", ["Godette_vrm_v4.vrm", "godette_as_vrm1.vrm"])
def test_godette(name: str) -> None:
    model = read_vrm(DATA / "vrm" / name)
    shapes = {shape.name: shape for shape in model.shapes}
    assert {"blinkLeft", "aa", "happy", "angled_eyebrows", "HideHairBalls"} <= shapes.keys()
    assert "blink_left" not in shapes
    assert [bind.weight for bind in shapes["happy"].binds] == [0.5, 0.25]
    assert model.forward == (-1 if name.startswith("Godette") else 1)
    left = model.vertices[np.abs(model.dense(shapes["blinkLeft"])).max(axis=1) > 0.01]
    assert np.sign(left[:, 0].mean()) == model.forward


def test_one_name_in_two_meshes_is_mixed_once(tmp_path: Path) -> None:
    """An expression binds each mesh's target by itself, also where both are called the same."""

    def change(told: Any) -> None:
        told["meshes"].append(told["meshes"][0])
        told["nodes"].append({"mesh": 1, "translation": [5, 0, 0]})
        told["scenes"][0]["nodes"].append(1)
        for mesh in told["meshes"]:
            mesh["extras"] = {"targetNames": ["shut", "open"]}
        binds = [{"node": node, "index": 0, "weight": 1.0} for node in (0, 1)]
        expressions = {"preset": {"blink": {"morphTargetBinds": binds}}}
        told["extensions"] = {"VRMC_vrm": {"humanoid": {}, "expressions": expressions}}

    model = read_vrm(edited(write_quad(tmp_path / "a.vrm"), change))
    shape = next(shape for shape in model.shapes if shape.name == "blink")
    assert sorted(model.dense(shape)[:, 2]) == [0.0] * 6 + [1.0] * 2


def test_overrides_of_1_are_read(tmp_path: Path) -> None:
    def change(told: Any) -> None:
        happy = {"overrideBlink": "block", "overrideMouth": "blend", "overrideLookAt": "none"}
        told["extensions"] = {"VRMC_vrm": {"expressions": {"preset": {"happy": happy, "aa": 7}}}}

    model = read_vrm(edited(write_quad(tmp_path / "a.vrm"), change))
    assert model.overrides == {"happy": {"blink": "block", "mouth": "blend"}}

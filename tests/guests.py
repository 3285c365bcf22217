"""Somebody else's characters, made here: files with heads that mien did not build."""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from actors import built_in
from mien.face.character import Character, KeyModels
from mien.formats.gltf.buffer import GltfBuffer
from mien.formats.gltf.glb import write_glb

Json = dict[str, Any]

DATA = Path(os.environ.get("MIEN_TEST_DATA", ""), "characters")
needs_characters = pytest.mark.skipif(
    "MIEN_TEST_DATA" not in os.environ, reason="MIEN_TEST_DATA names no characters"
)
PICKS = ("3.1", "3.3", "3.7", "3.11", "4.3", "8.3", "9.3", "8.1", "2.2", "2.3", "8.2", "2.1")
"""The twelve points a user gives: one side and the middle."""
SHAPES = (
    *("eyeBlinkLeft", "eyeBlinkRight", "mouthSmileLeft", "mouthSmileRight"),
    *("browOuterUpLeft", "browOuterUpRight", "jawOpen", "mouthPucker", "noseSneerLeft"),
)


def guest(names: Sequence[str] = SHAPES, called: Sequence[str] | None = None) -> Character:
    """The generic face with the key models ``names``, which it calls ``called``."""
    generic = built_in("generic")
    rows = [generic.keys.names.index(name) for name in names]
    keys = KeyModels(tuple(called or names), generic.keys.displacements[rows])
    return replace(generic, name="guest", keys=keys, examples=keys.names)


def write_guest(
    folder: Path,
    names: Sequence[str] = SHAPES,
    called: Sequence[str] | None = None,
    flip: float = 1.0,
    size: float = 1.0,
) -> tuple[Path, Path]:
    """A GLB of ``guest`` in metres, and a file with its twelve points, their x times ``flip``;
    all of it ``size`` times as large."""
    character = guest(names, called)
    folder.mkdir(parents=True, exist_ok=True)
    path, points = folder / "guest.glb", folder / "points.toml"
    write_glb(path, character)
    if size != 1.0:
        edited(path, lambda told: told["nodes"][1].update(scale=[size] * 3))
    scale = size / 1e3 * np.array([flip, 1.0, 1.0])
    lines = [f'"{fdp}" = {(character.face.point(fdp) * scale).tolist()}' for fdp in PICKS]
    points.write_text("[points]\n" + "\n".join(lines) + "\n")
    return path, points


def write_vrm_guest(folder: Path) -> tuple[Path, Path]:
    """The same as a VRM 1.0, whose expressions bind the morph targets."""
    path, points = write_guest(folder)
    face = next(i for i, node in enumerate(document(path)["nodes"]) if node["name"] == "face")

    def change(told: Json) -> None:
        custom = {
            name: {"morphTargetBinds": [{"node": face, "index": i, "weight": 1.0}]}
            for i, name in enumerate(SHAPES)
        }
        told["extensions"] = {
            "VRMC_vrm": {
                "humanoid": {"humanBones": {"head": {"node": face}}},
                "expressions": {"custom": custom},
            }
        }

    return edited(path, change).rename(folder / "guest.vrm"), points


def document(path: Path) -> Json:
    """The JSON of a GLB."""
    content = path.read_bytes()
    size = struct.unpack_from("<I", content, 12)[0]
    found: Json = json.loads(content[20 : 20 + size])
    return found


def edited(path: Path, change: Any) -> Path:
    """``path`` with its document changed in place by ``change``."""
    content, told = path.read_bytes(), document(path)
    size = struct.unpack_from("<I", content, 12)[0]
    change(told)
    text = json.dumps(told).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + content[20 + size :]
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
    return path


def write_quad(path: Path, targets: int = 2, **primitive: Any) -> Path:
    """A square of two triangles whose target k lifts vertex k, by hand."""
    buffer = GltfBuffer()
    places = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
    lifted = np.zeros((targets, 4, 3), np.float32)
    lifted[range(targets), range(targets), 2] = 1.0
    described: Json = {
        "attributes": {"POSITION": buffer.add(places, "vertex", bounds=True)},
        "indices": buffer.add(np.array([0, 1, 2, 0, 2, 3], np.uint16), "element"),
        "targets": [{"POSITION": buffer.add(field, "vertex", bounds=True)} for field in lifted],
    }
    told: Json = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [described | primitive]}],
    }
    path.write_bytes(buffer.glb(told))
    return path

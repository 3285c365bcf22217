"""A take as a VRM Animation (VRMC_vrm_animation 1.0): it plays on any VRM of the same expressions.

Metres, facing +z, whatever the model does. The weight of an expression is the x of its node's
translation; gaze is the turn of one node; bones stand unturned at rest.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mien.errors import InputError
from mien.face.character import Character
from mien.face.face import Array
from mien.face.overrides import for_player
from mien.formats.atomic import whole_file
from mien.formats.gltf.animated import near_quaternions
from mien.formats.gltf.buffer import GltfBuffer, Json
from mien.formats.gltf.vrm import LOOKS, PRESETS
from mien.numeric.rotation import from_gaze
from mien.performance.curves import Curves

_METRES = 1e-3
_HIPS = (0.0, 0.9, 0.0)
"""Where hips stand that nobody measured: players scale their travel by it, and they do not."""
_NAME = "VRMC_vrm_animation"


def write_vrma(path: Path, character: Character, curves: Curves) -> None:
    """Write the expressions, the head and the gaze of ``curves``. Raises InputError for a
    character that is no VRM, OutputError."""
    origin = character.origin
    if origin is None or origin.hooks.vrm is None:
        raise InputError(f"{path}: only VRM characters are animated so; {character.name} is none")
    curves = for_player(curves, character)
    buffer = GltfBuffer()
    times = buffer.add(curves.time.astype(np.float32), bounds=True)
    head = character.face.pivots["head"] * _METRES
    nodes: list[Json] = [
        {"name": "hips", "translation": list(_HIPS), "children": [1]},
        {"name": "head", "translation": [0.0, 0.6, 0.0]},
        {"name": "lookAt"},
    ]
    samplers: list[Json] = []
    channels: list[Json] = []

    def channel(node: int, way: str, values: Array) -> None:
        output = buffer.add(values.astype(np.float32))
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": node, "path": way}})

    channel(1, "rotation", near_quaternions(curves.rotation))
    channel(2, "rotation", near_quaternions(from_gaze(curves.gaze.mean(axis=1))))
    preset: Json = {}
    custom: Json = {}
    for column, key in enumerate(curves.names):
        name = origin.expressions.get(key, "")
        if not name or name in LOOKS.values():
            continue
        (preset if name in {*PRESETS.values(), "surprised"} else custom)[name] = {
            "node": len(nodes)
        }
        places = np.zeros((len(curves), 3))
        places[:, 0] = np.clip(curves.weights[:, column], 0.0, 1.0)
        nodes.append({"name": name})
        channel(len(nodes) - 1, "translation", places)
    document: Json = {
        "asset": {"version": "2.0", "generator": "mien"},
        "extensionsUsed": [_NAME],
        "extensions": {
            _NAME: {
                "specVersion": "1.0",
                "humanoid": {"humanBones": {"hips": {"node": 0}, "head": {"node": 1}}},
                "expressions": {"preset": preset, "custom": custom},
                "lookAt": {"node": 2, "offsetFromHeadBone": (-head).tolist()},
            }
        },
        "scene": 0,
        "scenes": [{"nodes": [0, *range(2, len(nodes))]}],
        "nodes": nodes,
        "animations": [{"name": "take", "samplers": samplers, "channels": channels}],
    }
    data = buffer.glb(document)
    with whole_file(path) as temporary:
        temporary.write_bytes(data)

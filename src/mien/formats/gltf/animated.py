"""A take as an animation of the file a character came from; nothing else in that file changes.

Morph targets that do not act keep the weights the file gave them. The head is turned by the node
that was found to carry it, or, in a file without one, by a new root above everything.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.face import Array
from mien.face.origin import Origin
from mien.formats.atomic import whole_file
from mien.formats.gltf.pack import glb, opened
from mien.numeric.rotation import from_gaze, to_quaternion
from mien.performance.curves import Curves

Json = dict[str, Any]

_FLOAT = 5126
_PICTURES = "KHR_texture_basisu"


def write_animated(path: Path, character: Character, curves: Curves) -> None:
    """Write the character's own file with ``curves`` as its first animation. Raises OutputError;
    ValueError where the character did not come from such a file."""
    if character.origin is None:
        raise ValueError(f"{character.name} did not come from a file that can be animated")
    take = _Take(character, character.origin, curves)
    data = take.glb()
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


class _Take:
    """One animation and the document it is put into."""

    def __init__(self, character: Character, origin: Origin, curves: Curves) -> None:
        self.character, self.origin, self.curves = character, origin, curves
        self.document, self.binary = opened(origin.glb)
        self.samplers: list[Json] = []
        self.channels: list[Json] = []
        self._times = self._add(curves.time[:, None].astype(np.float32), bounds=True)

    def glb(self) -> bytes:
        """The whole file."""
        self._weights()
        self._head()
        for side, eye in enumerate(self.origin.hooks.eyes):
            if eye is not None:
                self._turn(eye, from_gaze(self.curves.gaze[:, side]))
        animation = {"name": "take", "samplers": self.samplers, "channels": self.channels}
        self.document.setdefault("animations", []).insert(0, animation)
        self._let_open()
        buffers = self.document.setdefault("buffers", [{}])
        buffers[0]["byteLength"] = len(self.binary)
        rest = self.document.pop("buffers")[1:]
        return glb(self.document, bytes(self.binary), rest)

    def _let_open(self) -> None:
        """Let programs that show no KTX2 (Blender is one) open the rest; the pictures stay."""
        required = self.document.pop("extensionsRequired", [])
        kept = [name for name in required if name != _PICTURES]
        self.document |= {"extensionsRequired": kept} if kept else {}

    def _weights(self) -> None:
        """A channel for every node with a mesh that a key model drives."""
        driven: dict[int, dict[int, Array]] = {}
        for column, name in enumerate(self.curves.names):
            for bind in self.origin.binds.get(name, ()):
                rows = driven.setdefault(bind.mesh, {})
                step = bind.weight * self.curves.weights[:, column]
                rows[bind.target] = rows.get(bind.target, 0.0) + step
        for index, node in enumerate(self.document.get("nodes", [])):
            if node.get("mesh") not in driven:
                continue
            mesh = self.document["meshes"][node["mesh"]]
            count = len(mesh["primitives"][0].get("targets", []))
            rest = node.get("weights", mesh.get("weights"))
            rest = rest if isinstance(rest, list) and len(rest) == count else [0.0] * count
            weights = np.tile(np.asarray(rest, dtype=float), (len(self.curves), 1))
            for target, values in driven[node["mesh"]].items():
                weights[:, target] = values
            self._channel(index, "weights", weights.reshape(-1, 1))

    def _head(self) -> None:
        head = self.origin.hooks.head
        if head is not None:
            self._turn(head, self.curves.rotation, self.character.face.pivots["head"])
        elif not self.document.get("skins"):
            self._root()

    def _root(self) -> None:
        """A new node above all that is shown, which turns about the neck."""
        scene = self.document["scenes"][self.document.get("scene", 0)]
        nodes = self.document["nodes"]
        pivot = self._in_file(self.character.face.pivots["head"])
        nodes.append({"name": "still", "children": scene["nodes"], "translation": _floats(-pivot)})
        nodes.append(
            {"name": "mien head", "children": [len(nodes) - 1], "translation": _floats(pivot)}
        )
        scene["nodes"] = [len(nodes) - 1]
        moved = self.curves.translation @ self.origin.turn.T / self.origin.scale
        turned = self.origin.turn @ self.curves.rotation @ self.origin.turn.T
        self._channel(len(nodes) - 1, "rotation", near_quaternions(turned))
        if moved.any():
            self._channel(len(nodes) - 1, "translation", pivot + moved)

    def _turn(self, node: int, rotations: Array, pivot: Array | None = None) -> None:
        """Turn a node by ``rotations`` (F, 3, 3) of the head frame, about ``pivot`` (3,) mm where
        the node's own origin is not what it turns about."""
        world = self._world()
        above = world[self._parents().get(node, -1)]
        turn = self.origin.turn
        turned = turn @ rotations @ turn.T
        parent = _unscaled(above)
        local = parent.T @ turned @ _unscaled(world[node])
        self._channel(node, "rotation", near_quaternions(local))
        if pivot is not None and not self._is_joint(node):
            centre = self._in_file(pivot)
            places = centre + np.einsum("fij,j->fi", turned, world[node][:3, 3] - centre)
            inverse = np.linalg.inv(above)
            self._channel(node, "translation", places @ inverse[:3, :3].T + inverse[:3, 3])

    def _is_joint(self, node: int) -> bool:
        return any(node in skin.get("joints", []) for skin in self.document.get("skins", []))

    def _in_file(self, place: Array) -> Array:
        return np.asarray(self.origin.turn @ place / self.origin.scale + self.origin.centre)

    def _parents(self) -> dict[int, int]:
        return {
            child: i
            for i, node in enumerate(self.document.get("nodes", []))
            for child in node.get("children", [])
        }

    def _world(self) -> dict[int, Array]:
        """(4, 4) world_from_node of every node, and of nothing above all (-1)."""
        nodes, parents = self.document["nodes"], self._parents()
        world: dict[int, Array] = {-1: np.eye(4)}
        for start in range(len(nodes)):
            path = [start]
            while path[-1] not in world:
                path.append(parents.get(path[-1], -1))
            for node, above in zip(path[-2::-1], path[:0:-1], strict=True):
                world[node] = world[above] @ _local(nodes[node])
        return world

    def _channel(self, node: int, path: str, values: Array) -> None:
        described = self.document["nodes"][node]
        if "matrix" in described:
            described.update(_taken_apart(described.pop("matrix")))
        output = self._add(values.astype(np.float32))
        self.samplers.append({"input": self._times, "output": output, "interpolation": "LINEAR"})
        target = {"node": node, "path": path}
        self.channels.append({"sampler": len(self.samplers) - 1, "target": target})

    def _add(self, values: NDArray[np.float32], *, bounds: bool = False) -> int:
        """Index of a new accessor of ``values`` (N, 1..4)."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        content = np.ascontiguousarray(values, "<f4").tobytes()
        views = self.document.setdefault("bufferViews", [])
        views.append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)})
        self.binary += content
        accessor: Json = {
            "bufferView": len(views) - 1,
            "componentType": _FLOAT,
            "count": len(values),
            "type": {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[values.shape[1]],
        }
        if bounds:
            accessor |= {"min": [float(values.min())], "max": [float(values.max())]}
        accessors = self.document.setdefault("accessors", [])
        accessors.append(accessor)
        return len(accessors) - 1


def near_quaternions(rotations: Array) -> Array:
    """(F, 4) of rotations (F, 3, 3), with the signs that make neighbours near: players
    interpolate them as they are."""
    quaternions = to_quaternion(rotations)
    turned = (quaternions[1:] * quaternions[:-1]).sum(axis=1) < 0.0
    signs = np.cumprod(np.concatenate([[1.0], np.where(turned, -1.0, 1.0)]))
    return np.asarray(quaternions * signs[:, None])


def _local(node: Json) -> Array:
    if "matrix" in node:
        return np.array(node["matrix"], dtype=float).reshape(4, 4).T
    x, y, z, w = np.array(node.get("rotation", [0, 0, 0, 1]), dtype=float)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3] = turn * np.array(node.get("scale", [1, 1, 1]), dtype=float)
    matrix[:3, 3] = node.get("translation", [0, 0, 0])
    return matrix


def _unscaled(matrix: Array) -> Array:
    """(3, 3) the rotation nearest to a transform's."""
    u, _, v = np.linalg.svd(matrix[:3, :3])
    return np.asarray(u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v)


def _taken_apart(values: list[float]) -> Json:
    """Translation, rotation and scale of a node's matrix: only such can be animated."""
    matrix = np.array(values, dtype=float).reshape(4, 4).T
    turn = _unscaled(matrix)
    return {
        "translation": _floats(matrix[:3, 3]),
        "rotation": _floats(to_quaternion(turn[None])[0]),
        "scale": _floats(np.diag(turn.T @ matrix[:3, :3])),
    }


def _floats(values: Array) -> list[float]:
    return [float(value) for value in values]

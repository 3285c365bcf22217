"""An independent reader of GLB files: pygltflib for the container, numpy for the rest."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pygltflib
from numpy.typing import NDArray

Array = NDArray[np.float64]
_DTYPES = {5121: "<u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Reader:
    def __init__(self, path: Path) -> None:
        self.gltf = pygltflib.GLTF2().load_binary(str(path))
        self.blob = self.gltf.binary_blob()

    def _raw(self, view: int, offset: int | None, kind: int, shape: tuple[int, int]) -> Any:
        start = self.gltf.bufferViews[view].byteOffset + (offset or 0)
        values = np.frombuffer(self.blob, _DTYPES[kind], shape[0] * shape[1], start)
        return values.reshape(shape)

    def accessor(self, index: int) -> Array:
        a = self.gltf.accessors[index]
        shape = (a.count, _COLUMNS[a.type])
        values = np.zeros(shape)
        if a.bufferView is not None:
            values[:] = self._raw(a.bufferView, a.byteOffset, a.componentType, shape)
        if a.sparse is not None:
            s = a.sparse
            i, v = s.indices, s.values
            rows = self._raw(i.bufferView, i.byteOffset, i.componentType, (s.count, 1))[:, 0]
            values[rows] = self._raw(
                v.bufferView, v.byteOffset, a.componentType, (s.count, shape[1])
            )
        return values

    def node(self, name: str) -> int:
        return next(i for i, node in enumerate(self.gltf.nodes) if node.name == name)

    def target_names(self, name: str = "face") -> list[str]:
        mesh = self.gltf.meshes[self.gltf.nodes[self.node(name)].mesh]
        return list(mesh.extras["targetNames"])

    def channels(self) -> dict[tuple[str, str], tuple[Array, Array]]:
        """(times, values) by node name and path."""
        (animation,) = self.gltf.animations
        found = {}
        for channel in animation.channels:
            sampler = animation.samplers[channel.sampler]
            key = (self.gltf.nodes[channel.target.node].name, channel.target.path)
            found[key] = (self.accessor(sampler.input)[:, 0], self.accessor(sampler.output))
        return found

    def world(self, frame: int | None) -> dict[str, Array]:
        """World positions (N, 3) in mm of every mesh node at a frame of the animation."""
        channels = {} if frame is None else self.channels()
        posed: dict[str, Array] = {}

        def visit(index: int, world_from_parent: Array) -> None:
            node = self.gltf.nodes[index]
            shift, turn = node.translation or [0, 0, 0], node.rotation or [0, 0, 0, 1]
            if (node.name, "translation") in channels:
                shift = channels[node.name, "translation"][1][frame]
            if (node.name, "rotation") in channels:
                turn = channels[node.name, "rotation"][1][frame]
            local = np.eye(4)
            local[:3, :3], local[:3, 3] = _matrix(turn), shift
            world = world_from_parent @ local
            if node.mesh is not None:
                weights = np.zeros(0)
                if (node.name, "weights") in channels:
                    values = channels[node.name, "weights"][1]
                    weights = values.reshape(len(channels[node.name, "weights"][0]), -1)[frame]
                places = self._places(node.mesh, weights)
                posed[node.name] = 1e3 * (places @ world[:3, :3].T + world[:3, 3])
            for child in node.children or []:
                visit(child, world)

        for root in self.gltf.scenes[0].nodes:
            visit(root, np.eye(4))
        return posed

    def _places(self, mesh: int, weights: Array) -> Array:
        places = []
        for primitive in self.gltf.meshes[mesh].primitives:
            place = self.accessor(primitive.attributes.POSITION)
            for weight, target in zip(weights, primitive.targets or [], strict=False):
                place = place + weight * self.accessor(target["POSITION"])
            places.append(place)
        return np.concatenate(places)


def _matrix(quaternion: Any) -> Array:
    x, y, z, w = np.asarray(quaternion, dtype=float)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )

"""Somebody's file with morph targets added to it; nothing else in that file changes.

Textures, materials, bones and other meshes stay as they are. A mesh that nothing moves gets no
targets. Takes of a mesh that got some are left out: they have no weights for the new ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.face import Array
from mien.face.model import Model
from mien.formats.atomic import whole_file
from mien.formats.gltf.accessors import Accessors
from mien.formats.gltf.container import Container, Json
from mien.formats.gltf.nodes import read_nodes
from mien.formats.gltf.pack import glb, opened

_FLOAT, _UINT32 = 5126, 5125
_STILL = 1e-6
"""Part of the farthest motion under which a vertex is not worth storing."""
_LOOSE = 1e-4
"""Part of a primitive's size by which its vertices may miss one way from file to world."""


def write_grown(
    path: Path, model: Model, names: Sequence[str], fields: NDArray[np.float32]
) -> None:
    """Write the model's own file with morph targets ``names`` (K) that move its vertices by
    ``fields`` (K, V, 3), in the file's world and unit. Raises OutputError; InputError where a mesh
    is so bent by its bones that its targets cannot be told; ValueError where the model did not come
    from such a file."""
    if model.source is None:
        raise ValueError(f"{model.name} did not come from a file that can hold morph targets")
    data = _Growth(model, names, fields).glb()
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


class _Growth:
    """A document on its way to one with more morph targets."""

    def __init__(self, model: Model, names: Sequence[str], fields: NDArray[np.float32]) -> None:
        self.document, self.binary = opened(model.source or b"")
        container = Container(Path(model.name), self.document, (bytes(self.binary),))
        self._accessors = Accessors(container)
        self._world = read_nodes(container).world
        self._names = list(names)
        self._still: dict[int, int] = {}
        self._least = _STILL * float(np.abs(fields).max(initial=0.0))
        self._moved: dict[tuple[int, int], Array] = {}
        first = 0
        for part in model.parts:
            run = fields[:, first : first + len(part.vertices)]
            first += len(part.vertices)
            if part.node is not None and run.any():
                place = self.document["nodes"][part.node]["mesh"], part.primitive
                inverse = self._file_from_world(part.node, place, part.vertices)
                self._moved.setdefault(place, run @ inverse.T)

    def glb(self) -> bytes:
        """The whole file."""
        grown = sorted({mesh for mesh, _ in self._moved})
        for mesh in grown:
            self._grow(mesh)
        for node in self.document["nodes"]:
            if node.get("mesh") in grown and "weights" in node:
                node["weights"] = [*node["weights"], *[0.0] * len(self._names)]
        self._drop_takes(set(grown))
        rest = self.document.pop("buffers")[1:]
        return glb(self.document, bytes(self.binary), rest)

    def _grow(self, index: int) -> None:
        mesh = self.document["meshes"][index]
        before = len(mesh["primitives"][0].get("targets", []))
        for number, primitive in enumerate(mesh["primitives"]):
            count = self._accessors.count(primitive["attributes"]["POSITION"])
            moved = self._moved.get((index, number), np.zeros((len(self._names), count, 3)))
            targets = primitive.setdefault("targets", [])
            targets += [{"POSITION": self._sparse(field)} for field in moved]
        named = self._target_names(mesh, before)
        mesh.setdefault("extras", {})["targetNames"] = [*named, *self._names]
        rest = mesh.get("weights", [0.0] * before)
        mesh["weights"] = [*rest, *[0.0] * len(self._names)]

    def _target_names(self, mesh: Json, count: int) -> list[str]:
        """(count) of the targets that were there; some exporters name them on the primitive."""
        for place in (mesh, *mesh["primitives"]):
            extras = place.get("extras")
            if isinstance(extras, dict) and isinstance(extras.get("targetNames"), list):
                listed = extras.pop("targetNames")[:count]
                return [*map(str, listed), *[""] * (count - len(listed))]
        return [""] * count

    def _file_from_world(self, node: int, place: tuple[int, int], world: Array) -> Array:
        """(3, 3) of a primitive's displacements."""
        if "skin" not in self.document["nodes"][node]:
            return np.asarray(np.linalg.inv(self._world[node][:3, :3]))
        primitive = self.document["meshes"][place[0]]["primitives"][place[1]]
        own = self._accessors.read(primitive["attributes"]["POSITION"], 3).astype(float)
        middle, size = own.mean(axis=0), float(np.ptp(world, axis=0).max())
        way = np.linalg.lstsq(own - middle, world - world.mean(axis=0), rcond=None)[0]
        missed = np.abs((own - middle) @ way - (world - world.mean(axis=0))).max()
        if missed > _LOOSE * size:
            raise InputError(
                "the neutral's mesh is bent by its bones; export it in its rest pose, or make an "
                ".npz character"
            )
        return np.asarray(np.linalg.inv(way.T))

    def _drop_takes(self, meshes: set[int]) -> None:
        """Leave out animations of weights that are no longer as many."""
        nodes, kept = self.document["nodes"], []
        for animation in self.document.get("animations", []):
            animation["channels"] = [
                channel
                for channel in animation["channels"]
                if channel["target"].get("path") != "weights"
                or nodes[channel["target"].get("node", 0)].get("mesh") not in meshes
            ]
            if animation["channels"]:
                kept.append(animation)
        self.document.pop("animations", None)
        if kept:
            self.document["animations"] = kept

    def _sparse(self, field: Array) -> int:
        """Index of a new accessor of a displacement field (N, 3)."""
        values = field.astype("<f4")
        rows = np.flatnonzero(np.abs(values).max(axis=1, initial=0.0) > self._least)
        if not len(rows):
            return self._nothing(len(values))
        stored = values[rows]
        span = stored if len(rows) == len(values) else np.vstack([stored, np.zeros((1, 3))])
        return self._append(
            len(values),
            span,
            {
                "count": len(rows),
                "indices": self._view(rows.astype("<u4")) | {"componentType": _UINT32},
                "values": self._view(stored),
            },
        )

    def _nothing(self, count: int) -> int:
        if count not in self._still:
            self._still[count] = self._append(count, np.zeros((1, 3)), None)
        return self._still[count]

    def _append(self, count: int, span: NDArray[Any], sparse: Json | None) -> int:
        accessor: Json = {
            "componentType": _FLOAT,
            "count": count,
            "type": "VEC3",
            "min": span.min(axis=0).tolist(),
            "max": span.max(axis=0).tolist(),
        }
        self.document["accessors"].append(accessor | ({"sparse": sparse} if sparse else {}))
        return len(self.document["accessors"]) - 1

    def _view(self, values: NDArray[Any]) -> Json:
        self.binary += b"\0" * (-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": values.nbytes}
        self.document["bufferViews"].append(view)
        self.binary += values.tobytes()
        return {"bufferView": len(self.document["bufferViews"]) - 1}

"""Eyeballs that share a mesh, taken apart into two nodes that can turn.

Their triangles go into meshes of their own, on the same vertices; everything else stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array
from mien.face.model import Model
from mien.formats.gltf.accessors import Accessors
from mien.formats.gltf.container import Container, Json
from mien.formats.gltf.nodes import read_nodes
from mien.formats.gltf.pack import glb, opened

_WHOLE = 0.99
"""Weight of a joint from which a vertex hangs on it alone."""
_ELEMENT, _UINT32 = 34963, 5125

Mask = NDArray[np.bool_]


def with_eye_nodes(model: Model, balls: Sequence[Mask], centres: Sequence[Array]) -> Model:
    """``model`` with a node for each of two eyeballs, whose vertices are ``balls`` (V,) and which
    turn about ``centres`` (3,), in the file's world. The model as it is where shapes move them,
    where they are shown twice, or where they hang on several joints."""
    both = balls[0] | balls[1]
    if model.source is None or any(model.dense(shape)[both].any() for shape in model.shapes):
        return model
    work = _Parting(model)
    left, right = (work.pieces(ball) for ball in balls)
    if not left or not right:
        return model
    nodes = (
        work.hang("eye_left", left, centres[0]),
        work.hang("eye_right", right, centres[1]),
    )
    return replace(model, source=work.glb(), hooks=replace(model.hooks, eyes=nodes))


@dataclass(frozen=True, slots=True)
class _Piece:
    """What one primitive shows of an eyeball."""

    part: int
    node: int
    """What it follows: its own node, or the joint all of it hangs on."""
    own: Mask
    """(N,) vertices of the primitive that belong to the eyeball."""
    placed: Array
    """(4, 4) world from its vertices."""


class _Parting:
    """A document on its way to one with two eyes."""

    def __init__(self, model: Model) -> None:
        self.document, self.binary = opened(model.source or b"")
        container = Container(Path(model.name), self.document, (bytes(self.binary),))
        self._accessors = Accessors(container)
        self._world = read_nodes(container).world
        self._parts = model.parts
        self._emptied: list[Json] = []
        self._triangles: dict[int, NDArray[Any]] = {}
        self._meshes = len(container.listed("meshes"))

    def pieces(self, ball: Mask) -> list[_Piece] | None:
        """The pieces of an eyeball (V,); None where one cannot be taken away."""
        first, found = 0, []
        nodes = self.document["nodes"]
        shown = [node.get("mesh") for node in nodes]
        for number, part in enumerate(self._parts):
            own = ball[first : first + len(part.vertices)]
            first += len(part.vertices)
            if not own.any() or not own[self._corners(number)].all(axis=1).any():
                continue
            if part.node is None or shown.count(shown[part.node]) > 1:
                return None
            followed = self._followed(number, own)
            if followed is None:
                return None
            self._triangles.setdefault(number, self._corners(number))
            found.append(_Piece(number, followed[0], own, followed[1]))
        return found

    def _followed(self, number: int, own: Mask) -> tuple[int, Array] | None:
        """The node that the vertices ``own`` of a part follow, and world from vertices."""
        part = self._parts[number]
        node, attributes = self.document["nodes"][part.node], self._primitive(number)["attributes"]
        if "skin" not in node or "JOINTS_0" not in attributes:
            return part.node or 0, self._world[part.node or 0]
        skin = self.document["skins"][node["skin"]]
        share = self._accessors.read(attributes["WEIGHTS_0"], 4)[own]
        which = self._accessors.read(attributes["JOINTS_0"], 4)[own]
        main = np.take_along_axis(which, share.argmax(axis=1)[:, None], axis=1)
        if share.max(axis=1).min() < _WHOLE or np.ptp(main):
            return None
        row, inverse = int(main[0, 0]), np.eye(4)
        if "inverseBindMatrices" in skin:
            read = self._accessors.read(skin["inverseBindMatrices"], 16)
            inverse = read[row].reshape(4, 4).T.astype(float)
        joint = skin["joints"][row]
        return joint, self._world[joint] @ inverse

    def hang(self, name: str, pieces: Sequence[_Piece], centre: Array) -> int:
        """Hang an eyeball on a node of its own at ``centre`` (3,); its number."""
        above = pieces[0].node
        place = np.eye(4)
        place[:3, 3] = (np.linalg.inv(self._world[above]) @ [*centre, 1.0])[:3]
        pivot = self._append("nodes", {"name": name, "translation": place[:3, 3].tolist()})
        self.document["nodes"][above].setdefault("children", []).append(pivot)
        world = self._world[above] @ place
        holders = []
        for piece in pieces:
            matrix = np.linalg.inv(world) @ piece.placed
            holder = {"name": f"{name} mesh", "mesh": self._parted(piece, name)}
            holders.append(self._append("nodes", holder | _placed(matrix)))
        self.document["nodes"][pivot]["children"] = holders
        return pivot

    def _parted(self, piece: _Piece, name: str) -> int:
        """A mesh of the triangles of a piece, which its primitive loses; its number."""
        primitive = self._primitive(piece.part)
        triangles = self._triangles[piece.part]
        inside = piece.own[triangles].all(axis=1)
        shown = {
            "attributes": {
                kind: accessor
                for kind, accessor in primitive["attributes"].items()
                if not kind.startswith(("JOINTS_", "WEIGHTS_"))
            },
            "indices": self._indices(triangles[inside]),
        }
        shown |= {"material": primitive["material"]} if "material" in primitive else {}
        self._triangles[piece.part] = triangles[~inside]
        if inside.all():
            self._emptied.append(primitive)
        else:
            primitive["indices"] = self._indices(triangles[~inside])
        return self._append("meshes", {"name": name, "primitives": [shown]})

    def glb(self) -> bytes:
        """The whole file, without meshes that show nothing any more."""
        meshes, nodes = self.document["meshes"], self.document["nodes"]
        for number in range(self._meshes):
            kept = [
                p for p in meshes[number]["primitives"] if not any(p is e for e in self._emptied)
            ]
            if kept:
                meshes[number]["primitives"] = kept
                continue
            for node in nodes:
                if node.get("mesh") == number:
                    for key in ("mesh", "skin", "weights"):
                        node.pop(key, None)
            # The last mesh, which is ours, takes its number: others keep theirs.
            meshes[number] = meshes.pop()
            for node in nodes:
                if node.get("mesh") == len(meshes):
                    node["mesh"] = number
        return glb(self.document, bytes(self.binary), self.document["buffers"][1:])

    def _primitive(self, number: int) -> Json:
        part = self._parts[number]
        mesh = self.document["meshes"][self.document["nodes"][part.node]["mesh"]]
        found: Json = mesh["primitives"][part.primitive]
        return found

    def _corners(self, number: int) -> NDArray[Any]:
        """(T, 3) triangles of a part, as the file has them."""
        primitive = self._primitive(number)
        if "indices" in primitive:
            return self._accessors.read(primitive["indices"], 1).reshape(-1, 3)
        return np.arange(len(self._parts[number].vertices)).reshape(-1, 3)

    def _indices(self, triangles: NDArray[Any]) -> int:
        """Number of a new accessor of ``triangles`` (T, 3)."""
        self.binary += b"\0" * (-len(self.binary) % 4)
        content = triangles.astype("<u4").tobytes()
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        self.binary += content
        self.document["buffers"][0]["byteLength"] = len(self.binary)
        number = self._append("bufferViews", view | {"target": _ELEMENT})
        accessor = {"bufferView": number, "componentType": _UINT32, "type": "SCALAR"}
        return self._append("accessors", accessor | {"count": triangles.size})

    def _append(self, name: str, item: Json) -> int:
        self.document[name].append(item)
        return len(self.document[name]) - 1


def _placed(matrix: Array) -> Json:
    """What places a node: a shift, where it is no more than that."""
    if np.allclose(matrix[:3, :3], np.eye(3), atol=1e-6):
        return {"translation": matrix[:3, 3].tolist()}
    return {"matrix": matrix.T.ravel().tolist()}

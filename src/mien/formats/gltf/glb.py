"""A character, still or acting, as one GLB file for Blender, the web and games.

    <character>             metres, +Y up, +Z out of the face, +X to the subject's left; travels
      head                  turns about the neck
        face                every part that a morph target moves, with all morph targets
        eye_left, eye_right turn about their centres
        hair, ear_left ...  what no target moves
      bust ...              what the head does not carry

Morph targets are sparse accessors; their names stand in ``mesh.extras.targetNames``, where
Blender, three.js and the VRM tools look for them.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.face import FOLLOWS, Array, Face, Material, Part
from mien.face.targets import targets
from mien.formats.atomic import whole_file
from mien.formats.gltf.buffer import GltfBuffer, Json
from mien.numeric.normals import vertex_normals
from mien.numeric.rotation import from_gaze, to_quaternion
from mien.performance.curves import Curves

_METRES = 1e-3
_MOVED = 0.04
"""mm under which a vertex is not worth storing in a morph target."""
_TILTED = 0.04
"""The same for the change of a unit normal."""
_OCCLUDED = 0.6
"""Share of the baked occlusion that goes into the vertex colours: viewers add light of their own
that knows none, and all of it looks dirty."""

_WHITE_PIXEL = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR42mP4DwABAQEAHLCMmQAAAABJRU5ErkJggg=="
)
"""A PNG of 67 bytes."""


def write_glb(
    path: Path,
    character: Character,
    curves: Curves | None = None,
    names: tuple[str, ...] | None = None,
) -> None:
    """Write ``character`` to ``path``, with one animation where ``curves`` are given.

    With curves the morph targets are those the curves name; a performer who never travels gets
    no channel for it. Without, they are those of ``names``; without either, the key models as
    sculpted, and the face brings its texture coordinates and a white picture for an artist to
    replace. Raises OutputError; ValueError where a target is named that the character has not.
    """
    scene = _laid_out(character, names if curves is None else curves.names)
    buffer = scene.buffer.branch()
    document: Json = {
        "asset": {"version": "2.0", "generator": "mien"},
        "scene": 0,
        "scenes": [{"name": character.name, "nodes": [scene.carriers["body"]]}],
        "nodes": scene.nodes,
        "meshes": scene.meshes,
        "materials": scene.materials,
    }
    if scene.textured:
        document |= _blank_texture(buffer)
    if curves is not None:
        document["animations"] = [_animation(scene, buffer, curves)]
    data = buffer.glb(document)
    with whole_file(path) as temporary:
        temporary.write_bytes(data)


@lru_cache(maxsize=8)
def _laid_out(character: Character, names: tuple[str, ...] | None) -> _Scene:
    """All of a character's file but the take; kept, for takes come one after another."""
    textured = names is None and character.face.uv is not None
    scene = _Scene(character.face, *_targets(character, names), textured)
    scene.build(character.name)
    return scene


def _targets(
    character: Character, names: tuple[str, ...] | None
) -> tuple[tuple[str, ...], NDArray[np.float32]]:
    """Names (W) and displacement fields (W, V, 3) of the morph targets to write."""
    if names is None:
        return character.keys.names, character.keys.displacements
    chosen = targets(character, names)
    return chosen.names, chosen.displacements


@dataclass(frozen=True, slots=True)
class _Group:
    """Parts that become one mesh."""

    name: str
    carrier: str
    parts: tuple[Part, ...]
    targets: NDArray[np.intp]
    """Rows of the morph targets that move it."""


def _groups(face: Face, fields: NDArray[np.float32]) -> list[_Group]:
    groups = []
    for carrier in FOLLOWS:
        parts = [part for part in face.parts if part.follows == carrier]
        moves = {part.name: fields[:, part.first : part.last].any(axis=(1, 2)) for part in parts}
        together = [part for part in parts if carrier.startswith("eye") or moves[part.name].any()]
        if together:
            which = np.flatnonzero(np.any([moves[part.name] for part in together], axis=0))
            name = "face" if carrier == "head" else carrier
            groups.append(_Group(name, carrier, tuple(together), which))
        groups += [
            _Group(part.name, carrier, (part,), np.zeros(0, dtype=np.intp))
            for part in parts
            if part not in together
        ]
    return groups


class _Scene:
    """Nodes, meshes and materials of one face, and where its morphing meshes hang."""

    def __init__(
        self, face: Face, names: tuple[str, ...], fields: NDArray[np.float32], textured: bool
    ) -> None:
        self.face, self.names, self.fields, self.textured = face, names, fields, textured
        self.buffer = GltfBuffer()
        self.nodes: list[Json] = []
        self.meshes: list[Json] = []
        used = [name for name in face.materials if _wearing(face, name)]
        self.materials = [_material(face, name, textured) for name in used]
        self.carriers: dict[str, int] = {}
        self.morphing: list[tuple[int, _Group]] = []
        self._zeros: dict[int, int] = {}
        self._material_index = {name: i for i, name in enumerate(used)}

    def build(self, name: str) -> None:
        """Fill the scene."""
        pivots = self.face.pivots
        head, root = self._node("head", pivots["head"]), self._node(name)
        self.carriers = {"head": head, "body": root}
        self._adopt(root, head)
        for eye in ("eye_left", "eye_right"):
            self.carriers[eye] = self._node(eye, pivots[eye] - pivots["head"])
            self._adopt(head, self.carriers[eye])
        for group in _groups(self.face, self.fields):
            carrier = self.carriers[group.carrier]
            node = carrier if group.name == group.carrier else self._node(group.name)
            if node != carrier:
                self._adopt(carrier, node)
            self.nodes[node]["mesh"] = self._mesh(group)
            if len(group.targets):
                self.morphing.append((node, group))

    def _node(self, name: str, place: Array | None = None) -> int:
        node: Json = {"name": name}
        if place is not None:
            node["translation"] = (place * _METRES).tolist()
        self.nodes.append(node)
        return len(self.nodes) - 1

    def _adopt(self, parent: int, child: int) -> None:
        self.nodes[parent].setdefault("children", []).append(child)

    def _mesh(self, group: _Group) -> int:
        origin = np.zeros(3) if group.carrier == "body" else self.face.pivots[group.carrier]
        kinds = list(dict.fromkeys(part.material for part in group.parts))
        mesh: Json = {
            "name": group.name,
            "primitives": [
                self._primitive([p for p in group.parts if p.material == kind], group, origin)
                for kind in kinds
            ],
        }
        if len(group.targets):
            mesh["weights"] = [0.0] * len(group.targets)
            mesh["extras"] = {"targetNames": [self.names[row] for row in group.targets]}
        self.meshes.append(mesh)
        return len(self.meshes) - 1

    def _primitive(self, parts: list[Part], group: _Group, origin: Array) -> Json:
        face, add = self.face, self.buffer.add
        rows = np.concatenate([np.arange(part.first, part.last) for part in parts])
        local = np.zeros(len(face.vertices), dtype=np.int32)
        local[rows] = np.arange(len(rows), dtype=np.int32)
        triangles = local[np.concatenate([part.triangles for part in parts])]
        places = face.vertices[rows]
        normals = _normals(places, triangles)
        index = np.uint16 if len(rows) < 65535 else np.uint32
        primitive: Json = {
            "attributes": {
                "POSITION": add(_metres(places - origin), "vertex", bounds=True),
                "NORMAL": add(normals.astype(np.float32), "vertex"),
                "COLOR_0": add(_colours(face, rows), "vertex", normalized=True),
            },
            "indices": add(triangles.ravel().astype(index), "element"),
            "material": self._material_index[parts[0].material],
        }
        if self.textured and face.uv is not None:
            uv = np.round(np.clip(face.uv[rows], 0.0, 1.0) * 65535).astype(np.uint16)
            primitive["attributes"]["TEXCOORD_0"] = add(uv, "vertex", normalized=True)
        if len(group.targets):
            primitive["targets"] = [
                self._target(places, self.fields[row, rows], triangles, normals)
                for row in group.targets
            ]
        return primitive

    def _still(self, count: int) -> int:
        """The shared accessor of a target that leaves a primitive of ``count`` vertices alone."""
        if count not in self._zeros:
            still = np.zeros((count, 3), dtype=np.float32)
            self._zeros[count] = self.buffer.add_sparse(still, 0.0, bounds=True)
        return self._zeros[count]

    def _target(
        self,
        places: Array,
        field: NDArray[np.float32],
        triangles: NDArray[np.int32],
        normals: Array,
    ) -> Json:
        if not field.any():
            return dict.fromkeys(("POSITION", "NORMAL"), self._still(len(field)))
        change = _normals(places + field, triangles) - normals
        sparse = self.buffer.add_sparse
        return {
            "POSITION": sparse(_metres(field), _MOVED * _METRES, bounds=True),
            "NORMAL": sparse(change.astype(np.float32), _TILTED),
        }


def _normals(places: Array, triangles: NDArray[np.int32]) -> Array:
    """Unit normals everywhere: glTF wants them even of a vertex whose triangles have no area."""
    normals = vertex_normals(places, triangles)
    normals[~normals.any(axis=1)] = (0.0, 0.0, 1.0)
    return normals


def _metres(places: Array | NDArray[np.float32]) -> NDArray[np.float32]:
    return np.asarray(places * _METRES, dtype=np.float32)


def _colours(face: Face, rows: NDArray[np.intp]) -> NDArray[np.uint16]:
    """(N, 4) linear RGBA. 16 bits: eight of linear light show steps in dark hair."""
    light = 1.0 - _OCCLUDED * (1.0 - face.occlusion[rows, None])
    colours = np.clip(face.colours[rows] * light, 0.0, 1.0)
    opaque = np.concatenate([colours, np.ones((len(rows), 1))], axis=1)
    return np.round(opaque * 65535).astype(np.uint16)


def _wearing(face: Face, material: str) -> list[Part]:
    return [part for part in face.parts if part.material == material]


def _material(face: Face, name: str, textured: bool) -> Json:
    material: Material = face.materials[name]
    described: Json = {
        "name": name,
        "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": material.roughness},
        # Locks of hair, lashes and collars are open sheets.
        "doubleSided": True,
    }
    if textured:
        described["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    if material.emission:
        parts = _wearing(face, name)
        colours = np.concatenate([face.colours[part.first : part.last] for part in parts])
        glow = np.clip(material.emission * colours.mean(axis=0), 0.0, 1.0)
        described["emissiveFactor"] = glow.tolist()
    return described


def _blank_texture(buffer: GltfBuffer) -> Json:
    """What a document needs for one white pixel as texture 0."""
    image = {"bufferView": buffer.add_image(_WHITE_PIXEL), "mimeType": "image/png"}
    return {"images": [image], "samplers": [{}], "textures": [{"source": 0, "sampler": 0}]}


def _animation(scene: _Scene, buffer: GltfBuffer, curves: Curves) -> Json:
    """One animation: weights of each morphing mesh, head and eyes, at the take's own times."""
    add = buffer.add
    times = add(curves.time.astype(np.float32), bounds=True)
    samplers: list[Json] = []
    channels: list[Json] = []

    def channel(node: int, path: str, output: int) -> None:
        samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
        target = {"node": node, "path": path}
        channels.append({"sampler": len(samplers) - 1, "target": target})

    for node, group in scene.morphing:
        weights = curves.weights[:, group.targets].astype(np.float32)
        channel(node, "weights", add(weights.ravel()))
    channel(scene.carriers["head"], "rotation", add(_quaternions(curves.rotation)))
    if curves.translation.any():
        channel(scene.carriers["body"], "translation", add(_metres(curves.translation)))
    for side, eye in enumerate(("eye_left", "eye_right")):
        turns = _quaternions(from_gaze(curves.gaze[:, side]))
        channel(scene.carriers[eye], "rotation", add(turns))
    return {"name": "take", "samplers": samplers, "channels": channels}


def _quaternions(rotations: Array) -> NDArray[np.float32]:
    """(F, 4) with the signs that make neighbours near: players interpolate them as they are."""
    quaternions = to_quaternion(rotations)
    turned = (quaternions[1:] * quaternions[:-1]).sum(axis=1) < 0.0
    signs = np.cumprod(np.concatenate([[1.0], np.where(turned, -1.0, 1.0)]))
    return (quaternions * signs[:, None]).astype(np.float32)

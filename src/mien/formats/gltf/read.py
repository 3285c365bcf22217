"""A character from glTF, GLB or VRM: all its meshes placed, all its morph targets by name.

Neutral is every weight at zero, whatever the file's default weights say. Nothing in the file is
believed: counts are bounded before memory is asked for, and what is mended is noted.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array
from mien.face.model import Bind, Model, ModelPart, Shape
from mien.formats.gltf.accessors import Accessors
from mien.formats.gltf.colours import Paint
from mien.formats.gltf.container import MESHOPT, Container, Json, open_gltf
from mien.formats.gltf.nodes import Nodes, find_hooks, joint_place, read_nodes
from mien.formats.gltf.pack import packed
from mien.formats.gltf.plain import plain

MAX_DISPLACEMENTS = 25_000_000
"""Morph targets times vertices, all meshes together: what memory is asked for."""
_MAX_VERTICES, _MAX_TARGETS = 4_000_000, 20_000
_FARTHEST = 1e7
_KNOWN = (
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_texture_basisu",
    "KHR_materials_",
    "KHR_lights_",
    "KHR_xmp",
    "EXT_texture_",
    "VRM",
    "KHR_draco_mesh_compression",
    *MESHOPT,
)
_TRIANGLES = 4


def read_gltf(path: Path | str) -> Model:
    """Read a character. Raises InputError where there is no file, FormatError where it is broken
    or larger than any character, MissingExtraError where it is compressed with Draco and the extra
    is not there."""
    container = open_gltf(Path(path))
    _require_known(container)
    container = plain(container)
    reading = _Reading(container, read_nodes(container))
    reading.read()
    if not reading.parts:
        raise container.fault("no triangles in it; export the mesh as triangles")
    acting = [node for node, mesh in reading.placed if reading.targets(mesh)]
    drawn = [node for node, _ in reading.placed]
    hooks = find_hooks(container, reading.nodes, acting, drawn)
    return Model(
        name=Path(path).stem,
        parts=tuple(reading.parts),
        shapes=tuple(reading.shapes.values()),
        unit=1000.0,
        notes=(*reading.notes, *reading.paint_notes),
        hooks=hooks,
        head_place=joint_place(container, reading.nodes, hooks.head),
        source=packed(container),
    )


def _require_known(container: Container) -> None:
    wanted = container.document.get("extensionsRequired", [])
    for name in wanted if isinstance(wanted, list) else []:
        if not str(name).startswith(_KNOWN):
            raise container.fault(f"needs the extension {str(name)[:60]!r}, which mien has not")


@dataclass
class _Reading:
    """A scene on its way to a Model."""

    container: Container
    nodes: Nodes
    parts: list[ModelPart] = field(default_factory=list)
    shapes: dict[tuple[str, int], Shape] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    placed: list[tuple[int, int]] = field(default_factory=list)
    """Nodes and their meshes."""

    def __post_init__(self) -> None:
        self.accessors = Accessors(self.container)
        self._paint = Paint(self.accessors)

    def read(self) -> None:
        for node in sorted(self.nodes.world):
            mesh = self.container.listed("nodes")[node].get("mesh")
            if mesh is not None:
                self.container.item("meshes", mesh)
                self.placed.append((node, int(mesh)))
        self._bound()
        for node, mesh in self.placed:
            self._mesh(node, mesh)

    @property
    def paint_notes(self) -> list[str]:
        return self._paint.notes

    def targets(self, mesh: int) -> int:
        """How many morph targets a mesh has."""
        primitives = self.container.listed("meshes")[mesh].get("primitives")
        if not isinstance(primitives, list) or not all(isinstance(p, dict) for p in primitives):
            raise self.container.fault(f"meshes[{mesh}] has no primitives; export it again")
        counts = {len(_list(p.get("targets"))) for p in primitives}
        if len(counts) > 1:
            raise self.container.fault(
                f"the primitives of meshes[{mesh}] have different morph targets; export it again"
            )
        return counts.pop() if counts else 0

    def _bound(self) -> None:
        """Refuse what memory would not hold, before any of it is read."""
        vertices = displacements = shapes = 0
        for _, mesh in self.placed:
            targets = self.targets(mesh)
            shapes += targets
            for primitive in self.container.listed("meshes")[mesh]["primitives"]:
                place = _dict(primitive.get("attributes")).get("POSITION")
                if place is not None:
                    count = self.accessors.count(place)
                    vertices, displacements = vertices + count, displacements + count * targets
        if vertices > _MAX_VERTICES or shapes > _MAX_TARGETS or displacements > MAX_DISPLACEMENTS:
            raise self.container.fault(
                f"{vertices} vertices and {shapes} morph targets are more than memory should hold"
                f" (at most {MAX_DISPLACEMENTS // 10**6} million displacements); reduce it"
            )

    def _mesh(self, node: int, index: int) -> None:
        mesh = self.container.listed("meshes")[index]
        count = self.targets(index)
        names = self._target_names(index, count)
        weights = mesh.get("weights")
        if weights is not None and len(_list(weights)) != count:
            self._note(f"meshes[{index}] has default weights for {len(_list(weights))} of {count}")
        elif any(_list(weights)):
            self._note(f"meshes[{index}] rests at other weights than 0: neutral is 0")
        name = self._name(node, index)
        for place, primitive in enumerate(mesh["primitives"]):
            self._primitive(node, index, name, place, primitive, names)

    def _primitive(
        self,
        node: int,
        mesh: int,
        name: str,
        place: int,
        primitive: Json,
        names: Sequence[str],
    ) -> None:
        attributes = _dict(primitive.get("attributes"))
        if primitive.get("mode", _TRIANGLES) != _TRIANGLES or "POSITION" not in attributes:
            self._note(f"a primitive of meshes[{mesh}] has no triangles: left out")
            return
        places = self.accessors.read(attributes["POSITION"], 3).astype(float)
        triangles = self._triangles(primitive, len(places), mesh)
        if not len(triangles):
            self._note(f"a primitive of meshes[{mesh}] has no triangles: left out")
            return
        matrices = self._matrices(node, attributes, len(places))
        world = self._finite(np.einsum("nij,nj->ni", matrices[:, :, :3], places))
        world = self._finite(world + matrices[:, :, 3])
        if np.linalg.det(matrices[0, :, :3]) < 0:
            triangles = triangles[:, ::-1]
        number = len(self.parts)
        self.parts.append(
            ModelPart(
                name if not number or self.parts[-1].node != node else f"{name}_{number}",
                world,
                np.ascontiguousarray(triangles, dtype=np.int32),
                self._paint.colours(primitive, len(places)),
                node,
                place,
            )
        )
        for target, described in enumerate(_list(primitive.get("targets"))):
            moved = self._target(described, len(places), mesh, target)
            turned = np.einsum("nij,nj->ni", matrices[:, :, :3], moved)
            field_ = self._finite(turned).astype(np.float32)
            self._add(number, mesh, target, names, field_)

    def _add(
        self, part: int, mesh: int, target: int, names: Sequence[str], moved: NDArray[np.float32]
    ) -> None:
        """Shapes of one name in several meshes are one; of one name in one mesh they are not."""
        name = names[target]
        key = name, names[:target].count(name)
        if not name:
            key = f"{mesh}.{target}", 0
        shown = name or f"shape {target}" + (f" of mesh {mesh}" if mesh else "")
        shown += f" ({key[1] + 1})" if key[1] else ""
        shape = self.shapes.get(key) or Shape(shown, {})
        bind = Bind(mesh, target)
        self.shapes[key] = Shape(
            shape.name,
            {**shape.fields, part: moved} if moved.any() else shape.fields,
            shape.binds if bind in shape.binds else (*shape.binds, bind),
        )

    def _target(self, described: object, count: int, mesh: int, target: int) -> Array:
        place = _dict(described).get("POSITION")
        if place is None:
            return np.zeros((count, 3))
        if self.accessors.count(place) != count:
            raise self.container.fault(
                f"morph target {target} of meshes[{mesh}] moves {self.accessors.count(place)} "
                f"vertices of {count}; export it again"
            )
        return self.accessors.read(place, 3).astype(float)

    def _triangles(self, primitive: Json, count: int, mesh: int) -> NDArray[np.int64]:
        if "indices" in primitive:
            flat = self.accessors.read(primitive["indices"], 1).astype(np.int64)
        else:
            flat = np.arange(count)
        if len(flat) % 3 or (len(flat) and not 0 <= flat.min() <= flat.max() < count):
            raise self.container.fault(
                f"a triangle of meshes[{mesh}] names a vertex that is not among {count};"
                " export it again"
            )
        triangles = flat.reshape(-1, 3)
        a, b, c = triangles.T
        return np.asarray(triangles[(a != b) & (b != c) & (c != a)])

    def _matrices(self, node: int, attributes: Json, count: int) -> Array:
        """(N, 3, 4) world from each vertex: its node's, or what its joints make of it at rest."""
        skin = self.container.listed("nodes")[node].get("skin")
        if skin is None or "JOINTS_0" not in attributes or "WEIGHTS_0" not in attributes:
            return np.broadcast_to(self.nodes.world[node][:3], (count, 3, 4))
        described = self.container.item("skins", skin)
        joints = _list(described.get("joints"))
        inverse = np.tile(np.eye(4), (len(joints), 1, 1))
        if "inverseBindMatrices" in described:
            read = self.accessors.read(described["inverseBindMatrices"], 16)
            if len(read) < len(joints):
                raise self.container.fault(f"skins[{skin}] has fewer matrices than joints")
            inverse = read[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1).astype(float)
        if not joints or any(joint not in self.nodes.world for joint in map(_whole, joints)):
            raise self.container.fault(f"skins[{skin}] names joints outside the scene")
        placed = np.stack([self.nodes.world[joint] for joint in joints]) @ inverse
        which = self.accessors.read(attributes["JOINTS_0"], 4).astype(np.int64)
        share = self.accessors.read(attributes["WEIGHTS_0"], 4).astype(float)
        if len(which) != count or len(share) != count or which.max() >= len(joints):
            raise self.container.fault(f"skins[{skin}] does not fit its mesh; export it again")
        total = share.sum(axis=1, keepdims=True)
        share = np.where(total > 0, share / np.maximum(total, 1e-12), [1.0, 0.0, 0.0, 0.0])
        return np.asarray(np.einsum("nk,nkij->nij", share, placed[which][:, :, :3]))

    def _target_names(self, index: int, count: int) -> list[str]:
        """(count) names, empty where there is none; they stand on the mesh or its primitives."""
        mesh = self.container.listed("meshes")[index]
        places = [mesh, *_list(mesh.get("primitives"))]
        listed: list[Any] = next(
            (
                names
                for place in places
                if (names := _list(_dict(_dict(place).get("extras")).get("targetNames")))
            ),
            [],
        )
        names = [_clean(name) for name in listed[:count]] + [""] * (count - len(listed))
        if listed and (len(listed) != count or "" in names):
            self._note(f"meshes[{index}] names {sum(map(bool, names))} of {count} morph targets")
        if any(names) and [n for n in names if n] != [n for n in listed if isinstance(n, str)]:
            self._note(f"names of morph targets of meshes[{index}] were cleaned")
        if len(set(filter(None, names))) < len([n for n in names if n]):
            self._note(f"morph targets of meshes[{index}] share names; they were numbered")
        return names

    def _name(self, node: int, mesh: int) -> str:
        for place in (
            self.container.listed("nodes")[node],
            self.container.listed("meshes")[mesh],
        ):
            if name := _clean(place.get("name")):
                return name
        return f"mesh {mesh}"

    def _finite(self, values: Array) -> Array:
        if not (np.abs(values) < _FARTHEST).all():
            raise self.container.fault("has vertices beyond all bounds; export it again")
        return values

    def _note(self, note: str) -> None:
        if note not in self.notes:
            self.notes.append(note)


def _list(value: object) -> list[Any]:
    return value if isinstance(value, list) else []


def _dict(value: object) -> Json:
    return value if isinstance(value, dict) else {}


def _whole(value: object) -> int:
    return value if type(value) is int else -1


def _clean(name: object) -> str:
    """A name that can be shown and written anywhere; empty where it is none."""
    if not isinstance(name, str):
        return ""
    kept = "".join(letter for letter in name[:120] if letter.isprintable() and letter not in "<>")
    return kept.replace("/", "_").replace("\\", "_").strip(". ")

"""VRM 0.x and 1.0: glTF with a humanoid and expressions that combine morph targets.

An expression of one whole target is a key model under the expression's name; one that mixes
several is a key model of its own; targets that no expression shows whole keep their own names.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.face.model import Bind, Hooks, Model, Shape
from mien.formats.gltf.container import Container, Json, open_gltf
from mien.formats.gltf.nodes import joint_place, read_nodes
from mien.formats.gltf.read import read_gltf

PRESETS: Mapping[str, str] = {
    **{"a": "aa", "i": "ih", "u": "ou", "e": "ee", "o": "oh", "neutral": "neutral"},
    **{"blink": "blink", "blink_l": "blinkLeft", "blink_r": "blinkRight"},
    **{"joy": "happy", "angry": "angry", "sorrow": "sad", "fun": "relaxed"},
    **{"lookup": "lookUp", "lookdown": "lookDown"},
    **{"lookleft": "lookLeft", "lookright": "lookRight"},
}
"""Expressions of VRM 0.x by what VRM 1.0 calls them (UniVRM's table)."""
LOOKS: Mapping[str, str] = {
    "left": "lookLeft",
    "right": "lookRight",
    "up": "lookUp",
    "down": "lookDown",
}
_OVERRIDES = {"blink": "overrideBlink", "lookAt": "overrideLookAt", "mouth": "overrideMouth"}
_BONES_0 = {
    "leftThumbProximal": "leftThumbMetacarpal",
    "leftThumbIntermediate": "leftThumbProximal",
    "rightThumbProximal": "rightThumbMetacarpal",
    "rightThumbIntermediate": "rightThumbProximal",
}


def read_vrm(path: Path | str) -> Model:
    """Read a character. Raises InputError, FormatError as ``read_gltf``; a .vrm that holds no VRM
    is read as glTF, with a note."""
    model, container = read_gltf(path), open_gltf(Path(path))
    extensions = container.document.get("extensions")
    extensions = extensions if isinstance(extensions, dict) else {}
    if isinstance(extensions.get("VRMC_vrm"), dict):
        version, told = 1, extensions["VRMC_vrm"]
        found = _expressions_1(container, told)
    elif isinstance(extensions.get("VRM"), dict):
        version, told = 0, extensions["VRM"]
        found = _expressions_0(told)
    else:
        return replace(model, notes=(*model.notes, "holds no VRM: read as glTF"))
    known = {bind: shape for shape in model.shapes for bind in shape.binds}
    notes: list[str] = []
    listed = {name: _sound(name, binds, known, notes) for name, binds in found}
    bones = dict(_bones(container, told, version, notes))
    eyes = bones.get("leftEye"), bones.get("rightEye")
    head = bones.get("head")
    return replace(
        model,
        shapes=tuple(_shapes(model, listed, known, container)),
        forward=-1 if version == 0 else 1,
        notes=(*model.notes, *dict.fromkeys(notes)),
        hooks=Hooks(head, eyes, version, bones),
        overrides=dict(_overrides(told)) if version == 1 else {},
        head_place=joint_place(container, read_nodes(container), head),
    )


def _shapes(
    model: Model,
    listed: Mapping[str, tuple[Bind, ...]],
    known: Mapping[Bind, Shape],
    container: Container,
) -> Iterator[Shape]:
    nodes = container.listed("nodes")
    mesh = [_mesh_of(nodes, part.node) for part in model.parts]
    shown: set[Bind] = set()
    taken: set[str] = set()
    for name, binds in listed.items():
        if not binds:
            continue
        if len(binds) == 1 and binds[0].weight == 1.0:
            shown.add(Bind(binds[0].mesh, binds[0].target))
        fields: dict[int, NDArray[np.float32]] = {}
        for bind in binds:
            for part, field in known[Bind(bind.mesh, bind.target)].fields.items():
                # Targets of one name in several meshes are one shape, but not one bind.
                if mesh[part] == bind.mesh:
                    rest = fields.get(part, np.float32(0.0))
                    fields[part] = rest + np.float32(bind.weight) * field
        taken.add(name)
        yield Shape(name, fields, binds, name)
    for shape in model.shapes:
        if not set(shape.binds) <= shown:
            name = shape.name if shape.name not in taken else f"{shape.name} (target)"
            yield replace(shape, name=name)


def _sound(
    name: str, binds: list[tuple[Any, Any, Any]], known: Mapping[Bind, Shape], notes: list[str]
) -> tuple[Bind, ...]:
    """The binds that point somewhere; notes tell of the others."""
    found = []
    for mesh, target, weight in binds:
        there = type(mesh) is int and type(target) is int and Bind(mesh, target) in known
        if not there:
            notes.append(f"expression {name!r} binds a morph target that is not there: left out")
        elif type(weight) not in (int, float) or not 0.0 <= weight <= 1.0:
            notes.append(f"expression {name!r} has a weight outside its range: left out")
        elif weight:
            found.append(Bind(mesh, target, float(weight)))
    return tuple(found)


def _expressions_0(told: Json) -> Iterator[tuple[str, list[tuple[Any, Any, Any]]]]:
    master = told.get("blendShapeMaster")
    groups = master.get("blendShapeGroups") if isinstance(master, dict) else None
    for group in groups if isinstance(groups, list) else []:
        if not isinstance(group, dict):
            continue
        preset = str(group.get("presetName", "unknown")).lower()
        name = PRESETS.get(preset) or str(group.get("name", ""))[:100]
        binds = group.get("binds")
        yield (
            name or preset,
            [
                (bind.get("mesh"), bind.get("index"), _percent(bind.get("weight")))
                for bind in (binds if isinstance(binds, list) else [])
                if isinstance(bind, dict)
            ],
        )


def _percent(weight: Any) -> Any:
    return weight / 100.0 if type(weight) in (int, float) else weight


def _expressions_1(
    container: Container, told: Json
) -> Iterator[tuple[str, list[tuple[Any, Any, Any]]]]:
    nodes = container.listed("nodes")
    for name, expression in _listed_1(told):
        binds = expression.get("morphTargetBinds")
        yield (
            name,
            [
                (_mesh_of(nodes, bind.get("node")), bind.get("index"), bind.get("weight"))
                for bind in (binds if isinstance(binds, list) else [])
                if isinstance(bind, dict)
            ],
        )


def _overrides(told: Json) -> Iterator[tuple[str, dict[str, str]]]:
    """What each expression of VRM 1.0 takes from others."""
    for name, expression in _listed_1(told):
        said = {what: str(expression.get(key)) for what, key in _OVERRIDES.items()}
        ways = {what: way for what, way in said.items() if way in ("block", "blend")}
        if ways:
            yield name, ways


def _listed_1(told: Json) -> Iterator[tuple[str, Json]]:
    """Names and contents of the expressions of VRM 1.0."""
    expressions = told.get("expressions")
    for kind in ("preset", "custom"):
        listed = expressions.get(kind) if isinstance(expressions, dict) else None
        for name, expression in (listed if isinstance(listed, dict) else {}).items():
            yield str(name)[:100], expression if isinstance(expression, dict) else {}


def _mesh_of(nodes: list[Json], node: Any) -> Any:
    return nodes[node].get("mesh") if type(node) is int and 0 <= node < len(nodes) else None


def _bones(
    container: Container, told: Json, version: int, notes: list[str]
) -> Iterator[tuple[str, int]]:
    humanoid = told.get("humanoid")
    bones = humanoid.get("humanBones") if isinstance(humanoid, dict) else None
    if isinstance(bones, list):
        pairs = [(b.get("bone"), b.get("node")) for b in bones if isinstance(b, dict)]
    elif isinstance(bones, dict):
        pairs = [(name, b.get("node")) for name, b in bones.items() if isinstance(b, dict)]
    else:
        pairs = []
    for name, node in pairs:
        if type(node) is not int or not 0 <= node < len(container.listed("nodes")):
            notes.append(f"bone {str(name)[:40]!r} is a node that is not there: left out")
            continue
        yield (_BONES_0.get(str(name), str(name)) if version == 0 else str(name)), node

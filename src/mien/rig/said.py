"""What a user says of a character where measuring or names fail, in a file.

[shapes]
"morph3" = "mouthSmileLeft"    # moves as this key model of the generic face does
"halo" = "nothing"             # never acts

[nodes]
head = "Neck_02"               # a node of the file, by its name
eye_left = "ball.L"
eye_right = "ball.R"
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mien.errors import FormatError, InputError
from mien.face.library import generic_face
from mien.face.model import Hooks, Model
from mien.formats.gltf.container import open_gltf
from mien.formats.gltf.nodes import joint_place, read_nodes
from mien.formats.notes.toml import read_toml

NOTHING = "nothing"
_NODES = ("head", "eye_left", "eye_right")


@dataclass(frozen=True, slots=True)
class Said:
    """Both tables, as they stand."""

    shapes: Mapping[str, str]
    nodes: Mapping[str, str]
    path: Path = Path()


def read_said(path: Path) -> Said:
    """Raises InputError where there is no such file, FormatError where it is something else."""
    found = read_toml(path)
    tables = [found.get(name, {}) for name in ("shapes", "nodes")]
    if not any(tables) or not all(map(_is_table, tables)):
        raise FormatError(f'{path}: needs [shapes] with "its shape" = "mouthSmileLeft", or [nodes]')
    if not set(tables[1]) <= set(_NODES):
        raise FormatError(f"{path}: [nodes] knows {', '.join(_NODES)}")
    return Said(tables[0], tables[1], path)


def meant(said: Said, model: Model) -> Mapping[str, str]:
    """What each shape stands for. Raises InputError for a shape or a movement there is not."""
    known = {*generic_face().keys.names, NOTHING}
    own = {shape.name for shape in model.shapes}
    for shape, meaning in said.shapes.items():
        if shape not in own:
            raise InputError(f"{said.path}: the character has no shape '{shape[:60]}'")
        if meaning not in known:
            raise InputError(
                f"{said.path}: '{meaning[:60]}' is no movement mien knows; "
                "see 'mien character list generic'"
            )
    return said.shapes


def with_nodes(model: Model, said: Said, path: Path) -> Model:
    """``model`` with head and eyes turned by the nodes that were named. Raises InputError."""
    if not said.nodes:
        return model
    if model.source is None:
        raise InputError(f"{said.path}: {path} has no nodes to name")
    container = open_gltf(path)
    nodes = read_nodes(container)
    row = {
        str(node.get("name")): i
        for i, node in enumerate(container.listed("nodes"))
        if i in nodes.world
    }
    for name in said.nodes.values():
        if name not in row:
            raise InputError(f"{said.path}: the character has no node '{name[:60]}'")
    number = {what: row[name] for what, name in said.nodes.items()}
    hooks: Hooks = model.hooks
    left, right = hooks.eyes
    head = number.get("head", hooks.head)
    eyes = number.get("eye_left", left), number.get("eye_right", right)
    return replace(
        model,
        hooks=replace(hooks, head=head, eyes=eyes),
        head_place=joint_place(container, nodes, head),
    )


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) and all(isinstance(word, str) for word in value.values())

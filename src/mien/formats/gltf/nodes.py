"""Where the nodes of a glTF scene stand, and which of them turn head and eyes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from mien.face.face import Array
from mien.face.model import Hooks
from mien.formats.gltf.container import Container, Json

_DEEPEST = 256
_EYE = re.compile(r"(?:^|[^a-z])eye(?:[ _.-]?ball)?[ _.-]?(l|left|r|right)$")
_EYE_AFTER = re.compile(r"(?:^|[^a-z])(l|left|r|right)[ _.-]?eye(?:[ _.-]?ball)?$")
_HEAD = re.compile(r"(?:^|[^a-z])head$")


@dataclass(frozen=True, slots=True)
class Nodes:
    """The nodes of the scene that is shown."""

    world: dict[int, Array]
    """(4, 4) world_from_node of every node in it."""
    parent: dict[int, int]
    """Of every node that has one."""

    def ancestors(self, node: int) -> list[int]:
        """``node`` and all above it, upwards."""
        found = [node]
        while found[-1] in self.parent:
            found.append(self.parent[found[-1]])
        return found


def read_nodes(container: Container) -> Nodes:
    """Walk the scene from its roots. Raises FormatError where nodes go in circles, hang on two
    parents or are nested beyond reason."""
    nodes = container.listed("nodes")
    world: dict[int, Array] = {}
    parent: dict[int, int] = {}
    waiting: list[tuple[Any, Array, int]] = [(i, np.eye(4), 1) for i in _roots(container)]
    while waiting:
        index, above, depth = waiting.pop()
        node = container.item("nodes", index)
        if index in world:
            raise container.fault(f"nodes[{index}] hangs in two places or in itself; mend the tree")
        if depth > _DEEPEST:
            raise container.fault(f"its nodes are nested more than {_DEEPEST} deep; flatten them")
        world[index] = above @ local_matrix(container, node, index)
        children = node.get("children", [])
        if not isinstance(children, list) or len(children) > len(nodes):
            raise container.fault(f"nodes[{index}].children is not a list of nodes")
        for child in children:
            container.item("nodes", child)
            parent[child] = index
            waiting.append((child, world[index], depth + 1))
    return Nodes(world, parent)


def _roots(container: Container) -> list[Any]:
    scenes, nodes = container.listed("scenes"), container.listed("nodes")
    if scenes:
        roots = container.item("scenes", container.document.get("scene", 0)).get("nodes", [])
        if not isinstance(roots, list) or len(roots) > len(nodes):
            raise container.fault("its scene is not a list of nodes; export it again")
        return roots
    listed = [node.get("children") for node in nodes]
    below = {child for some in listed if isinstance(some, list) for child in map(str, some)}
    return [i for i in range(len(nodes)) if str(i) not in below]


def numbers(container: Container, values: object, count: int, what: str) -> Array:
    """(count,) finite numbers from a document. Raises FormatError."""
    if (
        not isinstance(values, list)
        or len(values) != count
        or not all(type(x) in (int, float) and abs(x) < 1e12 for x in values)
    ):
        raise container.fault(f"{what} is not {count} numbers; export it again")
    return np.array(values, dtype=float)


def local_matrix(container: Container, node: Json, index: object) -> Array:
    """(4, 4) parent_from_node."""
    where = f"nodes[{index}]"
    if "matrix" in node:
        return numbers(container, node["matrix"], 16, f"{where}.matrix").reshape(4, 4).T
    matrix = np.eye(4)
    shift = numbers(container, node.get("translation", [0, 0, 0]), 3, f"{where}.translation")
    turn = numbers(container, node.get("rotation", [0, 0, 0, 1]), 4, f"{where}.rotation")
    scale = numbers(container, node.get("scale", [1, 1, 1]), 3, f"{where}.scale")
    length = float(np.linalg.norm(turn))
    if length < 1e-9:
        raise container.fault(f"{where}.rotation is no rotation; export it again")
    matrix[:3, :3] = _rotation(turn / length) * scale
    matrix[:3, 3] = shift
    return matrix


def _rotation(quaternion: Array) -> Array:
    x, y, z, w = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def find_hooks(container: Container, nodes: Nodes, acting: list[int], drawn: list[int]) -> Hooks:
    """Head and eyes by their names: a joint called head, a node called head that carries all that
    acts, or the node that carries all that is drawn. ``acting`` and ``drawn`` are the nodes of the
    meshes with morph targets, and of all meshes."""
    names = {i: str(container.listed("nodes")[i].get("name", "")) for i in nodes.world}
    joints = _joints(container)
    eyes: list[int | None] = [None, None]
    for i, name in sorted(names.items()):
        match = _EYE.search(_spaced(name)) or _EYE_AFTER.search(_spaced(name))
        if match:
            side = 0 if match[1].startswith("l") else 1
            eyes[side] = i if eyes[side] is None else eyes[side]
    carried = [*acting, *(eye for eye in eyes if eye is not None)]
    for i, name in sorted(names.items()):
        if _HEAD.search(_spaced(name)) and (
            i in joints or all(i in nodes.ancestors(node) for node in carried)
        ):
            return Hooks(i, (eyes[0], eyes[1]))
    if joints or not drawn:
        return Hooks(None, (eyes[0], eyes[1]))
    common = [
        node
        for node in nodes.ancestors(drawn[0])
        if all(node in nodes.ancestors(other) for other in drawn)
    ]
    return Hooks(common[0] if common else None, (eyes[0], eyes[1]))


def joint_place(container: Container, nodes: Nodes, node: int | None) -> Array | None:
    """(3,) where a node stands that is a joint of a skin; None for any other."""
    if node not in nodes.world or node not in _joints(container):
        return None
    return np.asarray(nodes.world[node][:3, 3])


def _joints(container: Container) -> set[int]:
    listed = [skin.get("joints") for skin in container.listed("skins")]
    joints = [joint for some in listed if isinstance(some, list) for joint in some]
    return {joint for joint in joints if type(joint) is int}


def _spaced(name: str) -> str:
    """ "grp_eyeLeft" as "grp_eye_left"."""
    return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name[:200]).lower()

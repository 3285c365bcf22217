"""How far the influence of feature points reaches over a face's surface.

A map belongs to one point among others: it is 1 there, 0 at the others, and between them as smooth
as the surface lets it be,

    minimise  sum over the surface of |L w|² + |w|² / reach⁴,    w = 1 or 0 at the points

with L the Laplacian of the surface (cotangents; Pinkall and Polthier 1993), so that it runs along
the skin and never across the gap between two lips or two lids. Points are barycentric: the maps
meet them exactly, which is what makes the values of animation parameters readable again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.sparse.linalg import splu

from mien.errors import InputError
from mien.face.face import Array, Face, FeaturePoints, Ints, Part

Index = NDArray[np.intp]
Mask = NDArray[np.bool_]

LIPS = ("2.4", "2.6", "2.2", "2.7", "2.5", "2.9", "2.3", "2.8")
"""The inner edge of the lips, once round."""
LIDS = (("3.7", "3.1", "3.11", "3.3"), ("3.12", "3.2", "3.8", "3.4"))
"""The lid margins of the left and right eye, from the outer corner over the top."""

_TAUT = 0.4
"""Part of the reach beyond which tension rules bending: a plate alone swings through zero and back
behind every point."""
_FIRM = 1.0
"""1/mm⁴, how firmly held vertices are held: a thousand times what bends a lip."""
_TANGENT = (0.02, 20.0)
"""Cotangents are kept within this: slivers would otherwise rule their neighbourhood."""
_INSIDE = 4.0
"""An edge this many times as long is still preferred by a margin's path to one that lies deeper."""


class Surface:
    """The part of a mesh over which influence spreads."""

    def __init__(
        self,
        vertices: Array,
        triangles: Ints,
        points: FeaturePoints,
        reach: float,
        held: Mask | None = None,
        sewn: sparse.csr_matrix | None = None,
    ) -> None:
        """``vertices`` (V, 3) mm of which those in ``triangles`` (T, 3) count, ``points`` on
        them; influence fades over ``reach`` mm where no point stops it; ``held`` (V,) stay;
        ``sewn`` (N, V) is kept at zero."""
        self._count = len(vertices)
        self._used, local = np.unique(triangles, return_inverse=True)
        laplacian, mass = _laplacian(vertices[self._used], local.reshape(-1, 3))
        firm = mass / reach**4
        if held is not None:
            firm = firm + _FIRM * mass * held[self._used]
        system = laplacian.T @ sparse.diags(1.0 / mass) @ laplacian + sparse.diags(firm)
        system += laplacian / (_TAUT * reach) ** 2
        if sewn is not None:
            seam = sewn[:, self._used]
            system += _FIRM * float(mass.mean()) * seam.T @ seam
        on = np.asarray(np.isin(points.vertices, self._used).all(axis=1))
        self.ids = tuple(fdp for fdp, here in zip(points.ids, on, strict=True) if here)
        rows = np.repeat(np.arange(len(self.ids)), 3)
        columns = np.searchsorted(self._used, points.vertices[on].ravel())
        self._at = sparse.csr_matrix(
            (points.weights[on].ravel(), (rows, columns)), (len(self.ids), len(self._used))
        )
        self._green = splu(system.tocsc()).solve(self._at.T.toarray())

    def map(self, one: Sequence[str], zero: Sequence[str]) -> Array:
        """(V,) the influence that is 1 at the points ``one`` and 0 at ``zero``; points that are
        not on this surface are left out."""
        rows = [self.ids.index(fdp) for fdp in (*one, *zero) if fdp in self.ids]
        wanted = np.array([float(self.ids[row] in one) for row in rows])
        green = self._green[:, rows]
        found = np.zeros(self._count)
        found[self._used] = green @ np.linalg.solve(self._at[rows] @ green, wanted)
        return found


@dataclass(frozen=True, slots=True)
class Opening:
    """A hole in the face with an edge: the mouth, or an eye."""

    rim: Index
    """(N,) vertices once round, in the order of the points it was found by."""
    inside: Mask
    """(V,) what lies behind the rim: the bag of the mouth, the back of the lids."""


def opening(
    face: Face,
    part: Part,
    loop: Sequence[str],
    ball: Array | None = None,
    depth: float = 0.0,
) -> Opening:
    """The hole in ``part`` whose edge runs through the points ``loop``, along the edges of the
    mesh; a point that lies on lashes stands for the skin beside it.

    An eye's edge must not slip behind the lid: ``ball`` (3,) is then the eyeball's middle, and
    vertices nearer to it than ``depth`` mm are avoided. Raises KeyError for a missing point,
    InputError where the mesh is in pieces between two points.
    """
    edges, length = _edges(face)
    if ball is not None:
        deep = np.linalg.norm(face.vertices - ball, axis=1) < depth
        length = length * np.where(deep[edges].any(axis=1), _INSIDE, 1.0)
    graph = _graph(edges, len(face.vertices), length)
    corners = [_nearest_vertex(face, part, fdp) for fdp in loop]
    rim = np.concatenate(
        [_path(graph, a, b)[:-1] for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)]
    )
    return Opening(rim, _inside(face, edges, rim))


def along_the_skin(face: Face, start: Index) -> Array:
    """(V,) mm along the edges of the mesh from the nearest of the vertices ``start``; infinite on
    other pieces of it."""
    edges, length = _edges(face)
    graph = _graph(edges, len(face.vertices), length)
    return np.asarray(dijkstra(graph, directed=False, indices=start, min_only=True))


def _edges(face: Face) -> tuple[Ints, Array]:
    """(E, 2) edges of all triangles and (E,) their lengths."""
    triangles = face.triangles
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return edges, np.linalg.norm(face.vertices[edges[:, 0]] - face.vertices[edges[:, 1]], axis=1)


def sewn_up(face: Face) -> tuple[Face, Index]:
    """``face`` with its seams closed, and for each vertex (V,) the one that stands for it.

    Files cut a surface where its texture is cut: two vertices at one place, each on an edge of the
    mesh. Lips that lie on each other are not on an edge, for a mouth has an inside.
    """
    stands_for = np.arange(len(face.vertices))
    for part in face.parts:
        edges = np.sort(part.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        once, times = np.unique(edges, axis=0, return_counts=True)
        rim = np.unique(once[times == 1])
        _, first, same = np.unique(
            face.vertices[rim], axis=0, return_index=True, return_inverse=True
        )
        stands_for[rim] = rim[first[same.ravel()]]
    parts = tuple(
        replace(p, triangles=stands_for[p.triangles].astype(np.int32)) for p in face.parts
    )
    points = replace(face.points, vertices=stands_for[face.points.vertices].astype(np.int32))
    return replace(face, parts=parts, points=points), stands_for


def part_at(face: Face, vertex: int) -> Part:
    """The part that ``vertex`` belongs to."""
    return next(part for part in face.parts if part.first <= vertex < part.last)


def rows(face: Face, part: Part) -> Mask:
    """(V,) the vertices of ``part``."""
    number = np.arange(len(face.vertices))
    return np.asarray((number >= part.first) & (number < part.last))


def _inside(face: Face, edges: Ints, rim: Index) -> Mask:
    """(V,) what is cut off by ``rim`` from the rest of its part: all but the largest piece."""
    count = len(face.vertices)
    whole = connected_components(_graph(edges, count), directed=False)[1]
    open_ = np.ones(count, dtype=bool)
    open_[rim] = False
    cut = edges[open_[edges].all(axis=1)]
    piece = connected_components(_graph(cut, count), directed=False)[1]
    mine = open_ & (whole == whole[rim[0]])
    largest = np.bincount(piece[mine]).argmax()
    return np.asarray(mine & (piece != largest))


def _graph(edges: Ints, count: int, length: Array | None = None) -> sparse.csr_matrix:
    """Inner edges come twice, and a sparse matrix adds up what it is given twice."""
    where = (edges.min(axis=1), edges.max(axis=1))
    weight = np.ones(len(edges)) if length is None else length
    total = sparse.csr_matrix((weight, where), (count, count))
    times = sparse.csr_matrix((np.ones(len(edges)), where), (count, count))
    total.data /= times.data
    return total


def _path(graph: sparse.csr_matrix, start: int, end: int) -> Index:
    _, before = dijkstra(graph, directed=False, indices=start, return_predecessors=True)
    if start != end and before[end] < 0:
        raise InputError("an eye or the mouth is not surrounded by one surface")
    path = [end]
    while path[-1] != start:
        path.append(int(before[path[-1]]))
    return np.array(path[::-1], dtype=np.intp)


def _nearest_vertex(face: Face, part: Part, fdp: str) -> int:
    row = face.points.index([fdp])[0]
    vertex = int(face.points.vertices[row, np.argmax(face.points.weights[row])])
    if part.first <= vertex < part.last:
        return vertex
    used = np.unique(part.triangles)
    return int(used[np.linalg.norm(face.vertices[used] - face.point(fdp), axis=1).argmin()])


def _laplacian(vertices: Array, triangles: Index) -> tuple[sparse.csr_matrix, Array]:
    """(V, V) stiffness by cotangents and (V,) the area each vertex stands for, mm²."""
    count = len(vertices)
    rows, columns, values = [], [], []
    mass = np.zeros(count)
    for corner in range(3):
        apex, here, there = (triangles[:, (corner + n) % 3] for n in range(3))
        p, q = vertices[here] - vertices[apex], vertices[there] - vertices[apex]
        double = np.linalg.norm(np.cross(p, q), axis=1)
        cotangent = np.clip((p * q).sum(axis=1) / np.maximum(double, 1e-9), *_TANGENT)
        np.add.at(mass, apex, double / 6.0)
        rows += [here, there, here, there]
        columns += [there, here, here, there]
        values += [-cotangent / 2.0, -cotangent / 2.0, cotangent / 2.0, cotangent / 2.0]
    where = (np.concatenate(rows), np.concatenate(columns))
    stiffness = sparse.csr_matrix((np.concatenate(values), where), (count, count))
    return stiffness, np.maximum(mass, 1e-6 * mass.max())

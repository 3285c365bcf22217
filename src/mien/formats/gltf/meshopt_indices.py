"""Indices, as meshopt stores them.

Source: KHR_meshopt_compression, appendix A, modes 1 and 2. A list of triangles goes by edges and
vertices met shortly before, which stand in two rings of sixteen; any other list by differences
from one of two running values. What was never written into a ring is -1, and must not be read.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.formats.gltf.meshopt_numbers import Bytes, Int, Whole, kernel, number, unzigzag

_PLACE, _NEXT, _LAST, _VERTEX, _EDGE = range(5)
"""What is known while triangles are read: where the stream goes on (-1: it does not), the index
that comes next, the last that was written out, and how many vertices and edges were met."""
_TABLE = 16


@kernel
def triangles(data: Bytes, out: NDArray[np.uint32]) -> bool:
    """Fill ``out`` (3 T) from a stream; False where it is damaged."""
    count = len(out) // 3
    end = len(data) - _TABLE
    if end < 1 + count or data[0] != 0xE1:
        return False
    vertices, edges = np.full(16, -1, np.int64), np.full((16, 2), -1, np.int64)
    state = np.zeros(5, np.int64)
    state[_PLACE] = 1 + count
    found = np.zeros(3, np.int64)
    for t in range(count):
        code = np.int64(data[1 + t])
        if code < 0xF0:
            _by_edge(data, end, code, state, vertices, edges, found)
        else:
            _by_vertices(data, end, code & 15, state, vertices, found)
            if state[_PLACE] >= 0:
                _meet_edge(state, edges, found[1], found[0])
        if state[_PLACE] < 0 or found.min() < 0:
            return False
        _meet_edge(state, edges, found[2], found[1])
        _meet_edge(state, edges, found[0], found[2])
        out[3 * t : 3 * t + 3] = found
    return bool(state[_PLACE] == end)


@kernel
def _by_edge(
    data: Bytes, end: Int, code: Int, state: Whole, vertices: Whole, edges: Whole, found: Whole
) -> None:
    """A triangle on an edge met before."""
    high, low = code >> 4, code & 15
    found[:2] = edges[(state[_EDGE] - 1 - high) & 15]
    if 0 < low < 13:
        found[2] = vertices[(state[_VERTEX] - 1 - low) & 15]
        return
    if low == 0:
        found[2] = state[_NEXT]
        state[_NEXT] += 1
    elif low < 15:
        state[_LAST] += -1 if low == 13 else 1
        found[2] = state[_LAST]
    else:
        found[2] = _written(data, end, state)
    _meet_vertex(state, vertices, found[2])


@kernel
def _by_vertices(
    data: Bytes, end: Int, low: Int, state: Whole, vertices: Whole, found: Whole
) -> None:
    """A triangle of vertices that come next, were met before or are written out."""
    if low < 14:
        pair = np.int64(data[end + low])
    elif state[_PLACE] >= end:
        state[_PLACE] = -1
        return
    else:
        pair = np.int64(data[state[_PLACE]])
        state[_PLACE] += 1
        if pair == 0:
            state[_NEXT] = 0
    ways = (15 if low == 15 else 0, pair >> 4, pair & 15)
    met = state[_VERTEX]
    for corner in range(3):
        way = ways[corner]
        if way == 0:
            found[corner] = state[_NEXT]
            state[_NEXT] += 1
        elif way < 15:
            found[corner] = vertices[(met - way) & 15]
        else:
            found[corner] = _written(data, end, state)
    for corner in range(3):
        if ways[corner] in (0, 15):
            _meet_vertex(state, vertices, found[corner])


@kernel
def _written(data: Bytes, end: Int, state: Whole) -> Int:
    """An index written out as a difference from the last such."""
    if state[_PLACE] < 0:
        return -1
    delta, state[_PLACE] = number(data, state[_PLACE], end)
    last: Int = (state[_LAST] + unzigzag(delta)) & 0xFFFFFFFF
    state[_LAST] = last
    return last


@kernel
def _meet_vertex(state: Whole, vertices: Whole, vertex: Int) -> None:
    vertices[state[_VERTEX] & 15] = vertex
    state[_VERTEX] += 1


@kernel
def _meet_edge(state: Whole, edges: Whole, first: Int, second: Int) -> None:
    edges[state[_EDGE] & 15, 0], edges[state[_EDGE] & 15, 1] = first, second
    state[_EDGE] += 1


@kernel
def indices(data: Bytes, out: NDArray[np.uint32]) -> bool:
    """Fill ``out`` (N) from a stream; False where it is damaged."""
    end = len(data) - 4
    if end < 1 or data[0] != 0xD1:
        return False
    last = np.zeros(2, np.int64)
    at: Int = np.int64(1)
    for i in range(len(out)):
        value, at = number(data, at, end)
        if at < 0:
            return False
        baseline = value & 1
        last[baseline] = (last[baseline] + unzigzag(value >> 1)) & 0xFFFFFFFF
        out[i] = last[baseline]
    return bool(at == end)

"""Elements of a few bytes each, as meshopt stores them: differences from the element before, byte
by byte, in blocks of up to 256 elements and groups of sixteen.

Source: KHR_meshopt_compression, appendix A, mode 0. Version 0 of the stream is what
EXT_meshopt_compression knows; version 1 has more ways to store a byte and to take a difference.
"""

from __future__ import annotations

import numpy as np

from mien.formats.gltf.meshopt_numbers import Bytes, Int, Whole, joined, kernel, unzigzag

_GROUP = 16
_BLOCK_BYTES, _BLOCK = 8192, 256


@kernel
def attributes(data: Bytes, out: Bytes) -> bool:
    """Fill ``out`` (N, stride) from a stream; False where it is damaged."""
    count, stride = out.shape
    if len(data) < 1 or data[0] not in (0xA0, 0xA1):
        return False
    version, channels = np.int64(data[0] & 1), stride // 4
    element = len(data) - stride - version * channels
    end = min(element, len(data) - (24 if version else 32))
    if end < 1:
        return False
    last = data[element : element + stride].astype(np.int64)
    modes = np.zeros(channels, np.int64)
    if version:
        modes[:] = data[element + stride :]
    longest = min((_BLOCK_BYTES // stride) & ~15, _BLOCK)
    deltas = np.zeros((stride, longest), np.int64)
    at: Int = 1
    first = 0
    while first < count:
        size = min(longest, count - first)
        at = _block(data, at, end, version, size, deltas)
        if at < 0 or not _undo(deltas, modes, last, out[first : first + size]):
            return False
        first += size
    return bool(at == end)


@kernel
def _block(data: Bytes, at: Int, end: Int, version: Int, size: Int, deltas: Whole) -> Int:
    """Read one attribute block of ``size`` elements into ``deltas`` (stride, longest); the place
    after it, or -1."""
    stride = len(deltas)
    groups = (size + _GROUP - 1) // _GROUP
    controls = at
    if version:
        at += stride // 4
        if at > end:
            return -1
    for k in range(stride):
        control = (np.int64(data[controls + k // 4]) >> 2 * (k % 4)) & 3 if version else 4
        if control == 2:
            deltas[k, : groups * _GROUP] = 0
        elif control == 3:
            if at + size > end:
                return -1
            deltas[k, :size] = data[at : at + size]
            at += size
        else:
            at = _groups(data, at, end, control, groups, deltas[k])
            if at < 0:
                return -1
    return at


@kernel
def _groups(data: Bytes, at: Int, end: Int, control: Int, groups: Int, deltas: Whole) -> Int:
    """Read the groups of one byte of the elements, whose bit lengths ``control`` chooses from."""
    header = at
    at += (groups + 3) // 4
    if at > end:
        return -1
    for g in range(groups):
        choice = (np.int64(data[header + g // 4]) >> 2 * (g % 4)) & 3
        # 0, 1, 2, 4 bits; 1, 2, 4, 8; and in version 0: 0, 2, 4, 8.
        exponent = choice + control if control < 2 else (choice + 1 if choice else 0)
        bits = 1 << exponent >> 1
        own = deltas[g * _GROUP : (g + 1) * _GROUP]
        packed = at
        at += 2 * bits
        if at > end:
            return -1
        if bits == 0:
            own[:] = 0
        elif bits == 8:
            own[:] = data[packed:at]
        else:
            at = _packed(data, packed, at, end, bits, own)
            if at < 0:
                return -1
    return at


@kernel
def _packed(data: Bytes, packed: Int, at: Int, end: Int, bits: Int, own: Whole) -> Int:
    """Sixteen values of 1, 2 or 4 ``bits``; one with all bits set stands in full behind them."""
    each, most = 8 // bits, (1 << bits) - 1
    for i in range(_GROUP):
        place = i % each if bits == 1 else each - 1 - i % each
        value = (np.int64(data[packed + i // each]) >> place * bits) & most
        if value == most:
            if at >= end:
                return -1
            value = np.int64(data[at])
            at += 1
        own[i] = value
    return at


@kernel
def _undo(deltas: Whole, modes: Whole, last: Whole, out: Bytes) -> bool:
    """Differences into elements ``out`` (N, stride), channel by channel; ``last`` goes along."""
    size = len(out)
    for channel in range(len(modes)):
        mode, turn, k = modes[channel] & 15, modes[channel] >> 4, 4 * channel
        if mode > 2 or (mode < 2 and turn):
            return False
        if mode == 2:
            value = joined(last[k : k + 4])
            for i in range(size):
                delta = joined(deltas[k : k + 4, i])
                value ^= (delta >> turn | delta << (32 - turn)) & 0xFFFFFFFF
                for b in range(4):
                    out[i, k + b] = value >> 8 * b & 0xFF
            continue
        width = mode + 1
        for b in range(k, k + 4, width):
            value = joined(last[b : b + width])
            for i in range(size):
                value += unzigzag(joined(deltas[b : b + width, i]))
                for j in range(width):
                    out[i, b + j] = value >> 8 * j & 0xFF
    last[:] = out[size - 1]
    return True

"""Marker takes for tests: a performer who wears markers, and C3D files of every flavour."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.library import generic_face
from mien.numeric.rotation import from_vector
from mien.performance.marker_take import MarkerTake

Array = NDArray[np.float64]

WORN = {
    "ChinBot": "2.1", "ChinMid": "2.10", "LChin": "2.11", "RChin": "2.12", "LBrowIn": "4.1",
    "RBrowIn": "4.2", "LBrowMid": "4.3", "RBrowMid": "4.4", "LBrowOut": "4.5", "RBrowOut": "4.6",
    "LCheek": "5.1", "RCheek": "5.2", "LCheekBone": "5.3", "RCheekBone": "5.4", "LipUp": "8.1",
    "LipLow": "8.2", "LMouth": "8.3", "RMouth": "8.4", "LLipUp": "8.5", "RLipUp": "8.6",
    "LLipLow": "8.7", "RLipLow": "8.8", "LNostril": "9.1", "RNostril": "9.2", "NoseTip": "9.3",
    "RNoseRoot": "9.6", "LNoseRoot": "9.7", "FhMid": "11.1",
}  # fmt: skip
"""Label: the feature point it sits at."""
JIG = ("JigTop", "JigL", "JigR")
RATE = 120.0


def act(frames: int = 600, noise: float = 0.1, seed: int = 0) -> tuple[MarkerTake, Array, Array]:
    """The generic face in markers and a jig acts some of its shapes and moves its head; it rests
    for the first half second, and often. Returns the take, where the face's markers truly are in
    the head (F, M, 3) and their neutral (M, 3), mm."""
    random = np.random.default_rng(seed)
    generic = generic_face()
    rows = generic.face.points.index(list(WORN.values()))
    neutral = generic.face.points.at(generic.face.vertices)[rows]
    chosen = ("jawOpen", "mouthSmileLeft", "mouthSmileRight", "browInnerUp", "mouthPucker")
    fields = generic.face.points.at(np.stack([generic.keys[name] for name in chosen]))[:, rows]
    time = np.arange(frames) / RATE
    knots = random.uniform(0.0, 0.8, (frames // 40 + 3, len(chosen)))
    knots *= random.random(knots.shape) < 0.4
    knots[:3] = 0.0
    levels = np.stack([np.interp(time, np.arange(len(knots)) / 3.0, knot) for knot in knots.T], 1)
    kernel = np.hanning(25) / np.hanning(25).sum()
    levels = np.stack([np.convolve(level, kernel, "same") for level in levels.T], 1)
    levels[:50] = 0.0
    true = neutral + np.tensordot(levels, fields, axes=1)
    jig = np.array([[0.0, 130.0, 20.0], [70.0, 100.0, 10.0], [-60.0, 95.0, 15.0]])
    worn = np.concatenate([true, np.broadcast_to(jig, (frames, 3, 3))], axis=1)
    nod = np.stack([0.2 * np.sin(time), 0.15 * np.sin(1.7 * time), 0.05 * np.sin(0.6 * time)], 1)
    places = (
        worn @ np.swapaxes(from_vector(nod), 1, 2) + [100.0, -50.0, 1200.0] + 20.0 * nod[:, None]
    )
    places += noise * random.standard_normal(places.shape)
    return MarkerTake((*WORN, *JIG), time, places, source="act"), true, neutral


def c3d(
    take: MarkerTake,
    path: Path,
    *,
    units: str | None = "mm",
    integer: bool = False,
    processor: int = 84,
    labels: Sequence[str] | None = None,
) -> Path:
    """Write a take as a C3D of floats or integers, as Intel (84), DEC (85) or MIPS (86) has it;
    frames are counted from 1."""
    order = ">" if processor == 86 else "<"
    frames, count = take.places.shape[:2]
    scale = 0.05 if integer else -1.0

    def real(values: NDArray[np.floating]) -> bytes:
        if processor == 85:
            halves = (values.astype("<f4") * 4).view("<u2").reshape(-1, 2)
            return np.ascontiguousarray(halves[:, ::-1]).tobytes()
        return values.astype(order + "f4").tobytes()

    def number(value: float) -> tuple[int, list[int], bytes]:
        return 4, [], real(np.array([value]))

    def word(value: int) -> tuple[int, list[int], bytes]:
        return 2, [], struct.pack(order + "H", value)

    def text(rows: Sequence[str]) -> tuple[int, list[int], bytes]:
        width = max(len(row) for row in rows)
        return -1, [width, len(rows)], "".join(row.ljust(width) for row in rows).encode()

    parameters = {
        "USED": word(count),
        "SCALE": number(scale),
        "RATE": number(take.rate),
        "DATA_START": word(0),
        "FRAMES": word(frames % 65536),
        "LABELS": text(labels or take.labels),
    }
    if units is not None:
        parameters["UNITS"] = text([units])
    section = bytes([1, 0x50, 0, processor]) + struct.pack("bb", 5, -1) + b"POINT"
    section += struct.pack(order + "h", 3) + b"\0"
    for name, (kind, shape, data) in parameters.items():
        body = struct.pack("b", kind) + bytes([len(shape), *shape]) + data + b"\0"
        section += struct.pack("bb", len(name), 1) + name.encode()
        section += struct.pack(order + "h", len(body) + 2) + body
    section += b"\0\0"
    section += b"\0" * (-len(section) % 512)
    block = 2 + len(section) // 512
    header = bytes([2, 0x50]) + struct.pack(order + "5H", count, 0, 1, min(frames, 65535), 0)
    header += real(np.array([scale])) + struct.pack(order + "2H", block, 0)
    header += real(np.array([take.rate]))
    seen = np.isfinite(take.places).all(axis=-1)
    rows = np.zeros((frames, count, 4))
    rows[..., :3] = np.nan_to_num(take.places)
    rows[..., 3] = np.where(seen, 0.0, -1.0)
    if integer:
        rows[..., :3] = np.rint(rows[..., :3] / scale)
        data = rows.astype(order + "i2").tobytes()
    else:
        data = real(rows)
    path.write_bytes(header.ljust(512, b"\0") + section + data)
    return path

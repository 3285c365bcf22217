"""A performance while it happens: a ``.take`` file, appended frame by frame.

    line 1     "mien take 1"
    line 2     JSON: what does not change (points, neutral, sigma, spans, rest, names)
    then       one record a frame: CRC-32, and the frame's numbers as little-endian float64

A record that is cut or damaged ends the take: what was written before it is whole. Every frame is
handed to the operating system at once, so that a crash of the program loses nothing that was
written; twice a second it is forced to the disk.
"""

from __future__ import annotations

import json
import os
import struct
import zlib
from pathlib import Path
from time import monotonic
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError, OutputError
from mien.formats.takes.mien_file import MAX_FRAMES, MAX_HEADER_BYTES, MAX_NAMES, MAX_POINTS
from mien.performance.performance import Performance, Span

MAGIC = b"mien take 1\n"
_TO_DISK = 0.5
"""Seconds between two moments at which the disk has everything."""
_LARGEST = 1e6

Array = NDArray[np.float64]


class Recorder:
    """Writes frames of one performer as they come."""

    def __init__(self, path: Path, header: Performance) -> None:
        """``header`` is any performance of the performer. Raises OutputError."""
        self._path = path
        self._scalars = tuple(sorted(header.scalars))
        self._width = _width(len(header.points), len(self._scalars), header.shapes.shape[1])
        self._flushed = monotonic()
        try:
            self._file: BinaryIO = path.open("wb")
            self._file.write(MAGIC + json.dumps(_about(header, self._scalars)).encode() + b"\n")
        except OSError as error:
            raise OutputError(f"{path}: cannot be written ({error.strerror})") from error

    def close(self) -> None:
        """Nothing more will come."""
        self._file.close()

    def write(self, performance: Performance) -> None:
        """Append all frames of ``performance``. Raises OutputError; ValueError where it is not of
        the header's kind."""
        rows = np.concatenate(_columns(performance, self._scalars), axis=1).astype("<f8")
        if rows.shape[1] != self._width:
            raise ValueError("the frames have other fields than the recording")
        try:
            for row in rows:
                body = row.tobytes()
                self._file.write(struct.pack("<I", zlib.crc32(body)) + body)
            self._file.flush()
            if monotonic() - self._flushed > _TO_DISK:
                os.fsync(self._file.fileno())
                self._flushed = monotonic()
        except OSError as error:
            raise OutputError(f"{self._path}: cannot be written ({error.strerror})") from error


def read_recording(path: Path) -> Performance:
    """Read a ``.take`` file, as far as it is whole. Raises InputError where there is none,
    FormatError where there is no whole frame in it."""
    try:
        with path.open("rb") as file:
            about, scalars, width = _read_about(file)
            records = _read_records(file, width)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: not a recorded take ({str(error).splitlines()[0]})") from error
    if not len(records):
        raise FormatError(f"{path}: no whole frame was recorded")
    return _assemble(about, scalars, records)


def _about(header: Performance, scalars: tuple[str, ...]) -> dict[str, Any]:
    return {
        "points": list(header.points),
        "neutral": header.neutral.tolist(),
        "sigma": header.sigma.tolist(),
        "rest_rotation": header.rest_rotation.tolist(),
        "rest_translation": header.rest_translation.tolist(),
        "spans": [[s.first, s.second, s.axis, s.sigma] for s in header.spans],
        "scalars": list(scalars),
        "vocabulary": header.vocabulary,
        "weights": int(header.shapes.shape[1]),
        "source": header.source,
    }


def _width(points: int, scalars: int, weights: int) -> int:
    return 1 + 3 * points + 9 + 3 + 4 + 1 + 1 + 3 + scalars + weights


def _columns(performance: Performance, scalars: tuple[str, ...]) -> list[Array]:
    """(F, n) each, in the order of a record."""
    frames = len(performance)
    fields = (
        performance.time,
        performance.motion,
        performance.rotation,
        performance.translation,
        performance.gaze,
        performance.confidence,
        performance.lost,
        performance.unseen,
    )
    columns = [np.asarray(field, dtype=float).reshape(frames, -1) for field in fields]
    columns += [performance.scalars[name][:, None] for name in scalars]
    if performance.vocabulary:
        columns.append(performance.shapes)
    return columns


def _read_about(file: BinaryIO) -> tuple[dict[str, Any], tuple[str, ...], int]:
    if file.readline(len(MAGIC)) != MAGIC:
        raise ValueError("its first line is another's")
    about = json.loads(file.readline(MAX_HEADER_BYTES))
    scalars = tuple(str(name) for name in about["scalars"])
    points, weights = len(about["points"]), int(about["weights"])
    if not (points <= MAX_POINTS and len(scalars) <= MAX_NAMES and 0 <= weights <= MAX_NAMES):
        raise ValueError("more points or names than a take should have")
    for name, shape in (
        ("neutral", (points, 3)),
        ("sigma", (points, 3)),
        ("rest_rotation", (3, 3)),
        ("rest_translation", (3,)),
    ):
        about[name] = np.array(about[name], dtype=float).reshape(shape)
        if not (np.abs(about[name]) < _LARGEST).all():
            raise ValueError(f"{name} is beyond all bounds")
    about["points"] = tuple(str(name) for name in about["points"])
    about["spans"] = tuple(
        Span(str(a), str(b), int(c), float(d)) for a, b, c, d in about["spans"][:MAX_NAMES]
    )
    if not {name for span in about["spans"] for name in (span.first, span.second)} <= set(
        about["points"]
    ):
        raise ValueError("a span between points that are not there")
    about["vocabulary"], about["source"] = str(about["vocabulary"]), str(about["source"])
    return about, scalars, _width(points, len(scalars), weights if about["vocabulary"] else 0)


def _read_records(file: BinaryIO, width: int) -> Array:
    """(F, width) the records up to the first that is not whole, without those that go back in
    time."""
    rows: list[Array] = []
    while len(rows) < MAX_FRAMES:
        record = file.read(4 + 8 * width)
        if len(record) < 4 + 8 * width or struct.unpack("<I", record[:4])[0] != zlib.crc32(
            record[4:]
        ):
            break
        rows.append(np.frombuffer(record, "<f8", offset=4))
    records = np.array(rows).reshape(len(rows), width)
    if not (np.abs(records) < _LARGEST).all():
        raise ValueError("a number beyond all bounds")
    latest = np.maximum.accumulate(records[:, 0])
    return records[np.diff(latest, prepend=-np.inf) > 0.0]


def _assemble(about: dict[str, Any], scalars: tuple[str, ...], records: Array) -> Performance:
    frames, points = len(records), len(about["points"])
    ends = np.cumsum([1, 3 * points, 9, 3, 4, 1, 1, 3, len(scalars)])
    parts = np.split(records, ends, axis=1)
    time, motion, rotation, translation, gaze, confidence, lost, unseen, values, shapes = parts
    return Performance(
        points=about["points"],
        neutral=about["neutral"],
        time=time[:, 0] - time[0, 0],
        motion=motion.reshape(frames, points, 3),
        sigma=about["sigma"],
        rotation=rotation.reshape(frames, 3, 3),
        translation=translation,
        gaze=gaze.reshape(frames, 2, 2),
        confidence=confidence[:, 0],
        lost=lost[:, 0] != 0.0,
        unseen=unseen,
        rest_rotation=about["rest_rotation"],
        rest_translation=about["rest_translation"],
        spans=about["spans"],
        scalars={name: values[:, i] for i, name in enumerate(scalars)},
        vocabulary=about["vocabulary"],
        shapes=shapes if about["vocabulary"] else np.zeros((0, 0)),
        source=about["source"],
    )

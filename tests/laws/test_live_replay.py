"""What phones streamed and recorded, sent to us again: it drives our characters."""

from __future__ import annotations

import gzip
import os
import socket
import struct
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from mien.face.library import CHARACTERS, load_character
from mien.live.inputs import Receiver
from mien.live.stage import Moment, Stage
from mien.recipe import animate, load_performance

RECORDED = Path(os.environ.get("MIEN_TEST_DATA", ""), "livelink")
pytestmark = pytest.mark.skipif(
    "MIEN_TEST_DATA" not in os.environ, reason="MIEN_TEST_DATA names no recorded streams"
)


def framed(path: Path) -> Iterator[bytes]:
    """Packets of Live Link VTuber's recordings: their count, then each with its size."""
    blob = gzip.decompress(path.read_bytes())
    (count,) = struct.unpack_from(">I", blob, 1)
    place = 5
    for _ in range(count):
        (size,) = struct.unpack_from(">I", blob, place)
        yield blob[place + 4 : place + 4 + size]
        place += 4 + size


def raw(path: Path) -> Iterator[bytes]:
    """Payloads one after the other: 319 bytes with a face, 74 without."""
    blob, place = path.read_bytes(), 0
    while place < len(blob):
        size = 319 if blob[place + 74 : place + 75] == b"\x3d" else 74
        yield blob[place : place + size]
        place += size


def replayed(protocol: str, packets: list[bytes], character: str) -> tuple[list[Moment], int]:
    """What ``character`` does when ``packets`` arrive over the network, and how many were
    refused."""
    receiver = Receiver(protocol, "127.0.0.1", 0)
    stage, moments = Stage([load_character(character)], speak=True), []

    def listen() -> None:
        for frame in receiver:
            moments.append(stage.hear(frame))

    listening = threading.Thread(target=listen)
    listening.start()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as phone:
        for number, packet in enumerate(packets, start=1):
            phone.sendto(packet, ("127.0.0.1", receiver.port))
            waited = time.monotonic()
            while len(moments) < number and time.monotonic() < waited + 20.0:
                time.sleep(0.001)
    receiver.stop()
    listening.join(5)
    return moments, receiver.refused


@pytest.mark.parametrize(
    ("name", "count", "character"),
    [("llv_dao.gesichter", 180, "monkey"), ("animoji_livelink.udp", 567, "toy")],
)
def test_recorded_packets_drive_a_character(name: str, count: int, character: str) -> None:
    read = framed if name.endswith(".gesichter") else raw
    moments, refused = replayed("livelink", list(read(RECORDED / name)), character)
    assert (len(moments), refused) == (count, 0)
    acting = [moment.curves[character] for moment in moments if moment.curves]
    weights = np.concatenate([curves.weights for curves in acting])
    heads = np.concatenate([curves.rotation for curves in acting])
    assert (np.ptp(weights, axis=0) > 0.2).sum() >= 6
    assert weights.max() <= 1.5
    assert np.ptp(heads[:, 0, 2]) > 0.05


def test_recorded_ifacialmocap_frames_drive_a_character() -> None:
    lines = (RECORDED / "ifacialmocap_frames.txt").read_bytes().splitlines()
    lines = [line for line in lines if line]
    moments, refused = replayed("ifacialmocap", lines, "woman")
    assert (len(moments), refused) == (len(lines), 0)
    assert moments[-1].state == "following"
    assert moments[-1].arkit is not None
    assert moments[-1].arkit.shapes.max() > 0.1


@pytest.mark.parametrize("character", CHARACTERS)
def test_recorded_takes_animate_every_character(character: str) -> None:
    takes = sorted(RECORDED.glob("*.csv"))
    assert len(takes) == 2
    for take in takes:
        performance = load_performance(take)
        curves = animate(performance, character)
        assert len(curves) == len(performance) > 900
        assert np.isfinite(curves.weights).all()
        assert (np.ptp(curves.weights, axis=0) > 0.2).sum() >= 5

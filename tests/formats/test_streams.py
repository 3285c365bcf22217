"""Streams: what we send comes back through our own readers and through others'."""

from __future__ import annotations

import gzip
import os
import struct
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pythonosc.osc_packet import OscPacket

from mien.errors import FormatError
from mien.formats.streams import ifacialmocap, livelink, openseeface, vmc
from mien.numeric.rotation import angle_between, from_vector
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.vocabulary.arkit import names
from mien.vocabulary.livelink import stream_columns

SHAPES = np.linspace(0.0, 1.0, 52)
FRAME = ArkitFrame(
    time=2.0,
    shapes=SHAPES,
    rotation=from_vector(np.array([0.1, -0.3, 0.2])),
    translation=np.array([5.0, -7.0, -400.0]),
    gaze=np.array([[0.2, -0.1], [0.15, 0.05]]),
)
RECORDED = Path(os.environ.get("MIEN_TEST_DATA", ""), "livelink")
recorded = pytest.mark.skipif(
    "MIEN_TEST_DATA" not in os.environ, reason="MIEN_TEST_DATA names no recorded streams"
)


def test_livelink_comes_back() -> None:
    datagram = livelink.encode(FRAME, 120)
    assert len(datagram) == 26 + 4 + 4 + 244
    back = livelink.Decoder().decode(datagram)
    assert back.time == 2.0
    np.testing.assert_allclose(back.shapes, FRAME.shapes, atol=1e-6)
    np.testing.assert_allclose(back.gaze, FRAME.gaze, atol=1e-6)
    assert angle_between(back.rotation, FRAME.rotation) < 1e-6


def test_livelink_bytes_are_where_the_layout_says() -> None:
    datagram = livelink.encode(FRAME, 7, subject="subject", device="id")
    assert datagram[0] == 6
    assert struct.unpack_from(">i2si7s", datagram, 1) == (2, b"id", 7, b"subject")
    place = 1 + 4 + 2 + 4 + 7
    assert struct.unpack_from(">ifii", datagram, place) == (7, 0.0, 60, 1)
    assert datagram[place + 16] == 61
    told = dict(
        zip(stream_columns(), struct.unpack_from(">61f", datagram, place + 17), strict=True)
    )
    assert told["EyeBlinkLeft"] == pytest.approx(SHAPES[names().index("eyeBlinkLeft")])
    # Plus is to the subject's right, and down.
    assert told["LeftEyeYaw"] == pytest.approx(-0.2)
    assert told["LeftEyePitch"] == pytest.approx(0.1)


def test_livelink_without_a_face_ends_early_and_keeps_the_last_look() -> None:
    decoder = livelink.Decoder()
    decoder.decode(livelink.encode(FRAME, 1))
    lost = ArkitFrame(0.0, np.zeros(52), seen=False)
    datagram = livelink.encode(lost, 2)
    assert len(datagram) == 25 + 4 + 4
    back = decoder.decode(datagram)
    assert not back.seen
    np.testing.assert_allclose(back.shapes, FRAME.shapes, atol=1e-6)


def test_livelink_sides_swap_when_asked() -> None:
    shapes = np.zeros(52)
    shapes[names().index("jawLeft")] = 1.0
    back = livelink.Decoder(swap_sideways=True).decode(livelink.encode(ArkitFrame(0.0, shapes), 0))
    assert back.shapes[names().index("jawRight")] == 1.0
    assert back.shapes.sum() == 1.0


@recorded
def test_recorded_livelink_packets_are_read() -> None:
    blob = gzip.decompress((RECORDED / "llv_dao.gesichter").read_bytes())
    (count,) = struct.unpack_from(">I", blob, 1)
    frames, place, decoder = [], 5, livelink.Decoder()
    for _ in range(count):
        (size,) = struct.unpack_from(">I", blob, place)
        frames.append(decoder.decode(blob[place + 4 : place + 4 + size]))
        place += 4 + size
    performance = performance_of(frames, "llv")
    assert len(performance) == 180
    assert performance.time[-1] == pytest.approx(186 / 60, abs=1 / 60)
    looks = performance.shapes[:, names().index("eyeLookInLeft")]
    looks = looks - performance.shapes[:, names().index("eyeLookOutLeft")]
    # Looking inwards is looking right for the left eye.
    assert np.corrcoef(looks, -performance.gaze[:, 0, 0])[0, 1] > 0.98


@recorded
def test_a_recorded_stream_with_a_lost_face_is_read() -> None:
    blob = (RECORDED / "animoji_livelink.udp").read_bytes()
    # Raw payloads without framing: a packet without a face is 74 bytes, one with is 319.
    frames, place, decoder = [], 0, livelink.Decoder()
    while place < len(blob):
        size = 319 if blob[place + 74 : place + 75] == b"\x3d" else 74
        frames.append(decoder.decode(blob[place : place + size]))
        place += size
    assert (len(frames), sum(not frame.seen for frame in frames)) == (567, 7)


def test_ifacialmocap_comes_back() -> None:
    datagram = ifacialmocap.encode(FRAME)
    assert b"eyeBlink_L&" in datagram
    back = ifacialmocap.Decoder().decode(datagram, time=3.0)
    assert (back.time, back.seen) == (3.0, True)
    np.testing.assert_allclose(back.shapes, FRAME.shapes, atol=1e-4)
    np.testing.assert_allclose(back.gaze, FRAME.gaze, atol=1e-5)
    np.testing.assert_allclose(back.translation, FRAME.translation, atol=1e-3)
    assert angle_between(back.rotation, FRAME.rotation) < 1e-5


def test_ifacialmocap_keeps_what_a_packet_leaves_out() -> None:
    decoder = ifacialmocap.Decoder()
    decoder.decode(b"jawOpen-40|mouthLeft-10|=head#0,10,0|leftEye#0,5,0|")
    back = decoder.decode(b"jawOpen&55|")
    at = names().index
    assert back.shapes[at("jawOpen")] == pytest.approx(0.55)
    assert back.shapes[at("mouthLeft")] == pytest.approx(0.10)
    assert back.gaze[0, 0] == pytest.approx(np.radians(5))


@recorded
def test_recorded_ifacialmocap_frames_are_read() -> None:
    lines = (RECORDED / "ifacialmocap_frames.txt").read_bytes().splitlines()
    first, second = (ifacialmocap.Decoder().decode(line) for line in lines[:2])
    at = names().index
    assert first.shapes[at("eyeLookInLeft")] == pytest.approx(0.25)
    # The first looks down and to the subject's right, the second to the left: so say both the
    # look weights and the angles.
    assert (first.gaze[:, 0] < 0).all()
    assert (first.gaze[:, 1] < 0).all()
    assert (second.gaze[:, 0] > 0).all()


def test_vmc_comes_back() -> None:
    decoder, frames = vmc.Decoder(), []
    for datagram in vmc.encode(FRAME):
        assert len(datagram) <= 1400
        frames += decoder.decode(datagram, time=4.0)
    (back,) = frames
    np.testing.assert_allclose(back.shapes, FRAME.shapes, atol=1e-6)
    np.testing.assert_allclose(back.gaze, FRAME.gaze, atol=1e-6)
    assert angle_between(back.rotation, FRAME.rotation) < 1e-6


def test_vmc_is_understood_by_python_osc() -> None:
    messages = [
        timed.message for datagram in vmc.encode(FRAME) for timed in OscPacket(datagram).messages
    ]
    assert messages[-1].address == "/VMC/Ext/Blend/Apply"
    blends = {m.params[0]: m.params[1] for m in messages if m.address == "/VMC/Ext/Blend/Val"}
    assert blends["EyeBlinkLeft"] == pytest.approx(SHAPES[names().index("eyeBlinkLeft")])
    assert {"A", "I", "U", "E", "O", "Joy", "Angry", "Sorrow", "Fun", "Blink_L"} <= blends.keys()
    assert all(0.0 <= weight <= 1.0 for weight in blends.values())
    bones = {m.params[0]: m.params[1:] for m in messages if m.address == "/VMC/Ext/Bone/Pos"}
    assert {"Head", "LeftEye", "RightEye"} == bones.keys()
    assert np.linalg.norm(bones["Head"][3:]) == pytest.approx(1.0)
    # A head turned to its left turns about Unity's -y.
    turned = ArkitFrame(0.0, np.zeros(52), rotation=from_vector(np.array([0.0, 0.4, 0.0])))
    told = [t.message for d in vmc.encode(turned) for t in OscPacket(d).messages]
    head = next(
        m.params for m in told if m.address == "/VMC/Ext/Bone/Pos" and m.params[0] == "Head"
    )
    assert head[5] == pytest.approx(-np.sin(0.2))


def test_vmc_presets_stand_in_for_a_sender_without_arkit() -> None:
    from pythonosc.osc_message_builder import OscMessageBuilder

    decoder, frames = vmc.Decoder(), []
    for address, *arguments in (
        ("/VMC/Ext/Blend/Val", "Blink_L", 1.0),
        ("/VMC/Ext/Blend/Val", "Blink", 0.5),
        ("/VMC/Ext/Blend/Apply",),
    ):
        builder = OscMessageBuilder(address)
        for argument in arguments:
            builder.add_arg(argument)
        frames += decoder.decode(builder.build().dgram)
    (frame,) = frames
    assert frame.shapes[names().index("eyeBlinkLeft")] == 1.0
    assert frame.shapes[names().index("eyeBlinkRight")] == 0.0


def test_openseeface_has_its_size_and_its_sides() -> None:
    face = openseeface.SeenFace(
        time=1.5,
        size=(640, 480),
        openness=(0.25, 0.75),
        seen=True,
        rotation=np.eye(3),
        translation=np.array([1.0, 2.0, 3.0]),
        picture=np.arange(136.0).reshape(68, 2),
        places=np.ones((70, 3)),
        features=np.linspace(-1, 1, 14),
    )
    datagram = openseeface.encode(face)
    assert len(datagram) == openseeface.BYTES == 1785
    assert struct.unpack_from("<di4fB", datagram) == (1.5, 0, 640.0, 480.0, 0.75, 0.25, 1)
    assert struct.unpack_from("<4f", datagram, 33) == (0.0, 0.0, 0.0, 1.0)
    assert struct.unpack_from("<2f", datagram, 345 + 8) == (2.0, 3.0)
    assert struct.unpack_from("<3f", datagram, 889) == (1.0, -1.0, -1.0)
    assert struct.unpack_from("<14f", datagram, 1729)[13] == 1.0


DECODERS = {
    "livelink": livelink.Decoder().decode,
    "ifacialmocap": ifacialmocap.Decoder().decode,
    "vmc": vmc.Decoder().decode,
}
REAL = {
    "livelink": livelink.encode(FRAME, 3),
    "ifacialmocap": ifacialmocap.encode(FRAME),
    "vmc": vmc.encode(FRAME)[0],
}


@pytest.mark.parametrize("name", DECODERS)
@settings(deadline=None)
@given(st.data())
def test_hostile_datagrams_are_refused_or_read(name: str, data: st.DataObject) -> None:
    real = bytearray(REAL[name])
    for place in data.draw(st.lists(st.integers(0, len(real) - 1), max_size=6)):
        real[place] = data.draw(st.integers(0, 255))
    broken = bytes(real[: data.draw(st.integers(0, len(real)))])
    for datagram in (broken, data.draw(st.binary(max_size=200))):
        with suppress(FormatError):
            DECODERS[name](datagram)

"""Live work: newest frame wins, and what is stepped is what offline work gives."""

from __future__ import annotations

import socket
import struct
import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mien.capture.shapes import motion_from_shapes
from mien.errors import InputError
from mien.face.library import generic_face, load_character
from mien.formats.streams import livelink, vmc
from mien.formats.streams.openseeface import BYTES
from mien.formats.takes.recording import read_recording
from mien.live.inputs import Receiver
from mien.live.newest import Newest
from mien.live.openseeface import seen_face
from mien.live.outputs import Sender, address
from mien.live.run import run
from mien.live.stage import Stage
from mien.mapping import MAPPERS, Settings
from mien.mapping.beside import beside
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.performance.filters import Smoother
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.trace import Trace
from mien.vocabulary.arkit import names


def smiling(frames: int = 12) -> list[ArkitFrame]:
    shapes = np.zeros((frames, 52))
    shapes[:, names().index("mouthSmileLeft")] = np.linspace(0.0, 0.9, frames)
    shapes[:, names().index("eyeBlinkRight")] = np.linspace(0.0, 1.0, frames)
    return [ArkitFrame(i / 30, row) for i, row in enumerate(shapes)]


class Replayed:
    """A stepper that has seen it all before."""

    trace = Trace()

    def __init__(self, performance: Performance) -> None:
        self._performance, self._frame = performance, 0

    def step(self, frame: Frame) -> Performance:
        self._frame += 1
        return self._performance[self._frame - 1 : self._frame]

    def look_around(self) -> None: ...
    def learn(self) -> None: ...
    def close(self) -> None: ...


def test_stepped_frames_give_the_weights_of_the_whole_take() -> None:
    man = load_character("man")
    take = replace(
        motion_from_shapes(performance_of(smiling(), "test"), generic_face()), vocabulary=""
    )
    stage = Stage([man], Replayed(take))
    blank = np.zeros((4, 4, 3), dtype=np.uint8)
    moments = [stage.see(Frame(blank, float(moment))) for moment in take.time]
    mapped = MAPPERS["cardinal"](man, take, Settings())(take)
    whole = Smoother()(beside(mapped, take, man))
    for frame, moment in enumerate(moments):
        assert moment.curves is not None
        curves = moment.curves["man"]
        np.testing.assert_allclose(curves.weights[0], whole.weights[frame], atol=1e-6)
        np.testing.assert_allclose(curves.rotation[0], whole.rotation[frame], atol=1e-6)
    assert whole.weights.max() > 0.3


def test_what_is_heard_moves_a_character_and_passes_on_unchanged() -> None:
    stage = Stage([load_character("toy")], speak=True)
    moments = [stage.hear(frame) for frame in smiling()]
    assert all(moment.state == "following" for moment in moments)
    last = moments[-1]
    assert last.arkit is not None
    np.testing.assert_array_equal(last.arkit.shapes, smiling()[-1].shapes)
    weights = dict(zip(last.curves["toy"].names, last.curves["toy"].weights[0], strict=True))
    smile = {side: weights[f"smile_mouth_{side}"] for side in "LR"}
    assert smile["L"] > 0.3 > smile["R"] + 0.1


def test_a_lost_face_is_told_and_comes_back() -> None:
    stage = Stage((), speak=True)
    first, *others = smiling()
    states = [stage.hear(replace(first, seen=False)).state, stage.hear(first).state]
    states += [stage.hear(replace(others[0], seen=False)).state, stage.hear(others[1]).state]
    assert states == ["waiting", "following", "lost", "following"]


def test_newest_wins_and_what_was_passed_over_is_counted() -> None:
    slot: Newest[int] = Newest()
    for number in range(5):
        slot.put(number)
    assert (slot.take(), slot.dropped) == (4, 4)
    assert slot.take(timeout=0.01) is None
    slot.close()
    assert slot.finished


def test_what_breaks_a_source_is_raised_where_frames_are_taken() -> None:
    def broken():
        yield smiling()[0]
        raise InputError("the camera is gone")

    with pytest.raises(InputError, match="the camera is gone"):
        run(broken(), Stage())


def test_a_run_sends_records_and_counts(tmp_path: Path) -> None:
    def paced():
        for frame in smiling():
            time.sleep(0.01)
            yield frame

    listener = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    listener.bind(("127.0.0.1", 0))
    listener.settimeout(5)
    port = listener.getsockname()[1]
    sender = Sender("livelink", "127.0.0.1", port)
    tally = run(paced(), Stage((), speak=True), outputs=[sender], record=tmp_path / "a.take")
    heard = [livelink.Decoder().decode(listener.recv(2048)) for _ in range(tally.frames)]
    sender.close()
    listener.close()
    assert tally.frames + tally.dropped == 12
    assert tally.following == tally.frames == tally.recorded
    np.testing.assert_allclose(heard[-1].shapes, smiling()[-1].shapes, atol=1e-6)
    assert len(read_recording(tmp_path / "a.take")) == tally.frames


def test_a_receiver_hears_what_a_sender_says_and_passes_over_noise() -> None:
    receiver = Receiver("vmc", "127.0.0.1", 0)
    heard: list[ArkitFrame] = []
    listening = threading.Thread(target=lambda: heard.extend(receiver))
    listening.start()
    noise = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    noise.sendto(b"\xff" * 40, ("127.0.0.1", receiver.port))
    sender = Sender("vmc", "127.0.0.1", receiver.port)
    sender.send(smiling()[-1])
    for _ in range(100):
        if heard and receiver.refused:
            break
        time.sleep(0.02)
    receiver.stop()
    listening.join(5)
    sender.close()
    noise.close()
    assert receiver.refused == 1
    np.testing.assert_allclose(heard[-1].shapes, smiling()[-1].shapes, atol=1e-6)


def test_openseeface_sees_a_winking_face_where_it_is() -> None:
    face = seen_face(smiling()[-1])
    assert face.openness == (1.0, 0.0)
    # Its first point is at the subject's right ear, which is left in the picture, and so is the
    # right pupil; brows are above the chin.
    assert face.picture[0, 0] < face.picture[16, 0]
    assert face.picture[66, 0] < face.picture[67, 0]
    assert face.picture[17:27, 1].max() < face.picture[8, 1]
    assert len(face.places) == 70
    assert (BYTES - 1785) == 0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("127.0.0.1:4000", ("127.0.0.1", 4000)),
        ("10.0.0.2", ("10.0.0.2", vmc.PORT)),
        (":5000", ("127.0.0.1", 5000)),
        ("[::1]:7", ("::1", 7)),
        ("[::1]", ("::1", vmc.PORT)),
    ],
)
def test_addresses_are_read(text: str, expected: tuple[str, int]) -> None:
    assert address(text, vmc.PORT) == expected


@pytest.mark.parametrize("text", ["a:b", "a:0", "a:70000"])
def test_addresses_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"port|invalid literal"):
        address(text, vmc.PORT)


def test_a_busy_port_is_one_line() -> None:
    first = Receiver("livelink", "127.0.0.1", 0)
    with pytest.raises(InputError, match="is another program there"):
        Receiver("livelink", "127.0.0.1", first.port)
    first.stop()
    list(first)


def test_numbers_of_a_stream_count_up() -> None:
    numbers = [
        struct.unpack_from(">i", livelink.encode(smiling()[0], n, device="d"), 14)[0]
        for n in (0, 1, 2)
    ]
    assert numbers == [0, 1, 2]

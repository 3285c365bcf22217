"""Sound: read where it is heard, cut and joined, kept as WAV."""

from __future__ import annotations

import wave
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.formats.pictures.sound import RATE, read_sound, write_sound

SECONDS, PITCH = 4.0, 440.0


@pytest.fixture(scope="module")
def film(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four seconds of grey, with a tone from 1 to 3 s."""
    path = tmp_path_factory.mktemp("film") / "tone.mkv"
    with av.open(str(path), "w") as container:
        pictures = container.add_stream("mpeg4", rate=25)
        pictures.width, pictures.height, pictures.pix_fmt = 64, 64, "yuv420p"
        sound = container.add_stream("pcm_s16le", rate=RATE)
        sound.layout = "mono"
        for _ in range(int(25 * SECONDS)):
            grey = np.full((64, 64, 3), 99, np.uint8)
            container.mux(pictures.encode(av.VideoFrame.from_ndarray(grey, "rgb24")))
        container.mux(pictures.encode(None))
        time = np.arange(int(SECONDS * RATE)) / RATE
        tone = np.sin(2 * np.pi * PITCH * time) * ((time >= 1.0) & (time < 3.0))
        for first in range(0, len(tone), 1470):
            piece = (9000 * tone[first : first + 1470]).astype(np.int16)[None]
            frame = av.AudioFrame.from_ndarray(piece, "s16", "mono")
            frame.sample_rate, frame.pts, frame.time_base = RATE, first, Fraction(1, RATE)
            container.mux(sound.encode(frame))
        container.mux(sound.encode(None))
    return path


def loud(samples: NDArray[np.int16]) -> NDArray[np.bool_]:
    """Whether each tenth of a second can be heard."""
    tenths = samples[: len(samples) // (RATE // 10) * (RATE // 10)].reshape(-1, RATE // 10)
    return np.asarray(np.abs(tenths.astype(float)).mean(axis=1) > 1000.0)


def test_sound_is_heard_where_it_is(film: Path) -> None:
    heard = read_sound(film, 0.5, 3.5)
    assert len(heard) == 3 * RATE
    assert loud(heard).tolist() == [False] * 5 + [True] * 20 + [False] * 5
    spectrum = np.abs(np.fft.rfft(heard[RATE : 2 * RATE].astype(float)))
    assert spectrum.argmax() == PITCH


def test_stretches_are_joined(film: Path, tmp_path: Path) -> None:
    assert write_sound(film, [(2.5, 3.5), (0.8, 1.2)], tmp_path / "a.wav")
    with wave.open(str(tmp_path / "a.wav")) as file:
        assert (file.getframerate(), file.getnchannels()) == (RATE, 1)
        heard = np.frombuffer(file.readframes(file.getnframes()), "<i2")
    assert loud(heard).tolist() == [True] * 5 + [False] * 7 + [True] * 2


def test_silence_is_no_file(film: Path, tmp_path: Path) -> None:
    assert not write_sound(film, [(0.0, 0.5)], tmp_path / "a.wav")
    (tmp_path / "b.mp4").write_bytes(b"no film at all")
    assert not write_sound(tmp_path / "b.mp4", [(0.0, 0.5)], tmp_path / "a.wav")
    assert not (tmp_path / "a.wav").exists()

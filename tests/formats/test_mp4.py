"""Films we write, decoded again: pictures, times and sound."""

from __future__ import annotations

from pathlib import Path

import av
import numpy as np
import pytest

from mien.formats.pictures.mp4 import Sound, write_mp4
from mien.performance.frame import Frame

TIMES = np.cumsum([0.0, 0.033, 0.041, 0.02, 0.1, 0.033, 0.05, 0.04, 0.033, 0.25, 0.033, 0.033])
RATE = 22_050


def frames(width: int = 64, height: int = 48) -> list[Frame]:
    """Grey pictures that grow brighter, with a red left half."""
    pictures = []
    for i, time in enumerate(TIMES):
        image = np.full((height, width, 3), 40 + 12 * i, dtype=np.uint8)
        image[:, : width // 2, 1:] = 0
        pictures.append(Frame(image, float(time)))
    return pictures


def decoded(path: Path) -> tuple[np.ndarray, list[np.ndarray]]:
    with av.open(str(path)) as container:
        shown = list(container.decode(video=0))
    return np.array([f.time for f in shown]), [f.to_ndarray(format="rgb24") for f in shown]


@pytest.fixture
def beep(tmp_path: Path) -> Path:
    """Two seconds of sound in which a tone begins at one second."""
    path = tmp_path / "beep.wav"
    time = np.arange(2 * RATE) / RATE
    wave = np.where(time < 1.0, 0.0, 0.5 * np.sin(2 * np.pi * 440 * time))
    with av.open(str(path), "w") as container:
        stream = container.add_stream("pcm_s16le", rate=RATE, layout="mono")
        frame = av.AudioFrame.from_ndarray(
            (wave * 32767).astype(np.int16)[None], format="s16", layout="mono"
        )
        frame.sample_rate = RATE
        container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


def test_pictures_come_back_at_their_own_times(tmp_path: Path) -> None:
    write_mp4(tmp_path / "a.mp4", frames())
    times, pictures = decoded(tmp_path / "a.mp4")
    np.testing.assert_allclose(times, TIMES, atol=1e-4)
    for frame, picture in zip(frames(), pictures, strict=True):
        # Away from the border of the colours, which are stored at half size.
        np.testing.assert_allclose(picture[:, :24], frame.image[:, :24], atol=9)
        np.testing.assert_allclose(picture[:, 40:], frame.image[:, 40:], atol=9)


def test_odd_sizes_lose_a_row_or_a_column(tmp_path: Path) -> None:
    write_mp4(tmp_path / "a.mp4", frames(65, 49))
    assert decoded(tmp_path / "a.mp4")[1][0].shape == (48, 64, 3)


@pytest.mark.parametrize("start", [0.0, 0.7])
def test_sound_stays_with_the_pictures(tmp_path: Path, beep: Path, start: float) -> None:
    write_mp4(tmp_path / "a.mp4", frames(), Sound(beep, start))
    with av.open(str(tmp_path / "a.mp4")) as container:
        blocks = [(f.time, f.to_ndarray(), f.sample_rate) for f in container.decode(audio=0)]
    time = np.concatenate([t + np.arange(a.shape[1]) / rate for t, a, rate in blocks])
    loud = np.abs(np.concatenate([a[0] for _, a, _ in blocks])) > 0.2
    length = TIMES[-1] + 0.033
    assert time[-1] == pytest.approx(length, abs=0.045)
    if start:
        assert time[loud][0] == pytest.approx(1.0 - start, abs=0.01)
    else:
        assert not loud.any()


def test_a_take_without_sound_has_none(tmp_path: Path) -> None:
    write_mp4(tmp_path / "mute.mp4", frames())
    (tmp_path / "text.txt").write_text("no sound at all")
    for source in ("mute.mp4", "text.txt", "missing.mp4"):
        write_mp4(tmp_path / "a.mp4", frames(), Sound(tmp_path / source))
        with av.open(str(tmp_path / "a.mp4")) as container:
            assert [stream.type for stream in container.streams] == ["video"]


def test_a_film_of_nothing_is_refused_and_leaves_nothing(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="at least one frame"):
        write_mp4(tmp_path / "a.mp4", [])
    assert not list(tmp_path.iterdir())


def test_an_interruption_leaves_nothing(tmp_path: Path) -> None:
    def interrupted():
        yield from frames()[:3]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_mp4(tmp_path / "a.mp4", interrupted())
    assert not list(tmp_path.iterdir())

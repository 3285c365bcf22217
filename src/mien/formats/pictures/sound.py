"""The sound of a recording: one channel, read in stretches, and kept as a WAV file."""

from __future__ import annotations

import wave
from collections.abc import Sequence
from pathlib import Path

import av
import numpy as np
from av.audio.resampler import AudioResampler
from numpy.typing import NDArray

from mien.errors import FormatError
from mien.formats.atomic import whole_file
from mien.formats.pictures.video import open_container

RATE = 44100
"""Samples a second."""
Samples = NDArray[np.int16]
Stretch = tuple[float, float]
"""Seconds of a recording, from its first picture: first and last."""


def write_sound(recording: Path, stretches: Sequence[Stretch], path: Path) -> bool:
    """Write what is heard in ``stretches`` of a ``recording``, one after the other, as a WAV file;
    False, and no file, where nothing can be heard. Raises OutputError."""
    heard = [read_sound(recording, *stretch) for stretch in stretches]
    if not any(samples.any() for samples in heard):
        return False
    with whole_file(path) as temporary, wave.open(str(temporary), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(RATE)
        file.writeframes(np.concatenate(heard).astype("<i2").tobytes())
    return True


def read_sound(recording: Path, first: float, last: float) -> Samples:
    """(N,) what is heard from ``first`` to ``last`` seconds, counted from the first picture;
    silence where there is none, or where it cannot be decoded."""
    samples = np.zeros(max(round((last - first) * RATE), 0), dtype=np.int16)
    try:
        with open_container(recording) as container:
            if not container.streams.audio or not container.streams.video:
                return samples
            stream = container.streams.audio[0]
            pictures = container.streams.video[0]
            origin = float((pictures.start_time or 0) * (pictures.time_base or 0))
            container.seek(int(max(origin + first - 0.5, 0.0) * av.time_base))
            resampler = AudioResampler(format="s16", layout="mono", rate=RATE)
            for frame in container.decode(stream):
                begin = float(frame.time or 0.0) - origin - first
                if begin > last - first:
                    break
                for piece in resampler.resample(frame):
                    _lay(samples, piece.to_ndarray()[0], round(begin * RATE))
                    begin += piece.samples / RATE
    except (av.FFmpegError, FormatError, ValueError):
        pass  # sound is a companion: what is heard so far is kept, and pictures do not wait for it
    return samples


def _lay(samples: Samples, piece: Samples, at: int) -> None:
    """Put a piece where it is heard, as far as it is inside."""
    low, high = max(at, 0), min(at + len(piece), len(samples))
    if low < high:
        samples[low:high] = piece[low - at : high - at]

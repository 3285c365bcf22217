"""Pictures and the take's own sound as an MP4 that plays everywhere (H.264, AAC)."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from av.audio.frame import AudioFrame
from av.audio.resampler import AudioResampler
from av.audio.stream import AudioStream
from av.container import OutputContainer
from av.video.frame import VideoFrame
from av.video.reformatter import ColorRange, Colorspace
from av.video.stream import VideoStream
from numpy.typing import NDArray

from mien.formats.atomic import whole_file
from mien.performance.frame import Frame

_TICKS = 90_000
"""Of the video's clock a second: every usual rate to 6 microseconds."""
_RATE = 48_000
"""Samples of sound a second."""
_VIDEO_OPTIONS = {"preset": "veryfast", "crf": "20"}
_BT709 = {"color_primaries": 1, "color_trc": 1, "colorspace": 1, "color_range": 1}


@dataclass(frozen=True, slots=True)
class Sound:
    """Where a take's sound is."""

    path: Path
    start: float = 0.0
    """The file's own time at which the take begins, seconds."""


def write_mp4(path: Path, frames: Iterable[Frame], sound: Sound | None = None) -> None:
    """Write ``frames``, all of one size, each at its own time, to ``path``.

    An odd last row or column is left out, for H.264 halves its colours. ``sound`` is cut to the
    length of the pictures; where the file has none, or it breaks off, so does the result.
    Raises OutputError; ValueError where there are no frames.
    """
    # Fast start: a browser plays it before all of it is there.
    options = {"movflags": "+faststart"}
    with whole_file(path) as temporary, av.open(str(temporary), "w", options=options) as container:
        _write(container, frames, sound)


def _write(container: OutputContainer, frames: Iterable[Frame], sound: Sound | None) -> None:
    pictures = iter(frames)
    frame = next(pictures, None)
    if frame is None:
        raise ValueError("a film needs at least one frame")
    video = _video_stream(container, frame.image)
    track = None if sound is None else _Track(container, sound)
    time, step = frame.time, 1.0 / 30.0
    while frame is not None:
        container.mux(video.encode(_encodable(frame, video)))
        if track is not None:
            track.play_until(frame.time)
        if frame.time > time:
            time, step = frame.time, frame.time - time
        frame = next(pictures, None)
    container.mux(video.encode(None))
    if track is not None:
        track.play_until(time + step)
        track.close()


def _video_stream(container: OutputContainer, image: NDArray[np.uint8]) -> VideoStream:
    stream = container.add_stream("libx264", rate=30, options=_VIDEO_OPTIONS)
    context = stream.codec_context
    context.time_base = Fraction(1, _TICKS)
    context.height, context.width = image.shape[0] & ~1, image.shape[1] & ~1
    context.pix_fmt = "yuv420p"
    for name, value in _BT709.items():
        setattr(context, name, value)
    return stream


def _encodable(frame: Frame, stream: VideoStream) -> VideoFrame:
    image = np.ascontiguousarray(frame.image[: stream.height, : stream.width])
    picture = VideoFrame.from_ndarray(image, format="rgb24").reformat(
        format="yuv420p",
        dst_colorspace=Colorspace.ITU709,
        dst_color_range=ColorRange.MPEG,
    )
    picture.pts = round(frame.time * _TICKS)
    picture.time_base = Fraction(1, _TICKS)
    return picture


class _Track:
    """The sound of a take, encoded as far as the pictures have come."""

    def __init__(self, container: OutputContainer, sound: Sound) -> None:
        self._container = container
        self._stream: AudioStream | None = None
        self._blocks = _samples(sound)
        self._rest = np.zeros((2, 0), dtype=np.float32)
        self._next = 0
        first = next(self._blocks, None)
        if first is not None:
            self._next, self._rest = first
            self._stream = container.add_stream("aac", rate=_RATE, layout="stereo")

    def play_until(self, time: float) -> None:
        """Mux what sounds before ``time``, seconds from the start of the take."""
        if self._stream is None:
            return
        end = round(time * _RATE)
        while self._next < end:
            if not self._rest.shape[1]:
                block = next(self._blocks, None)
                if block is None:
                    return
                # Blocks are taken as one unbroken run: gaps of a recording are its clock's.
                self._rest = block[1]
            count = min(end - self._next, self._rest.shape[1])
            frame = AudioFrame.from_ndarray(
                np.ascontiguousarray(self._rest[:, :count]), format="fltp", layout="stereo"
            )
            frame.sample_rate, frame.pts = _RATE, self._next
            frame.time_base = Fraction(1, _RATE)
            self._container.mux(self._stream.encode(frame))
            self._rest, self._next = self._rest[:, count:], self._next + count

    def close(self) -> None:
        self._blocks.close()
        if self._stream is not None:
            self._container.mux(self._stream.encode(None))


def _samples(sound: Sound) -> Generator[tuple[int, NDArray[np.float32]], None, None]:
    """Stereo samples (2, N) from the start of the take, each with the index of its first."""
    resampler = AudioResampler(format="fltp", layout="stereo", rate=_RATE)
    try:
        with av.open(
            f"file:{sound.path}", options={"protocol_whitelist": "file"}, metadata_errors="replace"
        ) as container:
            stream = container.streams.best("audio")
            if not isinstance(stream, AudioStream):
                return
            for decoded in container.decode(stream):
                start = round((float(decoded.time or 0.0) - sound.start) * _RATE)
                for frame in resampler.resample(decoded):
                    samples = np.asarray(frame.to_ndarray(), dtype=np.float32)
                    if start + samples.shape[1] > 0:
                        yield max(0, start), samples[:, max(0, -start) :]
                    start += samples.shape[1]
    except (av.FFmpegError, ValueError):
        # Sound that breaks off in the middle is no reason to show nothing.
        return

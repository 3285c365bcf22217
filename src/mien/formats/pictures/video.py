"""Video files, decoded with PyAV."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import av
import numpy as np
from av.container import InputContainer
from av.video.frame import VideoFrame
from av.video.stream import VideoStream
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.pictures.ahead import read_ahead
from mien.performance.frame import Frame

MAX_SIDE = 8192
"""Pixels; larger pictures are refused before they are allocated."""
MAX_FRAMES = 1_000_000
"""Over four hours at 60 frames a second."""

_CONTAINERS = "mov,matroska,avi,mpegts,mpeg,asf,flv,ogg,mxf,gif,yuv4mpegpipe,h264,hevc,ivf"
"""What may be opened: a playlist or a script that calls itself .mp4 could name other files."""
_SEEK_BEYOND = 10.0
"""Seconds; an earlier start is reached faster by decoding up to it."""


@dataclass(frozen=True, slots=True)
class Orientation:
    """How stored pictures become upright: transposed first, then flipped."""

    transpose: bool = False
    flip_x: bool = False
    flip_y: bool = False

    def upright(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The (H, W, 3) picture as it is meant to be seen."""
        if self.transpose:
            image = image.transpose(1, 0, 2)
        image = image[:: -1 if self.flip_y else 1, :: -1 if self.flip_x else 1]
        return np.ascontiguousarray(image)


@dataclass(frozen=True, slots=True)
class Video:
    """The pictures of a video file: upright, with square pixels, at the times the file gives.

    Iterating decodes afresh, a few pictures ahead in a thread of its own. Time counts from the
    first picture that is yielded. Raises FormatError when the file turns out to be broken.
    """

    path: Path
    size: tuple[int, int]
    """(width, height) upright, square pixels."""
    rate: float
    """Frames a second, on average."""
    count: int | None
    """Frames to expect between ``start`` and ``end``, by the container's own account."""
    start: float
    """Seconds from the first picture of the file."""
    end: float
    """Seconds from the first picture of the file; infinity for all of it."""
    orientation: Orientation
    origin: float
    """The file's own time of its first picture, seconds."""

    @property
    def name(self) -> str:
        return str(self.path)

    @property
    def begin(self) -> float:
        """The file's own time at which the part from ``start`` begins: its sound's, too."""
        return self.origin + self.start

    def __iter__(self) -> Iterator[Frame]:
        return read_ahead(self._frames())

    def _frames(self) -> Generator[Frame, None, None]:
        first: float | None = None
        latest = -1.0
        shown = 0
        for frame, stamp in _decoded(self):
            time = stamp - self.origin
            if time < self.start - 1e-6 or time <= latest:
                continue
            if time >= self.end:
                break
            first = time if first is None else first
            latest = time
            shown += 1
            if shown > MAX_FRAMES:
                raise FormatError(
                    f"{self.path}: more than {MAX_FRAMES} frames; choose a part with --start, --end"
                )
            yield Frame(self._picture(frame), time - first)
        require_frames(self.name, shown, self.start, self.end)

    def _picture(self, frame: VideoFrame) -> NDArray[np.uint8]:
        width, height = self.size if not self.orientation.transpose else self.size[::-1]
        # A take whose size changes half-way (calls over the web) goes on at its first size.
        rgb = frame.reformat(width=width, height=height, format="rgb24")
        return self.orientation.upright(np.asarray(rgb.to_ndarray(), dtype=np.uint8))


def open_video(
    path: Path, start: float = 0.0, end: float = float("inf"), mirror: bool = False
) -> Video:
    """Look into a video file: its size, rate and first picture.

    ``start`` and ``end`` are seconds from the first picture; ``mirror`` undoes the flip of a
    selfie take. Phone rotation (display matrix) and pixel aspect are honoured.
    Raises FormatError.
    """
    with open_container(path) as container:
        stream = _stream(container, path)
        _check_side(path, stream.width, stream.height)
        _check_whole(path, stream)
        first = _first(container, stream, path)
        orientation = _orientation(first)
        size = _square(first.width, first.height, stream, orientation)
        _check_side(path, *size)
        rate = float(stream.average_rate or stream.guessed_rate or 30)
        total = _total(container, stream, rate)
        if mirror:
            orientation = Orientation(
                orientation.transpose, not orientation.flip_x, orientation.flip_y
            )
        return Video(
            path=path,
            size=size,
            rate=rate,
            count=None if total is None else _between(total, rate, start, end),
            start=start,
            end=end,
            orientation=orientation,
            origin=float(first.time or 0.0),
        )


def require_frames(name: str, shown: int, start: float, end: float) -> None:
    """A performance is a change: raise InputError where fewer than two frames were seen."""
    if shown >= 2:
        return
    if start > 0.0 or end < float("inf"):
        raise InputError(
            f"{name}: {shown or 'no'} frame{'s' * (shown != 1)} between --start and --end; "
            "a performance needs at least two"
        )
    held = "one picture" if shown else "no pictures"
    raise FormatError(f"{name}: holds {held}; a performance needs at least two frames")


def _decoded(video: Video) -> Iterator[tuple[VideoFrame, float]]:
    """Frames with the file's own times, in the order they are shown."""
    with open_container(video.path) as container:
        stream = _stream(container, video.path)
        stream.thread_type = "AUTO"
        sought = video.start > _SEEK_BEYOND
        if sought:
            container.seek(int((video.origin + video.start - 1.0) * av.time_base))
        packets = 0
        stamp = video.origin - 1.0 / video.rate
        try:
            for packet in container.demux(stream):
                packets += packet.size > 0
                for frame in packet.decode():
                    told = frame.time
                    stamp = stamp + 1.0 / video.rate if told is None else float(told)
                    yield frame, stamp
        except (av.FFmpegError, ValueError) as error:
            seconds = stamp - video.origin
            raise FormatError(
                f"{video.path}: cannot be decoded beyond {seconds:.2f} s ({_said(error)}); "
                "encode it again, or stop before that with --end"
            ) from error
        if not sought:
            _check_ended(video, container, stream, packets, stamp)


def open_container(path: Path) -> InputContainer:
    """A video file under ffmpeg's roof: kinds that are known, and no file beside it. Raises
    FormatError."""
    options = {"format_whitelist": _CONTAINERS, "protocol_whitelist": "file"}
    try:
        return av.open(f"file:{path}", options=options, metadata_errors="replace")
    except (av.FFmpegError, ValueError) as error:
        raise FormatError(
            f"{path}: not a video, or one that was cut off ({_said(error)}); "
            "copy it again, or save it as MP4"
        ) from error


def _stream(container: InputContainer, path: Path) -> VideoStream:
    stream = container.streams.best("video")
    if not isinstance(stream, VideoStream):
        raise FormatError(f"{path}: holds no pictures; name a video")
    context: Any = stream.codec_context
    if context is None:
        raise FormatError(f"{path}: its pictures are in a code that is not known; save it as MP4")
    return stream


def _first(container: InputContainer, stream: VideoStream, path: Path) -> VideoFrame:
    try:
        for frame in container.decode(stream):
            return frame
    except (av.FFmpegError, ValueError) as error:
        raise FormatError(
            f"{path}: its first picture cannot be decoded ({_said(error)}); encode it again"
        ) from error
    raise FormatError(f"{path}: holds no pictures; a performance needs at least two frames")


def _said(error: Exception) -> str:
    return (getattr(error, "strerror", None) or str(error)).splitlines()[0].lower()


def _check_side(path: Path, width: int, height: int) -> None:
    if not (0 < width <= MAX_SIDE and 0 < height <= MAX_SIDE):
        raise FormatError(
            f"{path}: pictures of {width} x {height} pixels; 1 to {MAX_SIDE} a side can be read"
        )


def _check_whole(path: Path, stream: VideoStream) -> None:
    """An index that points past the end of the file tells at once that the file was cut."""
    entries = stream.index_entries
    if len(entries) and entries[-1].pos + entries[-1].size > path.stat().st_size:
        raise FormatError(f"{path}: the file is cut off before its end; copy it again")


def _check_ended(
    video: Video, container: InputContainer, stream: VideoStream, packets: int, last: float
) -> None:
    """FFmpeg ends a damaged file as quietly as a whole one: compare with what was promised."""
    seen = last - video.origin + 1.0 / video.rate
    promised = _seconds(container, stream)
    short_of_frames = packets < 0.99 * stream.frames
    # Matroska's duration counts from time zero, not from its first picture.
    reached = seen + max(video.origin, 0.0)
    short_of_time = promised is not None and reached < 0.99 * promised - 0.5
    if short_of_frames or (not stream.frames and short_of_time):
        raise FormatError(
            f"{video.path}: broken or cut off after {seen:.2f} s; "
            f"copy it again, or use that part with --end {max(seen - 0.05, 0.0):.2f}"
        )


def _seconds(container: InputContainer, stream: VideoStream) -> float | None:
    """How long the pictures last by the container's account; None where only sound may tell."""
    if stream.duration is not None and stream.time_base is not None:
        return float(stream.duration * stream.time_base)
    if container.duration is not None and len(container.streams) == 1:
        return container.duration / av.time_base
    return None


def _total(container: InputContainer, stream: VideoStream, rate: float) -> int | None:
    if stream.frames:
        return stream.frames
    seconds = _seconds(container, stream)
    if seconds is None and container.duration is not None:
        seconds = container.duration / av.time_base
    return None if seconds is None else round(seconds * rate)


def _between(total: int, rate: float, start: float, end: float) -> int:
    return max(0, min(total, round(min(end, total / rate) * rate)) - round(start * rate))


def _square(
    width: int, height: int, stream: VideoStream, orientation: Orientation
) -> tuple[int, int]:
    """Upright (width, height) once the stored pixels are made square."""
    aspect = stream.sample_aspect_ratio or stream.codec_context.sample_aspect_ratio
    if aspect:
        width = round(width * aspect)
    return (height, width) if orientation.transpose else (width, height)


def _orientation(frame: VideoFrame) -> Orientation:
    """Read the display matrix: x' = a x + c y, y' = b x + d y in pixels, 16.16 fixed point."""
    data: Any = frame.side_data.get("DISPLAYMATRIX")
    if data is None:
        return Orientation()
    a, b, _, c, d = np.frombuffer(data, dtype=np.int32)[:5].tolist()
    if abs(a) + abs(d) >= abs(b) + abs(c):
        return Orientation(False, flip_x=a < 0, flip_y=d < 0)
    return Orientation(True, flip_x=c < 0, flip_y=b < 0)

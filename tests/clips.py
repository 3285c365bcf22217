"""Little videos for tests: four coloured quarters, so that every flip and turn shows."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
from numpy.typing import NDArray

RED, GREEN, BLUE, WHITE = (220, 30, 30), (30, 200, 30), (30, 30, 220), (235, 235, 235)


def quarters(width: int = 64, height: int = 48) -> NDArray[np.uint8]:
    """Red, green above; blue, white below."""
    image = np.empty((height, width, 3), np.uint8)
    image[: height // 2, : width // 2] = RED
    image[: height // 2, width // 2 :] = GREEN
    image[height // 2 :, : width // 2] = BLUE
    image[height // 2 :, width // 2 :] = WHITE
    return image


def corners(image: NDArray[np.uint8]) -> list[str]:
    """Colour names of the four quarters, top left, top right, bottom left, bottom right."""
    palette = {"red": RED, "green": GREEN, "blue": BLUE, "white": WHITE}
    height, width = image.shape[:2]
    seen = [image[y * height // 4, x * width // 4] for y in (1, 3) for x in (1, 3)]
    return [
        min(
            palette,
            key=lambda name: float(np.abs(np.subtract(pixel, palette[name], dtype=float)).sum()),
        )
        for pixel in seen
    ]


def write_video(
    path: Path,
    images: Sequence[NDArray[np.uint8]],
    times: Sequence[float] | None = None,
    *,
    codec: str = "libx264",
    pixels: str = "yuv420p",
    aspect: Fraction | None = None,
    rotation: int = 0,
    first: float = 0.0,
    options: dict[str, str] | None = None,
) -> Path:
    """``images`` at ``times`` (30 a second when absent), beginning at ``first`` seconds."""
    height, width = images[0].shape[:2]
    with av.open(str(path), "w", options=options or {}) as container:
        stream = container.add_stream(codec, rate=30)
        stream.width, stream.height, stream.pix_fmt = width, height, pixels
        stream.codec_context.time_base = Fraction(1, 90000)
        stream.time_base = Fraction(1, 90000)
        if aspect is not None:
            stream.codec_context.sample_aspect_ratio = aspect
        if rotation:
            stream.set_display_rotation(rotation)
        for i, image in enumerate(images):
            frame = av.VideoFrame.from_ndarray(image, format="rgb24")
            frame.pts = round((first + (i / 30 if times is None else times[i])) * 90000)
            frame.time_base = Fraction(1, 90000)
            container.mux(stream.encode(frame))
        container.mux(stream.encode())
    return path


def noise(count: int, width: int = 96, height: int = 64, seed: int = 0) -> list[NDArray[np.uint8]]:
    """Pictures that do not compress, so that a cut falls among them."""
    random = np.random.default_rng(seed)
    return [random.integers(0, 255, (height, width, 3), dtype=np.uint8) for _ in range(count)]

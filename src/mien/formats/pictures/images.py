"""Pictures: a folder of them as a recording, and one as a result."""

from __future__ import annotations

import re
import warnings
from collections.abc import Generator, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps, UnidentifiedImageError

from mien.errors import FormatError, InputError
from mien.formats.atomic import whole_file
from mien.formats.pictures.ahead import read_ahead
from mien.formats.pictures.video import MAX_FRAMES, MAX_SIDE, require_frames
from mien.performance.frame import Frame

ENDINGS = frozenset({".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp"})


@dataclass(frozen=True, slots=True)
class ImageFolder:
    """The pictures of a folder in natural order of their names, turned as their EXIF says."""

    path: Path
    files: tuple[Path, ...]
    size: tuple[int, int]
    """(width, height) of every picture, upright."""
    rate: float
    """Frames a second; a folder does not tell, so the caller does."""
    start: float
    end: float
    mirror: bool

    @property
    def name(self) -> str:
        return str(self.path)

    @property
    def count(self) -> int:
        return len(self.files)

    def __iter__(self) -> Iterator[Frame]:
        return read_ahead(self._frames())

    def _frames(self) -> Generator[Frame, None, None]:
        for i, file in enumerate(self.files):
            image = _load(file)
            if image.shape[1::-1] != self.size:
                raise FormatError(
                    f"{file}: {image.shape[1]} x {image.shape[0]} pixels, but {self.files[0].name} "
                    f"is {self.size[0]} x {self.size[1]}; a take needs pictures of one size"
                )
            if self.mirror:
                image = np.ascontiguousarray(image[:, ::-1])
            yield Frame(image, i / self.rate)
        require_frames(self.name, len(self.files), self.start, self.end)


def open_images(
    path: Path,
    start: float = 0.0,
    end: float = float("inf"),
    mirror: bool = False,
    rate: float = 30.0,
) -> ImageFolder:
    """List the pictures of a folder; ``start`` and ``end`` in seconds at ``rate`` pictures each.

    Raises FormatError.
    """
    try:
        files = sorted(
            (file for file in path.iterdir() if file.suffix.lower() in ENDINGS), key=_natural
        )
    except OSError as error:
        raise FormatError(f"{path}: the folder cannot be listed ({error.strerror})") from error
    if not files:
        raise FormatError(f"{path}: no pictures in this folder ({', '.join(sorted(ENDINGS))})")
    if len(files) > MAX_FRAMES:
        raise FormatError(f"{path}: more than {MAX_FRAMES} pictures; split the folder")
    kept = [f for i, f in enumerate(files) if start - 1e-6 <= i / rate < end]
    require_frames(str(path), len(kept), start, end)
    height, width = _load(kept[0]).shape[:2]
    return ImageFolder(path, tuple(kept), (width, height), rate, start, end, mirror)


def write_image(path: Path, image: NDArray[np.uint8]) -> None:
    """Write a picture (H, W, 3) RGB; the ending chooses the format.

    Raises InputError for an ending that is none of a picture, OutputError.
    """
    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{path}: no ending of a picture; there are {', '.join(sorted(ENDINGS))}")
    with whole_file(path) as temporary:
        Image.fromarray(image).save(temporary)


def _natural(path: Path) -> tuple[list[tuple[bool, int, str]], str]:
    """frame2 before frame10."""
    runs = re.findall(r"[0-9]+|[^0-9]+", path.name.lower())
    return [(run.isdigit(), int(run) if run.isdigit() else 0, run) for run in runs], path.name


def _load(path: Path) -> NDArray[np.uint8]:
    """(H, W, 3) RGB as it is meant to be seen."""
    try:
        with warnings.catch_warnings(), Image.open(path) as picture:
            warnings.simplefilter("ignore")
            if max(picture.size) > MAX_SIDE:
                raise FormatError(
                    f"{path}: {picture.size[0]} x {picture.size[1]} pixels; "
                    f"at most {MAX_SIDE} a side can be read"
                )
            return np.asarray(ImageOps.exif_transpose(picture).convert("RGB"))
    except (UnidentifiedImageError, Image.DecompressionBombError) as error:
        raise FormatError(f"{path}: not a picture that can be read") from error
    except (OSError, SyntaxError, ValueError, EOFError) as error:
        raise FormatError(f"{path}: the picture is damaged ({error}); copy it again") from error

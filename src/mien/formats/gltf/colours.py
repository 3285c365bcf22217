"""The colours of a glTF file at its vertices: factor times picture, for previews."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mien.face.face import Array
from mien.formats.gltf.accessors import Accessors
from mien.formats.gltf.container import Json, referred
from mien.formats.gltf.nodes import numbers

_PLAIN = (0.6, 0.6, 0.6)
_LARGEST, _ENOUGH = 8192, 1024
"""Pixels a side of a picture that is read at all, and of what is needed of one."""


class Paint:
    """Pictures are read once and only as far as they can be shown."""

    def __init__(self, accessors: Accessors) -> None:
        self._accessors = accessors
        self._container = accessors.container
        self._pictures: dict[int, NDArray[np.uint8] | None] = {}
        self.notes: list[str] = []

    def colours(self, primitive: Json, count: int) -> Array:
        """(N, 3) linear RGB of a primitive of ``count`` vertices, grey where nothing is said."""
        materials = self._container.listed("materials")
        index = primitive.get("material")
        if type(index) is not int or not 0 <= index < len(materials):
            return np.tile(_PLAIN, (count, 1))
        surface = _dict(materials[index].get("pbrMetallicRoughness"))
        factor = surface.get("baseColorFactor", [1.0, 1.0, 1.0, 1.0])
        colours = np.tile(numbers(self._container, factor, 4, "baseColorFactor")[:3], (count, 1))
        texture = _dict(surface.get("baseColorTexture"))
        place = _dict(primitive.get("attributes")).get(f"TEXCOORD_{texture.get('texCoord', 0)}")
        picture = self._picture(texture.get("index"))
        if picture is not None and place is not None and self._accessors.count(place) == count:
            uv = self._accessors.read(place, 2).astype(float)
            colours *= _sampled(picture, _transformed(uv, texture))
        return np.clip(colours, 0.0, 1.0)

    def _picture(self, texture: object) -> NDArray[np.uint8] | None:
        textures, images = (self._container.listed(kind) for kind in ("textures", "images"))
        if type(texture) is not int or not 0 <= texture < len(textures):
            return None
        source = textures[texture].get("source")
        if type(source) is not int or not 0 <= source < len(images):
            return None
        if source not in self._pictures:
            self._pictures[source] = _decoded(self._content(images[source]))
            if self._pictures[source] is None:
                self.notes.append(f"images[{source}] cannot be shown; it stays in the file")
        return self._pictures[source]

    def _content(self, image: Json) -> bytes:
        if "bufferView" in image:
            return self._accessors.view_bytes(image["bufferView"])
        return referred(self._container, str(image.get("uri", "")))


def _dict(value: object) -> Json:
    return value if isinstance(value, dict) else {}


def _decoded(content: bytes) -> NDArray[np.uint8] | None:
    """(H, W, 3), or None for what is no picture or too large."""
    try:
        with warnings.catch_warnings(), Image.open(io.BytesIO(content)) as picture:
            warnings.simplefilter("ignore")
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            if max(picture.size) > _LARGEST:
                return None
            picture.draft("RGB", (_ENOUGH, _ENOUGH))
            return np.asarray(picture.convert("RGB"))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError, Warning):
        return None


def _transformed(uv: Array, texture: Json) -> Array:
    """``uv`` (N, 2) by KHR_texture_transform, but for its rotation, which no avatar uses."""
    shift = _dict(_dict(texture.get("extensions")).get("KHR_texture_transform"))
    scale, offset = _pair(shift.get("scale"), 1.0), _pair(shift.get("offset"), 0.0)
    return np.asarray(uv * scale + offset)


def _pair(value: Any, usual: float) -> Array:
    if isinstance(value, list) and len(value) == 2 and all(type(x) in (int, float) for x in value):
        return np.array(value, dtype=float)
    return np.full(2, usual)


def _sampled(picture: NDArray[np.uint8], uv: Array) -> Array:
    """(N, 3) linear RGB of a picture at texture coordinates (N, 2), which repeat."""
    height, width = picture.shape[:2]
    column = np.clip(np.floor(uv[:, 0] % 1.0 * width), 0, width - 1).astype(int)
    row = np.clip(np.floor(uv[:, 1] % 1.0 * height), 0, height - 1).astype(int)
    value = picture[row, column] / 255.0
    return np.asarray(np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4))

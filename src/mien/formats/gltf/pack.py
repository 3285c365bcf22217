"""A glTF document and all it refers to as one GLB, so that nothing beside it is needed."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence

from mien.formats.gltf.container import Container, Json, referred

_KINDS = {b"\x89PNG": "image/png", b"\xff\xd8\xff": "image/jpeg"}


def packed(container: Container) -> bytes:
    """The bytes of a GLB with the same content. A GLB that needs nothing else comes back as it
    is."""
    if container.file is not None and _alone(container):
        return container.file
    document: Json = json.loads(json.dumps(container.document))
    chunks: list[bytes] = []
    starts: list[int] = []
    size = 0
    for content in container.buffers:
        starts.append(size)
        chunks.append(_padded(content or b"", b"\0"))
        size += len(chunks[-1])
    views = document.setdefault("bufferViews", [])
    for view in views:
        view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
        view["buffer"] = 0
    for image in document.get("images", []):
        if "uri" not in image:
            continue
        content = referred(container, str(image.pop("uri")))
        views.append({"buffer": 0, "byteOffset": size, "byteLength": len(content)})
        image["bufferView"] = len(views) - 1
        image.setdefault("mimeType", _kind(content))
        chunks.append(_padded(content, b"\0"))
        size += len(chunks[-1])
    return glb(document, b"".join(chunks))


def opened(file: bytes) -> tuple[Json, bytearray]:
    """Description and binary of a GLB that is sound."""
    size = struct.unpack_from("<I", file, 12)[0]
    document: Json = json.loads(file[20 : 20 + size])
    return document, bytearray(file[20 + size + 8 :])


def glb(document: Json, binary: bytes, others: Sequence[Json] = ()) -> bytes:
    """A GLB of ``document`` whose first buffer is ``binary``; ``others`` have no content."""
    if binary:
        document = document | {"buffers": [{"byteLength": len(binary)}, *others]}
    text = _padded(json.dumps(document, separators=(",", ":")).encode(), b" ")
    body = struct.pack("<I4s", len(text), b"JSON") + text
    if binary:
        binary = _padded(binary, b"\0")
        body += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def _alone(container: Container) -> bool:
    outside = [*container.listed("buffers"), *container.listed("images")]
    return all("uri" not in item for item in outside)


def _kind(content: bytes) -> str:
    return next((kind for head, kind in _KINDS.items() if content.startswith(head)), "image/png")


def _padded(chunk: bytes, filler: bytes) -> bytes:
    return chunk + filler * (-len(chunk) % 4)

"""The outside of a glTF file: JSON and the bytes it refers to, none of it believed.

Nothing is fetched and nothing outside the file's own folder is read.
"""

from __future__ import annotations

import base64
import binascii
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from mien.errors import FormatError, InputError

Json = dict[str, Any]

MAX_FILE = 128 * 2**20
_MAX_JSON = 32 * 2**20
_MAX_ITEMS = 200_000
_JSON, _BIN = 0x4E4F534A, 0x004E4942
MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_LISTS = (
    *("accessors", "animations", "bufferViews", "buffers", "images", "materials"),
    *("meshes", "nodes", "samplers", "scenes", "skins", "textures"),
)


@dataclass(frozen=True, slots=True)
class Container:
    """A document and its buffers."""

    path: Path
    document: Json
    buffers: tuple[bytes | None, ...]
    """None for one without content: what refers to it is compressed elsewhere."""
    file: bytes | None = None
    """The file itself, where it is a GLB that says what this does."""

    def fault(self, what: str) -> FormatError:
        """An error that names the file."""
        return FormatError(f"{self.path}: {what}")

    def listed(self, name: str) -> list[Any]:
        """A top level list of objects, empty where there is none."""
        found: list[Any] = self.document.get(name, [])
        return found

    def item(self, name: str, index: object) -> Json:
        """One object of a top level list. Raises FormatError where it is not there."""
        items = self.listed(name)
        if type(index) is not int or not 0 <= index < len(items):
            raise self.fault(f"names {name}[{index!r}] of {len(items)}; export it again")
        found: Json = items[index]
        return found


def open_gltf(path: Path) -> Container:
    """Read a .glb, .vrm or .gltf and what it refers to. Raises InputError, FormatError."""
    content = _read(path)
    binary = None
    if content[:4] == b"glTF":
        text, binary = _chunks(path, content)
    elif content[:1].isspace() or content[:1] in (b"{", b"["):
        text = content
    else:
        kind = "an empty file" if not content else "neither GLB nor glTF"
        raise FormatError(f"{path}: {kind}; export it again as GLB")
    document = _document(path, text)
    container = Container(path, document, ())
    buffers = tuple(
        _buffer(container, i, described, binary)
        for i, described in enumerate(container.listed("buffers"))
    )
    return Container(path, document, buffers, content if content[:4] == b"glTF" else None)


def _read(path: Path) -> bytes:
    try:
        size = path.stat().st_size
        if size > MAX_FILE:
            raise FormatError(f"{path}: {size >> 20} MB; at most {MAX_FILE >> 20} can be read")
        return path.read_bytes()
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error


def _chunks(path: Path, content: bytes) -> tuple[bytes, bytes | None]:
    """The JSON and the binary chunk of a GLB."""
    if len(content) < 20:
        raise FormatError(f"{path}: ends inside its header; copy it again")
    version, length = struct.unpack_from("<II", content, 4)
    if version != 2:
        raise FormatError(f"{path}: GLB version {version}; export it again as version 2")
    if length != len(content):
        raise FormatError(
            f"{path}: is {len(content)} bytes but says {length}; it was cut or changed on its way,"
            " copy it again"
        )
    found: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", content, place)
        if size > length - place - 8:
            raise FormatError(f"{path}: a chunk is longer than the file; copy it again")
        found.setdefault(kind, content[place + 8 : place + 8 + size])
        place += 8 + size
    if _JSON not in found:
        raise FormatError(f"{path}: a GLB without a description; export it again")
    return found[_JSON], found.get(_BIN)


def _document(path: Path, text: bytes) -> Json:
    if len(text) > _MAX_JSON:
        raise FormatError(f"{path}: its description alone is {len(text) >> 20} MB; refused")
    try:
        document = json.loads(text.decode("utf-8"))
    except RecursionError as error:
        raise FormatError(f"{path}: its description is nested beyond reason; refused") from error
    except ValueError as error:
        raise FormatError(
            f"{path}: its description is not JSON ({error}); copy or export it again"
        ) from error
    if not isinstance(document, dict):
        raise FormatError(f"{path}: its description is not an object; export it again")
    for name in _LISTS:
        items = document.get(name, [])
        if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
            raise FormatError(f"{path}: {name} is not a list of objects; export it again")
        if len(items) > _MAX_ITEMS:
            raise FormatError(f"{path}: {len(items)} {name}; more than any character has")
    version = document.get("asset")
    if not isinstance(version, dict) or str(version.get("version", "")).split(".")[0] != "2":
        raise FormatError(f"{path}: not glTF 2; export it again as version 2")
    return document


def _buffer(
    container: Container, index: int, described: Json, binary: bytes | None
) -> bytes | None:
    length, uri = described.get("byteLength"), described.get("uri")
    if type(length) is not int or length < 1:
        raise container.fault(f"buffers[{index}] has no length; export it again")
    if _is_fallback(described):
        return None
    if uri is None:
        content = binary if index == 0 else None
    elif isinstance(uri, str):
        content = referred(container, uri)
    else:
        raise container.fault(f"buffers[{index}].uri is not a text; export it again")
    if content is not None and len(content) < length:
        raise container.fault(
            f"buffers[{index}] is {len(content)} bytes but says {length}; copy it again"
        )
    return content


def _is_fallback(described: Json) -> bool:
    extensions = described.get("extensions")
    return isinstance(extensions, dict) and any(
        isinstance(extensions.get(name), dict) and extensions[name].get("fallback")
        for name in MESHOPT
    )


def view_span(container: Container, place: Json, what: str) -> tuple[bytes, int, int]:
    """A buffer's content, and where in it begins and ends what ``place`` (a bufferView, or a stream
    that stands for one) says. Raises FormatError that names ``what``."""
    number, start, length = (
        place.get("buffer", -1),
        place.get("byteOffset", 0),
        place.get("byteLength"),
    )
    container.item("buffers", number)
    content = container.buffers[number]
    if content is None:
        raise container.fault(f"{what} lies in a buffer without content; export it again")
    if type(start) is not int or type(length) is not int or start < 0 or length < 1:
        raise container.fault(f"{what} has no place or length; export it again")
    if start + length > len(content):
        raise container.fault(f"{what} ends past its buffer; copy or export it again")
    return content, start, start + length


def referred(container: Container, uri: str) -> bytes:
    """What a uri holds: data written into it, or a file in the document's folder."""
    if uri.startswith("data:"):
        head, comma, body = uri.partition(",")
        if not comma or not head.endswith(";base64"):
            raise container.fault("a data uri is not base64; export it again")
        try:
            return base64.b64decode(body, validate=True)
        except (binascii.Error, ValueError) as error:
            raise container.fault("a data uri is not base64; export it again") from error
    if "://" in uri:
        raise container.fault(f"refers to {uri[:80]!r}; mien fetches nothing, put it beside")
    folder = container.path.parent.resolve()
    try:
        file = (folder / unquote(uri)).resolve()
        inside = file.is_relative_to(folder)
    except (ValueError, OSError, RuntimeError) as error:
        raise container.fault(f"refers to {uri[:80]!r}, which is no file") from error
    if not inside:
        raise container.fault(f"refers to {uri[:80]!r} outside its own folder; refused")
    if not file.is_file():
        raise container.fault(f"refers to {uri[:80]!r}, which is not beside it")
    return _read(file)

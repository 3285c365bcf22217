"""Decode sound and damaged streams and print a digest of what came out: run with
NUMBA_DISABLE_JIT=1 the same loops are plain Python, which reads past no end."""

from __future__ import annotations

import base64
import hashlib
import json
import random
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

STREAMS = Path(__file__).parents[1] / "compressed" / "streams.json"


def streams() -> list[dict[str, Any]]:
    """What the reference encoder wrote, and what its decoder reads."""
    found: list[dict[str, Any]] = json.loads(STREAMS.read_text())
    return [
        told
        | {
            "stream": base64.b64decode(told["stream"]),
            "elements": zlib.decompress(base64.b64decode(told["elements"])),
        }
        for told in found
    ]


def damaged(seed: int) -> Iterator[dict[str, Any]]:
    """Streams with bytes changed, cut or added, and with another layout."""
    chance = random.Random(seed)
    for told in streams():
        stream = bytearray(told["stream"])
        for _ in range(chance.choice((1, 2, 8))):
            stream[chance.randrange(len(stream))] = chance.randrange(256)
        if chance.random() < 0.3:
            stream = stream[: chance.randrange(len(stream))]
        count = told["count"] * chance.choice((1, 1, 1, 2)) + chance.choice((0, 0, 3))
        yield told | {"stream": bytes(stream), "count": count}


def read(told: dict[str, Any]) -> bytes:
    """The elements, or what was said against them."""
    from mien.formats.gltf.meshopt import decode

    layout = told["count"], told["stride"], told["mode"], told["filter"]
    try:
        return decode(told["stream"], *layout)
    except ValueError as error:
        return str(error).encode()


def digest(rounds: int) -> str:
    """Of everything that is read in as many rounds."""
    found = hashlib.sha256()
    for told in [*streams(), *(told for seed in range(rounds) for told in damaged(seed))]:
        found.update(read(told))
    return found.hexdigest()


if __name__ == "__main__":
    print(digest(2))

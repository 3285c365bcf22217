"""What a worker does: one take is read, captured, or acted by one character.

Everything that is made goes through the store; between processes travel only names.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache, wraps
from pathlib import Path
from typing import Any, ParamSpec, TypeVar

import numpy as np
from numpy.typing import NDArray

from mien import recipe
from mien.batch.digest import digest_of
from mien.batch.order import Order, Role, version
from mien.batch.store import PERFORMANCE, PICTURE, Store, account_of, kept
from mien.errors import InputError, MienError
from mien.face.character import Character
from mien.formats.markers.file import holds_markers
from mien.formats.pictures.jpeg import encode_jpeg
from mien.formats.save import save
from mien.formats.takes.mien_file import read_performance, write_performance
from mien.performance.performance import Performance
from mien.report.pictures import has_pictures, of_character, of_take
from mien.report.reach import reach, spans, telling
from mien.rig.load import load_character

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")

PICTURES = 3
"""Moments of a take that are shown."""
_SIDE = 144
"""Pixels."""


class TaskError(MienError):
    """Why a task failed: one line, which travels between machines whatever it was made from."""


def _plainly(task: Callable[Arguments, Result]) -> Callable[Arguments, Result]:
    """Errors of libraries may not travel; a line of text does."""

    @wraps(task)
    def run(*arguments: Arguments.args, **options: Arguments.kwargs) -> Result:
        try:
            return task(*arguments, **options)
        except MienError as error:
            raise TaskError(str(error)) from None
        except Exception as error:
            line = (str(error) or "no reason given").splitlines()[0]
            raise TaskError(f"{type(error).__name__}: {line}") from error

    return run


@_plainly
def identify(take: str) -> str:
    """The digest of a take's content."""
    return digest_of(take)


@_plainly
def look(store: Store, take: str, digest: str, order: Order) -> None:
    """Capture a take once for all characters."""
    _same_version(order)
    performance = replace(_performance(take, order), source=f"take {digest[:12]}")
    frames = telling(performance, PICTURES)
    account = {
        "frames": len(performance),
        "seconds": round(float(performance.time[-1] - performance.time[0]), 3),
        "confidence": round(float(performance.confidence.mean()), 3),
        "lost_frames": int(performance.lost.sum()),
        "lost": [
            [round(first, 3), round(last, 3)]
            for first, last in spans(performance.lost, performance.time)
        ],
        "moments": frames,
        "pictures": has_pictures(take),
    }
    with kept(store.captures / order.capture_key(digest), account) as room:
        write_performance(performance, room / PERFORMANCE)
        if account["pictures"]:
            shown = of_take(take, performance, frames, _SIDE, **_cut(order))
            _write_strip(shown, room / PICTURE)


@_plainly
def act(store: Store, capture_key: str, role: Role, order: Order) -> None:
    """Let a character act what was captured."""
    _same_version(order)
    capture = store.captures / capture_key
    performance = read_performance(capture / PERFORMANCE)
    character = _character(role)
    curves = recipe.animate(performance, character, **order.acting)
    found = reach(performance, curves)
    account = {
        "character": role.name,
        "residual_mm": round(float(np.sqrt((found.residual**2).mean())), 4),
        "missing": round(found.missing, 4),
        "unreached_frames": int(found.unreached.sum()),
        "worst_second": round(float(performance.time[int(found.residual.argmax())]), 3),
    }
    with kept(store.results / order.result_key(capture_key, role), account) as room:
        for ending in order.formats:
            save(curves, room / f"{role.name}.{ending}", character)
        frames = account_of(capture)["moments"]
        _write_strip(list(of_character(character, curves, frames, _SIDE)), room / PICTURE)


def _performance(take: str, order: Order) -> Performance:
    if holds_markers(take):
        return recipe.capture_markers(take, **order.markers)[0]
    if Path(take).suffix.lower() in recipe.READERS:
        return recipe.load_performance(take)
    return recipe.capture(take, **order.looking)


def _cut(order: Order) -> dict[str, Any]:
    return {k: v for k, v in order.looking.items() if k in ("start", "mirror", "rate")}


@lru_cache(maxsize=8)
def _character(role: Role) -> Character:
    """A worker meets the same few characters again and again."""
    character = load_character(role.source)
    return replace(character, name=role.name)


def _same_version(order: Order) -> None:
    if version() != order.version:
        raise InputError(
            f"this worker runs mien {version()}, the batch {order.version}: install the same"
        )


def _write_strip(pictures: Sequence[NDArray[np.uint8]], path: Path) -> None:
    if pictures:
        path.write_bytes(encode_jpeg(np.hstack(pictures), _SIDE, 80))

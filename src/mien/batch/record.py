"""The account of a batch: every take by name, what became of it, and what it cost."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from mien.batch.dispatch import Count, Fate
from mien.batch.order import Order
from mien.batch.store import Store, account_of
from mien.formats.atomic import whole_file

RECORD = "batch.json"


@dataclass(frozen=True, slots=True)
class Run:
    """How a run went. The only place where a batch tells times."""

    started: str
    """ISO 8601, UTC."""
    seconds: float
    workers: int
    count: Count


def record(fates: Sequence[Fate], order: Order, store: Store, run: Run) -> dict[str, Any]:
    """All that is known of a batch, as JSON has it. Raises InputError where a result was
    damaged."""
    return {
        "mien": order.version,
        "characters": [role.name for role in order.roles],
        "formats": list(order.formats),
        "options": _said({**order.looking, **order.markers, **order.acting}),
        "run": asdict(run),
        "takes": [_take(fate, order, store) for fate in fates],
    }


def write_record(account: dict[str, Any], store: Store) -> None:
    """Write batch.json. Raises OutputError."""
    with whole_file(store.root / RECORD) as temporary:
        temporary.write_text(json.dumps(account, indent=1) + "\n", "utf-8")


def _take(fate: Fate, order: Order, store: Store) -> dict[str, Any]:
    told: dict[str, Any] = {"take": fate.take.path, "sha256": fate.digest, "name": fate.name}
    if fate.error:
        return told | {"error": fate.error}
    capture_key = order.capture_key(fate.digest)
    told |= account_of(store.captures / capture_key) | {"capture": f"captures/{capture_key}"}
    told["characters"] = []
    for role in order.roles:
        if role.name in fate.failed:
            told["characters"].append({"character": role.name, "error": fate.failed[role.name]})
            continue
        key = order.result_key(capture_key, role)
        files = [f"takes/{fate.name}/{file}" for file in store.made(key)]
        told["characters"].append(
            account_of(store.results / key) | {"result": f"results/{key}", "files": files}
        )
    return told


def _said(options: dict[str, Any]) -> dict[str, Any]:
    """Options that were given, in words."""
    return {
        name: value if isinstance(value, bool | int | float | str | list) else str(value)
        for name, value in options.items()
        if value not in (None, False)
    }

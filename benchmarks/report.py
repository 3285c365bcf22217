"""What every benchmark prints: a table for people and, with --json, one line for machines."""

from __future__ import annotations

import json
from collections.abc import Mapping

from rich.console import Console
from rich.table import Table


def show(
    name: str, title: str, figures: Mapping[str, float], as_json: bool, notes: str = ""
) -> None:
    """Print ``figures`` under ``title``; with ``as_json`` the last line is the record
    {"benchmark": name, "figures": {...}}."""
    table = Table("figure", "value", title=title, caption=notes or None)
    for key, value in figures.items():
        table.add_row(key, f"{value:.4g}")
    Console().print(table)
    if as_json:
        record = {key: float(f"{float(value):.7g}") for key, value in figures.items()}
        print(json.dumps({"benchmark": name, "figures": record}))

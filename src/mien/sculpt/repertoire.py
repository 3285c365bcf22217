"""What a character can do: the thirteen, what editors want besides, and the visemes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mien.sculpt.expression import Expression
from mien.sculpt.expressions import KEYS, tempered
from mien.sculpt.units import EXTRAS
from mien.sculpt.visemes import VISEMES


def repertoire(**changes: Mapping[str, Any]) -> dict[str, Expression]:
    """All key models of a character, some of them done in its own way: by name of the key model,
    fields of Expression that differ."""
    return tempered({**KEYS, **EXTRAS, **VISEMES}, changes)

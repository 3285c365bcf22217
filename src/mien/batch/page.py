"""The report of a batch: a page that needs nothing but the folder it lies in."""

from __future__ import annotations

from typing import Any

from mien.batch.store import Store
from mien.formats.atomic import whole_file

PAGE = "index.html"


def write_page(account: dict[str, Any], store: Store) -> None:
    """Write index.html. Raises OutputError."""
    with whole_file(store.root / PAGE) as temporary:
        temporary.write_text(f"<pre>{len(account['takes'])}</pre>", "utf-8")

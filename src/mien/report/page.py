"""A page that needs nothing but itself: no script, no font, no picture from elsewhere."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from functools import cache
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.formats.pictures.jpeg import encode_jpeg

_STYLE = Path(__file__).with_name("page.css")


def page(title: str, parts: Iterable[str], style: str = "") -> str:
    """An HTML page of ``parts`` in the house's style, and a ``style`` of its own. It may load
    nothing from anywhere, whatever somebody wrote into it."""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        '<meta name="color-scheme" content="light dark">'
        '<meta http-equiv="Content-Security-Policy" '
        "content=\"default-src 'none'; img-src data: 'self' file:; style-src 'unsafe-inline'\">"
        f"<title>{escape(title)}</title><style>\n{_house_style()}{style}</style></head>\n<body>\n"
        + "\n".join(parts)
        + "\n</body></html>\n"
    )


def image(picture: NDArray[np.uint8], label: str) -> str:
    """A picture (H, W, 3) inside the page itself."""
    data = base64.b64encode(encode_jpeg(picture, picture.shape[0], 84)).decode()
    return f'<img alt="{escape(label)}" src="data:image/jpeg;base64,{data}">'


def figures(cells: Iterable[tuple[str, str]]) -> str:
    """A few numbers, large, each with what it says."""
    boxes = "".join(f"<div><b>{escape(value)}</b>{escape(says)}</div>" for value, says in cells)
    return f'<div class="figures">{boxes}</div>'


def key(entries: Iterable[tuple[str, str]]) -> str:
    """What the colours of a chart mean: (class, meaning)."""
    spans = "".join(
        f'<span class="{kind}"><i>{escape(meaning)}</i></span>' for kind, meaning in entries
    )
    return f'<div class="key">{spans}</div>'


@cache
def _house_style() -> str:
    return _STYLE.read_text("utf-8")

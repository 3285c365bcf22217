"""Pages of a reproduction: a text with gaps, and the pictures, tables and numbers that fill it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Template

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Picture = NDArray[np.uint8]
Cell = str | float | int

TEXTS, FOLDER = Path(__file__).parent, Path(__file__).parents[1] / "papers"
_PAPER, _INK, _RIM = (255, 255, 255), (40, 44, 52), 3
_QUALITY = 78


@dataclass(frozen=True)
class Table:
    """Rows under a head; numbers are told to three digits."""

    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]

    def __str__(self) -> str:
        lines = [self.head, ["---"] * len(self.head), *(map(told, row) for row in self.rows)]
        return "\n".join("| " + " | ".join(line) + " |" for line in lines)


Results = Mapping[str, Picture | Table | Cell]
"""What was found, by the name of the gap that it fills."""


def write(name: str, results: Results) -> None:
    """Fill the gaps of the text called ``name`` and write it, with its pictures beside it, into
    ``FOLDER``. Raises KeyError for a gap that nothing fills."""
    filled = {}
    for gap, value in results.items():
        filled[gap] = told(value) if isinstance(value, str | float | int) else str(value)
        if isinstance(value, np.ndarray):
            path = FOLDER / f"{name}_{gap}.jpg"
            Image.fromarray(value).save(path, quality=_QUALITY, optimize=True)
            filled[gap] = f"![{gap.replace('_', ' ').capitalize()}, made again]({path.name})"
    text = Template((TEXTS / f"{name}.md").read_text(encoding="utf-8")).substitute(filled)
    (FOLDER / f"{name}.md").write_text(text, encoding="utf-8")
    print(f"docs/papers/{name}.md: {', '.join(results)}")


def told(cell: Cell) -> str:
    """A cell or a number in a sentence."""
    if isinstance(cell, str):
        return cell
    return f"{cell:,}" if isinstance(cell, int) else f"{cell:.3g}"


def grid(rows: Sequence[Sequence[Picture]], labels: Sequence[str] = (), side: int = 200) -> Picture:
    """Pictures in rows, each ``side`` pixels high, columns as wide as their widest; ``labels`` name
    the rows."""
    cells = [[_fitted(picture, side) for picture in row] for row in rows]
    widths = [max(row[i].width for row in cells if i < len(row)) for i in range(len(cells[0]))]
    step = side + 2 * _RIM
    sheet = Image.new("RGB", (sum(widths) + 2 * _RIM * len(widths), step * len(rows)), _PAPER)
    pen, font = ImageDraw.Draw(sheet), ImageFont.load_default(max(12, side / 13))
    for i, row in enumerate(cells):
        left = _RIM
        for cell, width in zip(row, widths, strict=False):
            sheet.paste(cell, (left + (width - cell.width) // 2, i * step + _RIM))
            left += width + 2 * _RIM
        if i < len(labels):
            place = (_RIM + 5, i * step + _RIM + 4)
            pen.text(place, labels[i], "white", font, stroke_width=2, stroke_fill=_INK)
    return np.asarray(sheet)


def _fitted(picture: Picture, side: int) -> Image.Image:
    image = Image.fromarray(picture)
    return image.resize((max(1, round(side * image.width / image.height)), side), Image.LANCZOS)


def chart(
    x: Sequence[float],
    lines: Mapping[str, Sequence[float]],
    *,
    across: str,
    up: str,
    logarithmic: bool = False,
) -> Picture:
    """Curves over ``x`` by name."""
    figure = Figure(figsize=(7.6, 3.8), dpi=110, layout="constrained")
    axes = figure.subplots()
    for name, values in lines.items():
        axes.plot(x, values, label=name, linewidth=2)
    if logarithmic:
        axes.set_xscale("symlog", linthresh=10)
    axes.set(xlabel=across, ylabel=up)
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()

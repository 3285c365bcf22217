"""Charts over time as SVG: a few shapes, coloured by the page's own style sheet."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WIDTH = 1000.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 44.0, 8.0, 10.0, 24.0
_STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0)
_TICKS = 10
_POINTS = 900
"""Of a line at most: more than that no screen shows."""


class Chart:
    """A chart of values over seconds. Layers lie on each other in the order they are added;
    ``kind`` is the class by which the style sheet knows one."""

    def __init__(
        self, time: Array, low: float, high: float, height: float = 190.0, unit: str = ""
    ) -> None:
        """``time`` (F,) seconds; ``low`` and ``high`` are values at the bottom and at the top."""
        self._time, self._low, self._high = time, low, max(high, low + 1e-9)
        self._height, self._unit = height, unit
        self._layers: list[str] = []

    def bands(self, spans: Sequence[tuple[float, float]], kind: str, label: str) -> Chart:
        """Mark stretches (first, last) of seconds from top to bottom."""
        half = 0.5 * self._pace()
        for first, last in spans:
            left, right = self._x(first - half), self._x(last + half)
            width, height = max(right - left, 1.5), self._height - _TOP - _BOTTOM
            self._layers.append(
                f'<rect class="{kind}" x="{left:.1f}" y="{_TOP}" width="{width:.1f}" '
                f'height="{height:.1f}"><title>{escape(label)}: {first:.2f} to {last:.2f} s'
                "</title></rect>"
            )
        return self

    def area(self, values: Array, kind: str) -> Chart:
        """Fill between ``values`` (F,) and zero."""
        x, y = self._course(values)
        floor = self._y(min(max(0.0, self._low), self._high))
        self._layers.append(f'<path class="area {kind}" d="{_hill(x, y, floor)}"/>')
        return self

    def line(self, values: Array, kind: str) -> Chart:
        """Draw ``values`` (F,)."""
        self._layers.append(f'<path class="line {kind}" d="M{_joined(*self._course(values))}"/>')
        return self

    def dots(self, seconds: Sequence[float], values: Sequence[float], kind: str) -> Chart:
        """Mark moments."""
        for number, (second, value) in enumerate(zip(seconds, values, strict=True), start=1):
            x, y = self._x(second), self._y(value)
            self._layers.append(
                f'<g class="dot {kind}"><circle cx="{x:.1f}" cy="{y:.1f}" r="8"/>'
                f'<text x="{x:.1f}" y="{y + 3.6:.1f}">{number}</text></g>'
            )
        return self

    def svg(self, title: str) -> str:
        """The chart, ``title`` for those who do not see it."""
        return (
            f'<svg class="chart" viewBox="0 0 {WIDTH:g} {self._height:g}" role="img" '
            f'aria-label="{escape(title)}">{self._axes()}{"".join(self._layers)}</svg>'
        )

    def _axes(self) -> str:
        rows = "".join(
            f'<path class="grid" d="M{_LEFT} {self._y(v):.1f}H{WIDTH - _RIGHT}"/>'
            f'<text class="tick end" x="{_LEFT - 8}" y="{self._y(v) + 4:.1f}">{v:g}{unit}</text>'
            for v, unit in self._levels()
        )
        return rows + seconds_axis(self._time, self._x, self._height)

    def _levels(self) -> list[tuple[float, str]]:
        span = self._high - self._low
        step = 10.0 ** np.floor(np.log10(span))
        step *= next((f for f in (0.2, 0.5, 1.0) if span / (f * step) <= 4.5), 2.0)
        first = np.ceil(self._low / step - 1e-9)
        values = [round(float(step * (first + i)), 6) for i in range(12)]
        inside = [v for v in values if v <= self._high + 1e-9]
        return [(v, f" {self._unit}" if v == inside[-1] and self._unit else "") for v in inside]

    def _course(self, values: Array) -> tuple[Array, Array]:
        time, shown = thinned(self._time, values)
        return np.array([self._x(t) for t in time]), np.array([self._y(v) for v in shown])

    def _pace(self) -> float:
        return float(self._time[-1] - self._time[0]) / max(len(self._time) - 1, 1)

    def _x(self, seconds: float) -> float:
        return place(self._time, seconds)

    def _y(self, value: float) -> float:
        share = (min(max(value, self._low), self._high) - self._low) / (self._high - self._low)
        return self._height - _BOTTOM - share * (self._height - _TOP - _BOTTOM)


def ridges(time: Array, rows: Mapping[str, Array], kind: str, label: float = 120.0) -> str:
    """One line of hills for each of ``rows`` (F,), which are 0..1, under each other."""
    pitch, rise = 25.0, 34.0
    height = pitch * len(rows) + rise - pitch + 34.0

    def x(seconds: float) -> float:
        return place(time, seconds, label)

    parts = [seconds_axis(time, x, height)]
    for number, (name, values) in enumerate(rows.items()):
        floor = rise + 6.0 + pitch * number
        moments, shown = thinned(time, values)
        across = np.array([x(t) for t in moments])
        up = floor - rise * np.clip(shown, 0.0, 1.15)
        outline = _hill(across, up, floor)
        parts.append(
            f'<path class="grid" d="M{label} {floor:.1f}H{WIDTH - _RIGHT}"/>'
            f'<text class="name end" x="{label - 10}" y="{floor:.1f}">{escape(name)}</text>'
            f'<path class="ridge {kind}" d="{outline}"><title>{escape(name)}: at most '
            f"{float(values.max()):.2f}</title></path>"
        )
    return (
        f'<svg class="chart" viewBox="0 0 {WIDTH:g} {height:g}" role="img" '
        f'aria-label="weights of key models over time">{"".join(parts)}</svg>'
    )


def place(time: Array, seconds: float, left: float = _LEFT) -> float:
    """Where ``seconds`` lie across a chart of ``time`` (F,)."""
    span = max(float(time[-1] - time[0]), 1e-9)
    share = min(max((seconds - float(time[0])) / span, 0.0), 1.0)
    return left + share * (WIDTH - left - _RIGHT)


def seconds_axis(time: Array, x: Callable[[float], float], height: float) -> str:
    """Labels of time under a chart."""
    first, last = float(time[0]), float(time[-1])
    step = next((s for s in _STEPS if (last - first) / s <= _TICKS), 7200.0)
    marks = step * np.arange(np.ceil(first / step - 1e-9), np.floor(last / step + 1e-9) + 1)
    return "".join(
        f'<text class="tick middle" x="{x(mark):.1f}" y="{height - 6:.1f}">'
        f"{mark:g}{' s' if i == len(marks) - 1 else ''}</text>"
        for i, mark in enumerate((np.round(marks, 6) + 0.0).tolist())
    )


def thinned(time: Array, values: Array) -> tuple[Array, Array]:
    """As many points as a screen shows: of frames that share one, that which is farthest from
    zero, so that no peak is lost."""
    if len(time) <= _POINTS:
        return time, values
    chosen = [
        part[int(np.argmax(np.abs(values[part])))]
        for part in np.array_split(np.arange(len(time)), _POINTS)
    ]
    return time[chosen], values[chosen]


def _hill(x: Array, y: Array, floor: float) -> str:
    return f"M{x[0]:.1f} {floor:.1f}L{_joined(x, y)}L{x[-1]:.1f} {floor:.1f}Z"


def _joined(x: Array, y: Array) -> str:
    return "L".join(f"{a:.1f} {b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))

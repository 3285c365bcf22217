"""The page that tells an animator the truth about one retargeting."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.library import generic_face
from mien.report.chart import Chart, ridges
from mien.report.findings import Findings, worst
from mien.report.page import figures, image, key, page
from mien.report.pictures import of_character, of_key
from mien.report.reach import spans, telling
from mien.sculpt.transfer.make import make

Picture = NDArray[np.uint8]
Shown = Callable[[Sequence[int], int], list[Picture]]
"""Square pictures of the take at some frames, of a given side; none where it has no pictures."""

_MOMENTS, _WORST = 6, 6
_SIDE = 240
_ROWS = 18
"""Key models whose weights are drawn; the rest did less."""
_STILL = 0.05
"""A key model that never goes beyond it is not drawn."""


@dataclass(frozen=True, slots=True)
class Story:
    """What a page is made from."""

    findings: Findings
    take: str
    """What the take is called."""
    shown: Shown


def tell(story: Story) -> str:
    """The whole page, as HTML."""
    name, take = story.findings.character.name, story.take
    parts = [_head, _moments, _numbers, _expressed, _worst, _weights, _next, _eyes, _rest, _foot]
    return page(f"{name} acts {take}", filter(None, (part(story) for part in parts)))


def _head(story: Story) -> str:
    performance = story.findings.performance
    lost = int(performance.lost.sum())
    seen = f"no face in {lost} of them" if lost else "a face in all of them"
    seconds = float(performance.time[-1] - performance.time[0])
    return (
        f"<h1>{escape(story.findings.character.name)} acts {escape(story.take)}</h1>"
        f'<p class="facts">{len(performance)} frames, {seconds:.1f} s, {seen}</p>'
    )


def _moments(story: Story) -> str:
    frames = telling(story.findings.performance, _MOMENTS)
    return _faces(story, frames, [_clock(story, frame) for frame in frames])


def _numbers(story: Story) -> str:
    found = story.findings
    performed, acted = found.rest.tremble
    unreached = int(found.reach.unreached.sum())
    return figures(
        [
            (f"{found.reach.missing:.0%}", "of the motion found no key model (root mean square)"),
            (f"{unreached}", f"of {len(found.performance)} frames that no key model reaches"),
            (
                f"{acted:.2f} mm",
                f"of tremble at rest, of {performed:.2f} mm in what was measured",
            ),
            (f"{float(found.performance.confidence.mean()):.0%}", "confidence of the capture"),
        ]
    )


def _expressed(story: Story) -> str:
    found = story.findings
    performance, reach = found.performance, found.reach
    if not performance.points:
        return "<h2>What was expressed</h2><p>The weights passed as they came; nothing is lost.</p>"
    top = 1.1 * max(float(reach.motion.max()), float(reach.residual.max()))
    worst_frames = worst(found, _WORST)
    chart = (
        Chart(performance.time, 0.0, top, 230.0, "mm")
        .bands(spans(performance.lost, performance.time), "lost", "no face")
        .bands(spans(reach.unreached, performance.time), "unreached", "not reached")
        .area(reach.motion, "performer")
        .area(reach.residual, "missing")
        .dots(
            performance.time[worst_frames].tolist(), reach.residual[worst_frames].tolist(), "worst"
        )
    )
    return (
        "<h2>What was expressed</h2>"
        "<p>How far the face moved from its neutral, and how much of that no mixture of key models "
        "could show: root mean square over the feature points.</p>"
        + key(
            [
                ("performer", "the performer's motion"),
                ("missing", "of it missing in the character"),
                ("unreached", "frames no key model reaches"),
                *([("lost", "no face was seen")] if performance.lost.any() else []),
            ]
        )
        + chart.svg("motion of the performer and residual over time")
    )


def _worst(story: Story) -> str:
    frames = worst(story.findings, _WORST)
    if not frames:
        return ""
    reach = story.findings.reach
    captions = [
        f"{_number(i)} {_clock(story, frame)} · {reach.residual[frame]:.1f} of "
        f"{reach.motion[frame]:.1f} mm missing"
        for i, frame in enumerate(frames, start=1)
    ]
    return (
        "<h2>Where most is missing</h2>"
        "<p>Look here first: the numbers are those in the chart above.</p>"
        + _faces(story, frames, captions)
    )


def _weights(story: Story) -> str:
    rows = {
        name: values
        for name, values in story.findings.levels.items()
        if float(np.abs(values).max()) > _STILL
    }
    drawn = dict(list(rows.items())[:_ROWS])
    if not drawn:
        return ""
    others = len(story.findings.levels) - len(drawn)
    more = f" {others} others did less or nothing." if others else ""
    return (
        "<h2>Weights over time</h2>"
        f"<p>Each key model a line of hills, the most active first; a hill as high as 1 reaches "
        f"past the line above.{more}</p>"
        + ridges(story.findings.performance.time, drawn, "character")
    )


def _next(story: Story) -> str:
    found = story.findings
    if not found.suggestions:
        return ""
    names = [suggestion.name for suggestion in found.suggestions]
    made = make(found.character.face, generic_face(), names, found.character.name).character
    cells = [
        f"<figure>{image(of_key(made, s.name, _SIDE), s.name)}<figcaption><b>{escape(s.name)}</b> "
        f"what is left falls from {s.before:.0%} to {s.after:.0%}</figcaption></figure>"
        for s in found.suggestions
    ]
    return (
        "<h2>The key model to sculpt next</h2>"
        "<p>Of what the generic face can do and this character cannot, these would take most of "
        "what the best mixture leaves of this take, one after the other. The pictures are made by "
        "deformation transfer, as a start for the sculptor.</p>" + _row(cells, 3)
    )


def _eyes(story: Story) -> str:
    found, time = story.findings, story.findings.performance.time
    charts = []
    for side, acted in found.closures.items():
        chart = Chart(time, -0.25, 1.15, 130.0)
        chart.bands(spans(found.performance.lost, time), "lost", "no face")
        told = found.performance.scalars.get(f"lid_{side}")
        if told is not None:
            chart.area(told, "performer")
        chart.line(acted, side)
        legend = [(side, f"the character's {side} eye")]
        legend += [("performer", "the performer's")] if told is not None else []
        charts.append(key(legend) + chart.svg(f"closure of the {side} eye over time"))
    if not charts:
        return ""
    return (
        "<h2>Each eye by itself</h2>"
        "<p>0 is the eye as open as at rest, 1 is shut. Left and right are the subject's own.</p>"
        + "".join(charts)
    )


def _rest(story: Story) -> str:
    held = story.findings.rest
    top = 1.15 * max(float(held.performer.max()), float(held.character.max()), 0.05)
    chart = Chart(held.time, 0.0, top, 120.0, "mm")
    chart.area(held.performer, "performer").line(held.character, "character")
    return (
        "<h2>Noise at rest</h2>"
        f"<p>The quietest half second, from {held.time[0]:.2f} s on: how far points stray "
        "from a straight course. Nobody is as still as a statue, but a character must not "
        "tremble more than its performer.</p>"
        + key([("performer", "as measured"), ("character", "the character's skin")])
        + chart.svg("tremble of performer and character while the face rests")
    )


def _foot(story: Story) -> str:
    source = Path(story.findings.performance.source or story.take).name
    return (
        f"<footer>Captured from {escape(source)}. Millimetres at the performer's size, with 63 mm "
        "between the pupils unless calibrated.</footer>"
    )


def _faces(story: Story, frames: Sequence[int], captions: Sequence[str]) -> str:
    """The take above, the character below, at ``frames``."""
    found = story.findings
    taken = story.shown(frames, _SIDE)
    acted = of_character(found.character, found.curves, frames, _SIDE)
    cells = []
    for i, (picture, caption) in enumerate(zip(acted, captions, strict=True)):
        above = image(taken[i], f"the take at {_clock(story, frames[i])}") if taken else ""
        below = image(picture, f"{found.character.name} at {_clock(story, frames[i])}")
        cells.append(f"<figure>{above}{below}<figcaption>{caption}</figcaption></figure>")
    return _row(cells, max(len(cells), 3))


def _row(cells: Sequence[str], columns: int) -> str:
    return (
        f'<div class="faces" style="grid-template-columns:repeat({columns},1fr)">'
        f"{''.join(cells)}</div>"
    )


def _clock(story: Story, frame: int) -> str:
    return f"{float(story.findings.performance.time[frame]):.2f} s"


def _number(i: int) -> str:
    return f'<b class="number">{i}</b>'

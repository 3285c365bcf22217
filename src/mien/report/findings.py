"""All that is measured of one retargeting before it is told."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.library import generic_face
from mien.mapping.suggest import Suggestion, lacking, suggest
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.report.eyes import closures
from mien.report.levels import levels
from mien.report.reach import Reach, reach
from mien.report.rest import Rest, rest

Array = NDArray[np.float64]

_SUGGESTED = 3
_APART = 0.05
"""Share of the take between two moments that are shown as the worst, at least."""


@dataclass(frozen=True, slots=True)
class Findings:
    """One character acting one performance of F frames."""

    performance: Performance
    character: Character
    curves: Curves
    reach: Reach
    levels: dict[str, Array]
    """(F,) weight of each key model, the most active first."""
    closures: dict[str, Array]
    """(F,) of the character's "left" and "right" eye, 0 open, 1 shut."""
    rest: Rest
    suggestions: tuple[Suggestion, ...]
    """Key models that would help most, best first; none where nothing is measured of points."""


def find(performance: Performance, character: Character, curves: Curves) -> Findings:
    """Measure how ``curves`` of ``character`` express ``performance``."""
    found = reach(performance, curves)
    return Findings(
        performance,
        character,
        curves,
        found,
        levels(character, curves),
        closures(character, curves),
        rest(performance, character, curves, found.motion),
        _suggestions(performance, character),
    )


def worst(findings: Findings, count: int) -> list[int]:
    """Up to ``count`` frames with the most residual, apart from each other, in order of time."""
    residual, time = findings.reach.residual.copy(), findings.performance.time
    apart = _APART * float(time[-1] - time[0])
    frames: list[int] = []
    while len(frames) < count and residual.max(initial=0.0) > 0.0:
        frame = int(residual.argmax())
        frames.append(frame)
        residual[np.abs(time - time[frame]) <= apart] = 0.0
    return sorted(frames)


def _suggestions(performance: Performance, character: Character) -> tuple[Suggestion, ...]:
    generic = generic_face()
    names = lacking(character, generic)
    if not (performance.points and names):
        return ()
    return tuple(suggest(character, [performance], generic, names, _SUGGESTED))

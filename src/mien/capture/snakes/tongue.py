"""Whether the tongue is out: pink under dark, more of it than lips alone explain.

A lit lower lip under the mouth's dark line is as pale and as pink as a tongue. Two things tell them
apart. A tongue lies on the lower lip, so what is below the dark is thicker than that lip alone; and
a lip is always there. Both are held against what this mouth usually shows, learnt as it goes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.pigments import Pigments
from mien.capture.snakes.colour.transform import MAGENTA_SKIN
from mien.capture.snakes.curves.lens import lower_curve, tallness, upper_curve
from mien.capture.snakes.mouth import Inside, Mask, bright, median, opened

Array = NDArray[np.float64]

_PINKEST, _LEAST_PINK, _LIT, _BLUE = 0.85, 1.12, 0.95, 0.88
"""A tongue has at most this share of the magenta of the reddest quarter of the mouth and at least
that of the skin's, this share of the lips' brightness, and this much blue for its green: skin
and lit lips have less."""
_REDDER, _BLUER = 1.4, 1.1
"""Or, where lips are pale, so much more magenta than the upper lip and so much more blue."""
_RIM = 0.07
"""Depth of the upper lip inside its outline, in heights."""
_UNDER = 0.7
"""Share of the tongue's magenta below which something lies before it: lower teeth, however shaded,
or a pale lip, which a tongue that is out covers."""
_TOOTH = (0.8, 1.1)
"""Or, of teeth that have taken the lips' colour, so much of its magenta at most and so much of its
brightness at least."""
_LIP = 0.3
"""Share of the mouth's height that its lower lip takes."""
_PLAIN = (0.04, 0.12)
"""Shares of the mouth that tongue takes, beyond what is usual, where it is in and where it is
plainly out."""
_THICKER = (0.9, 1.2)
"""Usual thicknesses of the lower lip at which what lies below the dark is that lip alone, and at
which it is plainly more."""
_SLOWLY = 0.5
"""Patch units by which the usual lip may change in a frame."""
_FIRST, _LAST = 10, 100
"""Frames that the usual share of pink is a mean of, at first and at last."""
_USUALLY = 2.5
"""Shares of the usual pink that are no tongue."""
_LONG = 15
"""Frames for which a tongue counts that was out longer."""
_MARGIN = np.ones((3, 3), np.uint8)
_SPECK = np.ones((2, 2), np.uint8)


@dataclass(frozen=True, slots=True)
class Tongue:
    """How far the tongue is out, and what the mouth usually shows."""

    out: float
    """0..1"""
    lip: float
    """Patch units: how thick the lower lip usually is."""
    pink: float = 0.0
    """Share of the mouth that usually looks like tongue."""
    frames: int = 0
    """In which the mouth was seen."""
    held: int = 0
    """Frames for which the tongue has been out."""

    def hidden(self) -> Tongue:
        """The same where no mouth is seen."""
        return replace(self, out=0.0)


def find_tongue(
    lips: Array, opening: Array, seen: Pigments, inside: Inside, last: Tongue | None
) -> Tongue:
    """The tongue of a mouth with outline ``lips`` (6, 2) and ``opening`` (6, 2); ``last`` is what
    the mouth was before."""
    middle = slice(10, 15)
    below = lower_curve(lips, 25)[middle, 1] - lower_curve(opening, 25)[middle, 1]
    lip = float(below.mean())
    last = last or Tongue(0.0, lip)
    share, thick = pink_below_dark(lips, seen, inside)
    alone, more = _THICKER
    share *= min(max((thick / max(last.lip, 1.0) - alone) / (more - alone), 0.0), 1.0)
    few, plain = _PLAIN
    out = min(max((share - _USUALLY * last.pink - few) / (plain - few), 0.0), 1.0)
    if out > 0.5:
        # Learnt when it is in again: a tongue that is held out does not fade.
        return Tongue(out, last.lip, last.pink, last.frames + 1, last.held + 1)
    lip = last.lip + min(max(lip - last.lip, -_SLOWLY), _SLOWLY)
    count = min(last.frames + _FIRST, _LAST)
    pink = plain - (plain - last.pink) * (1.0 - 1.0 / count) ** min(last.held, _LONG)
    pink += (min(share, plain) - pink) / count
    return Tongue(out, lip, pink, last.frames + 1)


def pink_below_dark(outline: Array, seen: Pigments, inside: Inside) -> tuple[float, float]:
    """The share of the mouth ``outline`` (6, 2) that is pink, of another colour than the lips,
    under dark, above no teeth and no pale lip, and not where the lower lip is; and how far it is
    from that dark to the end of the lips, pixels."""
    within, lips = inside.within, inside.lips
    black = opened(inside.dark & within, _SPECK)
    if not black.any():
        return 0.0, 0.0
    above_lip = np.zeros_like(within)
    rise = min(max(round(_LIP * tallness(outline)), 0), len(within))
    above_lip[: len(within) - rise] = within[rise:]
    inner = seen.magenta[within > 0]
    most = (3 * len(inner)) // 4
    reddest = float(np.partition(inner, most)[most])
    rim = upper_curve(outline, 15)[3:-3] + np.array([0.0, _RIM * tallness(outline)])
    redder = seen.magenta > _REDDER * median(seen.values(seen.magenta, rim))
    bluer = seen.blue > _BLUER * median(seen.values(seen.blue, rim))
    pink = (seen.magenta < _PINKEST * reddest) | (redder & bluer)
    pink &= (seen.magenta > _LEAST_PINK * MAGENTA_SKIN) & (seen.blue > _BLUE)
    pink &= seen.value > _LIT * lips.value
    tongue = opened(pink & within & above_lip, _MARGIN)
    if not tongue.any():
        return 0.0, 0.0
    own, lit = median(seen.magenta[tongue > 0]), median(seen.value[tongue > 0])
    pale = (seen.magenta < _UNDER * own) & bright(seen, lips)
    pale |= (seen.magenta < _TOOTH[0] * own) & (seen.value > _TOOTH[1] * lit)
    before = opened(pale & within, _SPECK)
    count, thick = _between(tongue, black, before, within)
    return count / len(inner), thick


@njit(cache=True, nogil=True)
def _between(tongue: Mask, black: Mask, teeth: Mask, within: Mask) -> tuple[int, float]:
    """How many pixels of tongue have black above them and no teeth below, and how far it is from
    that black to the end of the mouth, in the mean of their columns."""
    rows, columns = tongue.shape
    count, wide, thick = 0, 0, 0
    for x in range(columns):
        y = rows - 1
        while y >= 0 and within[y, x] == 0:
            y -= 1
        end, run, dark, free = y, 0, -1, True
        while y >= 0 and (free or run > 0):
            free = free and teeth[y, x] == 0
            if free:
                run += tongue[y, x]
            if black[y, x] and run > 0:
                count += run
                run, dark = 0, y
            y -= 1
        if dark >= 0:
            wide += 1
            thick += end - dark
    return count, thick / max(wide, 1)

"""Whether cheeks that are blown up are told, on a rendered character whose truth is known.

    python benchmarks/cheek_puff.py [--characters woman man] [--captures landmarks tracker]
        [--films FOLDER] [--json]

The character blows its cheeks up twice, between smiles, open mouths, pouts and sneers, while the
head sways by 17 degrees; 480 x 480 pixels, 30 frames a second. A capture that does not measure
cheek_puff is as one that says 0. All characters together:

    correlation     of the level with the true weight
    full            mean level while the cheeks are blown up
    still           mean level while another key model is acted in full
    missed, false   puffs that stay below a half; other acts that do not

--films FOLDER adds real takes on which nobody blows up a cheek: frames above a half.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien import load_character
from mien.capture import CAPTURES, CaptureSettings
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from mien.rehearsal import Tempo, film, rehearse
from report import show

Array = NDArray[np.float64]

PUFF = "cheek_puff"
ACTS = (
    ("smile", PUFF, "jaw_open", "pucker"),
    ("laugh", "sneer_left", PUFF, "sad"),
    ("viseme_u", "pressed", "lips_in", "surprise"),
)
TEMPO = Tempo(hold=0.5, sway=0.3)
HIGH = 0.5


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--characters", nargs="*", default=["woman", "man"])
    parser.add_argument("--captures", nargs="*", default=["landmarks", "tracker"])
    parser.add_argument("--films", type=Path, nargs="*", default=[])
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    figures: dict[str, float] = {}
    for capture in options.captures:
        told = acted(options.characters, capture)
        told |= {
            f"{path.stem}_frames": float((level(capture, open_source(path)) > HIGH).sum())
            for path in options.films
        }
        figures |= {f"{capture}_{name}": value for name, value in told.items()}
    show("cheek_puff", "Cheeks that are blown up", figures, options.json)


def acted(characters: Iterable[str], capture: str) -> dict[str, float]:
    """The figures over all ``characters``."""
    levels, truths, puffs, others = [], [], [], []
    for name in characters:
        character = load_character(name)
        for act in ACTS:
            curves = rehearse(character, act, TEMPO)
            found = level(capture, film(character, curves))
            levels.append(found)
            truths.append(curves.weights[:, curves.names.index(PUFF)])
            for key in act:
                held = curves.weights[:, curves.names.index(key)] > 0.999
                (puffs if key == PUFF else others).append(float(found[held].mean()))
    measured, true = np.concatenate(levels), np.concatenate(truths)
    known = measured.std() > 0.0
    return {
        "correlation": float(np.corrcoef(measured, true)[0, 1]) if known else 0.0,
        "full": float(np.mean(puffs)),
        "still": float(np.mean(others)),
        "puffs": float(len(puffs)),
        "missed": float(np.sum(np.array(puffs) < HIGH)),
        "false": float(np.sum(np.array(others) > HIGH)),
    }


def level(capture: str, frames: Iterable[Frame]) -> Array:
    """(F,) how far cheeks are blown up."""
    performance = CAPTURES[capture](frames, CaptureSettings(), PUFF)
    return performance.scalars.get(PUFF, np.zeros(len(performance)))


if __name__ == "__main__":
    main()

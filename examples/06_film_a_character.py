"""Film a character that acts a few of its key models: how mien's own sample take is made.

python examples/06_film_a_character.py woman sample.mp4
python examples/06_film_a_character.py toy grin.mp4 smile surprise
"""

import sys
from pathlib import Path

import mien
from mien.formats.pictures.mp4 import write_mp4
from mien.rehearsal import Tempo, film, rehearse

ACT = (
    "smile",
    "brows_up",
    "blink_left",
    "jaw_open",
    "pucker",
    "blink_right",
    "anger",
    "surprise",
    "sad",
)


def main(name: str, output: str, *keys: str) -> None:
    """Film the character called ``name``, acting ``keys``, into the file ``output``."""
    character = mien.load_character(name)
    curves = rehearse(character, keys or ACT, Tempo(hold=0.3, sway=0.15))
    write_mp4(Path(output), film(character, curves))
    print(f"{output}: {len(curves)} frames of the {name}")


if __name__ == "__main__":
    main(*sys.argv[1:])

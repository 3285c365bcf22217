"""A video drives a character: the shortest way from a face to a GLB and a film.

python examples/01_video_to_character.py            # the sample performance, and the monkey
python examples/01_video_to_character.py take.mp4 toy
"""

import sys
from importlib import resources

import mien

SAMPLE = resources.files("mien").joinpath("data", "sample.mp4")


def main(take: str = str(SAMPLE), name: str = "monkey", end: str = "3") -> None:
    """Write NAME.glb and NAME.mp4 of what the performer does in the first ``end`` seconds."""
    performance = mien.capture(take, end=float(end))
    character = mien.load_character(name)
    curves = mien.animate(performance, character)
    mien.save(curves, f"{name}.glb", character)
    mien.film([(character, curves)], f"{name}.mp4", take=take, end=float(end))
    print(f"{len(curves)} frames, {len(curves.names)} morph targets: {name}.glb, {name}.mp4")


if __name__ == "__main__":
    main(*sys.argv[1:])

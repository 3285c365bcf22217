"""No capture at all: weights under ARKit's names, from anywhere, drive any character.

python examples/03_weights_from_anywhere.py
"""

import numpy as np

import mien
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.vocabulary.arkit import names


def main() -> None:
    """A slow smile and a wink of the left eye, acted by the toy, whose shapes are its own."""
    frames = []
    for time in np.arange(0.0, 2.0, 1 / 30):
        weights = dict.fromkeys(names(), 0.0)
        weights["mouthSmileLeft"] = weights["mouthSmileRight"] = np.sin(np.pi * time / 2) ** 2
        weights["eyeBlinkLeft"] = float(1.0 < time < 1.3)
        frames.append(ArkitFrame(time, np.array([weights[name] for name in names()])))
    toy = mien.load_character("toy")
    curves = mien.animate(performance_of(frames, "example"), toy)
    mien.save(curves, "toy.csv", toy)
    blink = curves.names.index("blink_L")
    print(f"toy.csv: the left eye shuts by {curves.weights[:, blink].max():.2f}")


if __name__ == "__main__":
    main()

"""What did the performer do? A performance is arrays: find its smiles and its blinks.

python examples/02_read_a_performance.py take.mien
"""

import sys

import numpy as np

import mien


def main(path: str) -> None:
    """Tell when the mouth is widest, when each eye shuts, and how far the head turned."""
    performance = mien.load_performance(path)
    left, right = (performance.points.index(corner) for corner in ("8.3", "8.4"))
    mouth = performance.neutral + performance.motion
    width = np.linalg.norm(mouth[:, left] - mouth[:, right], axis=1)
    widest = int(width.argmax())
    print(f"mouth: {width.min():.1f} to {width.max():.1f} mm, at {performance.time[widest]:.2f} s")
    for side in ("left", "right"):
        shut = performance.scalars[f"lid_{side}"] > 0.8
        starts = np.flatnonzero(np.diff(shut.astype(int), prepend=0) == 1)
        print(f"{side} eye shuts at", [round(float(t), 2) for t in performance.time[starts]])
    turn, _ = performance.head()
    angle = np.degrees(np.arccos(np.clip((np.trace(turn, axis1=1, axis2=2) - 1) / 2, -1, 1)))
    print(f"head: up to {angle.max():.1f} degrees from its rest")


if __name__ == "__main__":
    main(*sys.argv[1:])

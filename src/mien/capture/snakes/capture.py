"""The entry: frames become a performance by curves."""

from __future__ import annotations
import numpy as np
from mien.capture.snakes.features import ROW
from mien.capture.snakes.lens import lower_curve, upper_curve
from mien.capture.snakes.points import COUNT, places, relief
from mien.capture.snakes.reading import calibrate, perform
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.snakes.track import CurveTrack
from mien.errors import NoFaceError
from mien.face.library import generic_face


def follow(frames, progress=None):
    time, pts, op, tongue, lost = [], [], [], [], []
    stepper = SnakeCapture()
    size = (0, 0)
    for frame in frames:
        seen = stepper.step(frame)
        time.append(frame.time)
        lost.append(seen is None)
        size = frame.image.shape[1::-1]
        if seen is None:
            pts.append(np.zeros((COUNT, 2)))
            op.append(np.zeros(2))
            tongue.append(0.0)
        else:
            pts.append(seen.placement.to_frame(places(seen.lenses, seen.rigid)))
            e = seen.lenses[[ROW["eye_left"], ROW["eye_right"]]]
            op.append((lower_curve(e) - upper_curve(e))[..., 1].mean(1))
            tongue.append(seen.tongue)
        if progress:
            progress(len(time))
    if all(lost):
        raise NoFaceError("no face")
    return CurveTrack(
        np.array(time), np.array(pts), np.array(op), np.array(tongue), np.array(lost), size
    )


def snakes(frames, settings, source, progress=None):
    track = follow(frames, progress)
    base = relief(generic_face())
    return perform(track, calibrate(track, base, settings.neutral, settings.focal), base, source)

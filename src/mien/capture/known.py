"""What captures know of a performer, as sections of plain arrays and back."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mien.capture import landmarks
from mien.capture.lids import LidRange
from mien.capture.neutral import Ground
from mien.capture.settings import CaptureSettings
from mien.capture.snakes import reading
from mien.capture.snakes.colour.network import HIDDEN, INPUTS, OUTPUTS, Network
from mien.capture.snakes.curves.features import MOUTH
from mien.capture.snakes.head.flow import COUNT
from mien.capture.snakes.head.patch import HEIGHT, WIDTH
from mien.capture.snakes.points import POINTS
from mien.capture.snakes.stepper import Appearance
from mien.capture.track import KEPT, LandmarkTrack
from mien.errors import FormatError
from mien.performance.performer import Section

Array = NDArray[np.float64]
Shape = tuple[int, ...]

_LANDMARKS: Mapping[str, Shape] = {
    "model": (len(KEPT), 3),
    "offset": (len(KEPT), 3),
    "lids_open": (2,),
    "lids_shut": (2,),
    "gaze": (2, 2),
    "place": (3,),
    "focal": (),
}
_CURVES: Mapping[str, Shape] = {
    "neutral": (len(POINTS), 3),
    "lids_open": (2,),
    "lids_shut": (2,),
    "gaze": (2, 2),
    "place": (3,),
    "focal": (),
    "rest": (MOUTH, 6, 2),
    "anchor": (HEIGHT, WIDTH),
    "points": (COUNT, 2),
}
_NETWORK: Mapping[str, Shape] = {
    "hidden": (HIDDEN, INPUTS),
    "hidden_bias": (HIDDEN,),
    "output": (OUTPUTS, HIDDEN),
    "output_bias": (OUTPUTS,),
    "constant": (),
}
NETWORKS = ("brow", "eye", "lip")
"""Groups whose colour weights a network gives."""


def landmark_section(known: landmarks.Calibration) -> Section:
    """The landmark capture's section of a performer."""
    return {
        "model": known.model,
        "offset": known.offset,
        "lids_open": known.lids.open,
        "lids_shut": known.lids.shut,
        "gaze": known.gaze,
        "place": known.place,
        "focal": np.array(known.focal),
    }


def landmark_calibration(section: Section) -> landmarks.Calibration:
    """What the landmark capture wrote. Raises FormatError where it is not that."""
    known = _checked(section, _LANDMARKS, "landmarks")
    return landmarks.Calibration(
        known["model"],
        known["offset"],
        LidRange(known["lids_open"], known["lids_shut"]),
        known["gaze"],
        known["place"],
        float(known["focal"]),
    )


def curve_section(
    known: reading.Calibration, look: Appearance, networks: Mapping[str, Network]
) -> Section:
    """The curve capture's section of a performer."""
    section = {
        "neutral": known.neutral,
        "lids_open": known.lids.open,
        "lids_shut": known.lids.shut,
        "gaze": known.gaze,
        "place": known.place,
        "focal": np.array(known.focal),
        "rest": look.rest,
        "anchor": look.anchor.astype(float),
        "points": look.points,
    }
    for group, network in networks.items():
        for name in _NETWORK:
            section[f"{group}_{name}"] = np.asarray(getattr(network, name), dtype=float)
    return section


def curve_calibration(
    section: Section,
) -> tuple[reading.Calibration, Appearance, dict[str, Network]]:
    """What the curve capture wrote; no networks where it was not trained. Raises FormatError
    where it is not that."""
    known = _checked(section, _CURVES, "curves")
    anchor = np.clip(np.rint(known["anchor"]), 0, 255).astype(np.uint8)
    inside = np.abs(known["points"]).max() < min(HEIGHT, WIDTH) / 2
    if not inside or np.abs(known["rest"]).max() > HEIGHT:
        raise FormatError("the performer's curves lie outside the face; calibrate again")
    networks = {
        group: _network(section, group) for group in NETWORKS if f"{group}_hidden" in section
    }
    calibration = reading.Calibration(
        known["neutral"],
        LidRange(known["lids_open"], known["lids_shut"]),
        known["gaze"],
        known["place"],
        float(known["focal"]),
    )
    return calibration, Appearance(known["rest"], anchor, known["points"]), networks


def _network(section: Section, group: str) -> Network:
    shapes = {f"{group}_{name}": shape for name, shape in _NETWORK.items()}
    found = _checked(section, shapes, "curves")
    numbers = {name: found[f"{group}_{name}"] for name in _NETWORK}
    return Network(**{**numbers, "constant": float(numbers["constant"])})  # type: ignore[arg-type]


def _checked(section: Section, shapes: Mapping[str, Shape], what: str) -> dict[str, Array]:
    for name, shape in shapes.items():
        if name not in section or section[name].shape != shape:
            raise FormatError(f"the performer's {what} lack a sound '{name}'; calibrate again")
    focal = section.get("focal")
    opened, shut = section.get("lids_open"), section.get("lids_shut")
    sane = focal is None or float(focal) > 0.0
    if opened is not None and shut is not None:
        sane = sane and bool((opened > shut).all())
    if not sane:
        raise FormatError(f"the performer's {what} cannot be true; calibrate again")
    return {name: section[name] for name in shapes}


def known_or_learnt(
    track: LandmarkTrack, ground: Ground, settings: CaptureSettings
) -> landmarks.Calibration:
    """What earlier takes told of the performer, or else what this one tells. Raises InputError."""
    if settings.performer is not None and settings.performer.landmarks:
        return landmark_calibration(settings.performer.landmarks)
    return landmarks.calibrate(track, ground, neutral=settings.neutral, focal=settings.focal)

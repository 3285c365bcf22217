"""What makes one head differ from another: a small table of measures.

Millimetres in the sculpting frame (x to the subject's left, y up, z out of the face), whose origin
lies 26 mm under and 33 mm behind the eyes of the mean face. Angles in degrees.
"""

from __future__ import annotations

from dataclasses import dataclass, field

Triple = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Brush:
    """A smooth push: everything near ``centre`` (mirrored) goes by ``push``."""

    centre: Triple
    radii: Triple
    push: Triple


@dataclass(frozen=True, slots=True)
class HeadShape:
    """Factors of 1 and pushes of 0 leave the mean face as it is."""

    cranium: Triple = (1.0, 1.0, 1.0)
    crown: float = 4.0
    """How far the top of the head is raised."""
    face_width: float = 1.0
    jaw_width: float = 1.0
    midface: float = 1.0
    """Length from the eyes to the mouth."""
    lower_face: float = 1.0
    """Length from the nose to the chin."""
    chin_up: float = 0.0
    chin_forward: float = 0.0
    neck: float = 0.75
    cheek: float = 0.0
    nose: Triple = (1.0, 1.0, 1.0)
    nose_up: float = 0.0
    nostril: float = 1.5
    """How far the nostril floor is pushed in."""
    brow_up: float = 0.0
    brow_forward: float = -2.0
    brushes: tuple[Brush, ...] = ()


@dataclass(frozen=True, slots=True)
class EyeShape:
    """The ball first, the lids on it. Lid measures are arcs on the ball."""

    aside: float = 32.0
    """x of the ball's centre; then its height and depth."""
    height: float = 23.0
    depth: float = 25.0
    radius: float = 17.5
    half_width: float = 17.6
    upper: float = 8.2
    lower: float = 7.4
    tilt: float = 0.8
    """How much higher the outer corner lies than the middle."""
    peak: float = 0.1
    """Positive: the highest point lies towards the nose."""
    lid_turn: float = 9.0
    """How far the lids' frame looks outwards, so that they follow the face."""
    gaze_turn: float = 1.5
    """How far the ball itself looks outwards: more looks wall-eyed."""
    offset: float = 1.8
    """From ball to lid. A key model moves a lid along the chord: (R + offset) cos(travel / 2)
    must stay above R half-way."""
    crease: float = 7.0
    crease_offset: float = 0.2


@dataclass(frozen=True, slots=True)
class MouthShape:
    half_width: float = 25.0
    height: float = -36.5
    depth: float = 57.5
    """z of the lip line at the midline, and at the corners."""
    corner_depth: float = 45.0
    upper: float = 5.2
    lower: float = 6.4
    fullness: float = 2.5
    """How far the lips stand forward of their edges."""
    bend: float = 1.8
    """How much higher the corners lie: a straight line sulks."""
    tooth_scale: float = 1.0
    tooth_back: float = 6.2


@dataclass(frozen=True, slots=True)
class HairLine:
    """Brows and lashes."""

    brow_up: float = -0.5
    brow_width: float = 3.2
    brow_height: float = 1.6
    brow_between: float = 0.5
    """0 on the lower edge of the brow loops, 1 on the upper."""
    brow_inner: float = 0.0
    """How much higher the inner end lies: brows that fall inwards look stern."""
    lash: float = 1.2
    """Length; 0 for none."""
    lash_width: float = 0.9


@dataclass(frozen=True, slots=True)
class Temper:
    """How strongly a face acts, next to the generic one."""

    brows: float = 1.0
    cheeks: float = 1.0
    """Large lids leave cheeks little room to rise."""
    corners_aside: float = 1.0
    lip_thickness: float = 1.0


@dataclass(frozen=True, slots=True)
class Proportions:
    head: HeadShape = field(default_factory=HeadShape)
    eye: EyeShape = field(default_factory=EyeShape)
    mouth: MouthShape = field(default_factory=MouthShape)
    hair_line: HairLine = field(default_factory=HairLine)
    temper: Temper = field(default_factory=Temper)

"""What a sculpted face does, as an animator would say it."""

from __future__ import annotations

from dataclasses import dataclass, replace

Triple = tuple[float, float, float]
STILL: Triple = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Expression:
    """Millimetres on the generic face, x outwards from the midline unless said otherwise; lips
    scale with the mouth's width. All of it on both sides, as strong as ``left`` and ``right``."""

    left: float = 1.0
    right: float = 1.0

    jaw: float = 0.0
    """Degrees about the condyles; 20 opens the mouth by 28 mm."""
    jaw_aside: float = 0.0
    """To the subject's left."""
    jaw_forward: float = 0.0
    close: float = 0.0
    """1 brings lips that the jaw parted together again."""

    corner: Triple = STILL
    upper_lip: Triple = STILL
    """Its middle, then half-way to the corners; likewise below."""
    upper_quarter: Triple = STILL
    lower_lip: Triple = STILL
    lower_quarter: Triple = STILL
    upper_thick: float = 1.0
    lower_thick: float = 1.0
    """Factors of the lips' height."""
    narrow: float = 0.0
    """Part of the mouth's width that goes."""
    pucker: float = 0.0
    """Lips forward."""
    lips_aside: float = 0.0
    """To the subject's left."""

    cheek: Triple = STILL
    fold: float = 0.0
    """Depth of the fold from nose to mouth corner."""
    puff: float = 0.0
    nose: float = 0.0
    chin: float = 0.0

    brow_inner: Triple = STILL
    brow_middle: Triple = STILL
    brow_outer: Triple = STILL

    blink: float = 0.0
    """1 closes the eye, negative opens it wider."""
    squint: float = 0.0
    lid_tilt: float = 0.0
    lid_aside: float = 0.0
    tongue: float = 0.0
    """Tip forward."""

    def sides(self, left: float, right: float) -> Expression:
        """The same, as strong as that on either side."""
        return replace(self, left=left, right=right)

    def mirrored(self) -> Expression:
        """The same done by the other side."""
        return replace(
            self,
            left=self.right,
            right=self.left,
            jaw_aside=-self.jaw_aside,
            lips_aside=-self.lips_aside,
        )

    def is_symmetric(self) -> bool:
        """Whether both sides do the same."""
        return self == self.mirrored()

    def is_right_sided(self) -> bool:
        """Whether it is rather done by the right side."""
        return (self.right, -self.jaw_aside - self.lips_aside) > (
            self.left,
            self.jaw_aside + self.lips_aside,
        )

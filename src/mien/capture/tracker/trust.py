"""How much each source is trusted. One setting serves every take."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Trust:
    """Weights of the terms; 0 leaves one out."""

    texture: float = 0.15
    """Of a texel: neighbours are not independent."""
    anchor: float = 0.5
    """Of a landmark's place."""
    points: float = 0.0
    """Of a point of the skin that was found again."""
    silhouette: float = 0.3
    """Of an edge across the outline."""
    predictor: bool = True
    """Landmarks' motion since the frame before gives the start; or else their place does."""
    keyframes: bool = True
    """Looks from other sides are remembered."""
    motion: bool = True
    """No frame is far from what the one before lets expect."""
    retry: bool = True
    """The landmarks' own pose is tried where the looks agree badly."""
    meeting: bool = True
    """Other views correct the pose at rest and the shape."""
    spread: float = 1.0
    """Factor on the prior spread of expressions."""

"""Capture without learned weights: colour, blobs and Bezier snakes [B] §3."""

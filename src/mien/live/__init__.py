"""Live: the performer moves and the characters follow, now."""

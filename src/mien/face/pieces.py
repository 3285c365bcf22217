"""Pieces: a character's key models split softly into brow, eyes and mouth, left and right.

A performer raises one brow or sneers on one side; a key model as sculpted does not. The mapping
therefore drives pieces, and so does everything written to files.
"""

"""Optical markers: C3D, TRC and plain tables."""

"""Performances and curves as files."""

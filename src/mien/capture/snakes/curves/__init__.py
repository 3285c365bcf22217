"""Blobs and the curves that come to rest on features."""

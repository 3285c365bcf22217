"""Meshes without a rig: scans, OBJ files, folders of them."""

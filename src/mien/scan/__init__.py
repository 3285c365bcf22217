"""Raw scans become a databank of consistent meshes [Z] §4.1."""

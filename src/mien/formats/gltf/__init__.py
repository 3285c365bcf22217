"""Characters as glTF, and what is built on it: GLB, VRM, VRM Animation."""

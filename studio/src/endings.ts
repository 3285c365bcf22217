// Endings of the files that the server takes: see shelf.py.

export const VIDEOS = [".mp4", ".mov", ".m4v", ".webm", ".mkv", ".avi"];
export const TAKES = [".take", ".mien", ".csv", ".fap", ".c3d", ".trc"];
export const PERFORMERS = [".performer"];
export const MODELS = [".glb", ".gltf", ".vrm", ".obj", ".zip"];

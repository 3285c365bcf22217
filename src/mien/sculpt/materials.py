"""How the cast's parts take light."""

from __future__ import annotations

from mien.face.face import Material

MATERIALS: dict[str, Material] = {
    "skin": Material(roughness=0.55, specular=0.4, subsurface=1.0),
    "eye": Material(roughness=0.12, specular=0.9),
    "catch_light": Material(roughness=1.0, specular=0.0, emission=1.0, casts_shadow=False),
    "brow": Material(roughness=0.7, specular=0.25, subsurface=0.2),
    "lash": Material(roughness=0.8, specular=0.05, casts_shadow=False),
    "tooth": Material(roughness=0.25, specular=0.6, subsurface=0.3, casts_shadow=False),
    "tongue": Material(roughness=0.35, specular=0.45, subsurface=0.8),
    "hair": Material(roughness=0.45, specular=0.4, subsurface=0.1),
    "fur": Material(roughness=0.6, specular=0.25, subsurface=0.15),
    "cloth": Material(roughness=0.85, specular=0.15),
    "felt": Material(roughness=0.95, specular=0.08, subsurface=0.7),
    "yarn": Material(roughness=0.85, specular=0.12, subsurface=0.1),
    "button": Material(roughness=0.25, specular=0.8),
}

"""Run by Blender's own Python: import a GLB and print what came in, as one JSON line.

python blender_import.py FILE.glb
"""

import json
import sys

import bpy


def fcurves(owner):
    """The owner's curves; Blender 4.4 and later keep them in a slot of the action."""
    data = owner.animation_data
    if data is None or data.action is None:
        return []
    strips = [strip for layer in data.action.layers for strip in layer.strips]
    return [
        curve
        for strip in strips
        for bag in strip.channelbags
        if bag.slot == data.action_slot
        for curve in bag.fcurves
    ]


def described(owner, fps):
    return {
        f"{curve.data_path}#{curve.array_index}": {
            "time": [key.co[0] / fps for key in curve.keyframe_points],
            "value": [key.co[1] for key in curve.keyframe_points],
        }
        for curve in fcurves(owner)
    }


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[1])
render = bpy.context.scene.render
fps = render.fps / render.fps_base
found = {}
for thing in bpy.data.objects:
    keys = thing.data.shape_keys if thing.type == "MESH" else None
    found[thing.name] = {
        "parent": thing.parent.name if thing.parent else None,
        "shape_keys": [block.name for block in keys.key_blocks] if keys else [],
        "weights": described(keys, fps) if keys else {},
        "motion": described(thing, fps),
    }
print("IMPORTED " + json.dumps(found))

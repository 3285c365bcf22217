"""Run by Blender: a GLB of mien's becomes an FBX for Unreal, Unity or Maya.

blender --background --python examples/08_glb_to_fbx.py -- man.glb man.fbx
"""

import sys

import bpy


def main(source: str, target: str, rate: str = "30") -> None:
    """Shape keys with their animation, head and eyes go along; ``rate`` is frames a second."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = round(float(rate))
    bpy.ops.import_scene.gltf(filepath=source)
    scene = bpy.context.scene
    owners = [*bpy.data.objects, *bpy.data.shape_keys]
    ends = [
        o.animation_data.action.frame_range[1]
        for o in owners
        if o.animation_data is not None and o.animation_data.action is not None
    ]
    scene.frame_start, scene.frame_end = 0, round(max(ends, default=1.0))
    bpy.ops.export_scene.fbx(
        filepath=target,
        object_types={"EMPTY", "MESH", "ARMATURE"},
        bake_anim=True,
        bake_anim_use_nla_strips=False,
        bake_anim_use_all_actions=False,
        add_leaf_bones=False,
    )
    print(f"{target}: frames 0 to {scene.frame_end}")


if __name__ == "__main__":
    main(*(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]))

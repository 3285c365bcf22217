"""The example that makes FBX files in Blender: faces, heads and their motion come back."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from faces import toy_curves
from foreign import BLENDER, needs_blender
from mien.face.character import Character
from mien.formats.gltf.glb import write_glb

EXAMPLE = Path(__file__).parents[2] / "examples" / "08_glb_to_fbx.py"
READ_BACK = """
import json, sys, bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.fbx(filepath=sys.argv[1])
(keys,) = (keys for keys in bpy.data.shape_keys if keys.animation_data)
end = keys.animation_data.action.frame_range[1]
turned = bpy.data.objects["head"].animation_data is not None
print("READ", json.dumps([[block.name for block in keys.key_blocks], end, turned]))
"""


def _in_blender(*arguments: object) -> str:
    done = subprocess.run(
        [BLENDER, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=True
    )
    return done.stdout


@needs_blender
def test_shape_keys_and_motion_survive(toy_face: Character, tmp_path: Path) -> None:
    curves = toy_curves(toy_face)
    source, target = tmp_path / "toy.glb", tmp_path / "toy.fbx"
    write_glb(source, toy_face, curves)
    (tmp_path / "read.py").write_text(READ_BACK)
    _in_blender(EXAMPLE, source, target)
    (line,) = (
        line
        for line in _in_blender(tmp_path / "read.py", target).splitlines()
        if line.startswith("READ ")
    )
    names, end, turned = json.loads(line.removeprefix("READ "))
    assert set(names) == {"Basis", *curves.names}
    assert end >= round(30 * float(curves.time[-1]))
    assert turned

#!/bin/sh
# Install what only the checks of our GLB files need: the Khronos validator and Blender as a module.
# Both go into .tools/, where the tests look for them. Run again, it does nothing.
set -eu
cd "$(dirname "$0")/.."

if [ ! -d .tools/validator/node_modules/gltf-validator ]; then
    mkdir -p .tools/validator
    (cd .tools/validator && npm install --no-fund --no-audit gltf-validator@2.0.0-dev.3.10)
fi

# bpy 4.5 pins numpy 1.26 and Python 3.11: it gets an environment of its own.
if ! .tools/bpy/bin/python -c "import bpy" 2>/dev/null; then
    rm -rf .tools/bpy
    python3.11 -m venv .tools/bpy
    .tools/bpy/bin/python -m pip install --quiet bpy==4.5.15
fi

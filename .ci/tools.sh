#!/bin/sh
# Install what only some checks need: the Khronos validator and Blender as a module for our GLB files,
# Playwright for the studio's page (and Chromium, where apt may bring it). They go into .tools/, where the tests look for them. Run again, it does nothing.
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

if ! .tools/browser/bin/python -c "import playwright" 2>/dev/null; then
    rm -rf .tools/browser
    python3.11 -m venv .tools/browser
    .tools/browser/bin/python -m pip install --quiet playwright==1.65.2
fi
command -v chromium >/dev/null || apt-get install -y --no-install-recommends chromium libatomic1

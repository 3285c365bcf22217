"""The report of a batch: a page that needs nothing but the folder it lies in."""

from __future__ import annotations

from html import escape
from pathlib import Path
from typing import Any
from urllib.parse import quote

from mien.batch.store import PICTURE, Store
from mien.formats.atomic import whole_file
from mien.report.page import figures, key, page

PAGE = "index.html"
_STYLE = Path(__file__).with_name("page.css")


def write_page(account: dict[str, Any], store: Store) -> None:
    """Write index.html from the account of a batch. Raises OutputError."""
    with whole_file(store.root / PAGE) as temporary:
        temporary.write_text(batch_page(account), "utf-8")


def batch_page(account: dict[str, Any]) -> str:
    """The page, as HTML: failures first, then every take with all who act it."""
    done = [take for take in account["takes"] if "error" not in take]
    cast = account["characters"]
    parts = [
        f"<h1>{len(account['takes'])} takes, {len(cast)} character{'s' * (len(cast) != 1)}</h1>",
        _facts(account),
        _numbers(account, done),
        _failures(account),
        _legend(),
        f'<div class="takes" style="--cast:{len(cast)}">',
        *(_take(take) for take in done),
        "</div>",
        f"<footer>mien {escape(account['mien'])}. All that is known of this batch stands in "
        '<a href="batch.json">batch.json</a>.</footer>',
    ]
    return page("mien batch", parts, _STYLE.read_text("utf-8"))


def _facts(account: dict[str, Any]) -> str:
    run = account["run"]
    count = run["count"]
    found = count["captures_found"] + count["acts_found"]
    before = f"; {found} results were there already" if found else ""
    options = ", ".join(f"{k} {v}" for k, v in account["options"].items() if v not in (1.0, True))
    when = escape(run["started"][:16].replace("T", " "))
    return (
        f'<p class="facts">{when} UTC, {run["seconds"]:.1f} s with {run["workers"]} '
        f"workers: {count['captured']} captured, {count['acted']} acted{before}. "
        f"{escape(options)}.</p>"
    )


def _numbers(account: dict[str, Any], done: list[dict[str, Any]]) -> str:
    failed = len(account["takes"]) - len(done)
    acts = [act for take in done for act in take["characters"]]
    missed = sum("error" in act for act in acts)
    frames = sum(take["frames"] for take in done)
    lost = sum(take["lost_frames"] for take in done)
    return figures(
        [
            (_length(sum(take["seconds"] for take in done)), f"of acting, {frames} frames"),
            (f"{len(acts) - missed}", f"results; {missed} characters could not act a take"),
            (f"{failed}", f"of {len(account['takes'])} takes could not be captured"),
            (f"{lost / max(frames, 1):.1%}", f"of the frames show no face ({lost})"),
        ]
    )


def _length(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 120.0 else f"{seconds / 60.0:.0f} min"


def _failures(account: dict[str, Any]) -> str:
    lines = [(take["take"], take["error"]) for take in account["takes"] if "error" in take]
    lines += [
        (f"{act['character']} of {take['name']}", act["error"])
        for take in account["takes"]
        for act in take.get("characters", ())
        if "error" in act
    ]
    if not lines:
        return ""
    rows = "".join(
        f"<li><b>{escape(Path(what).name)}</b>{escape(why.removeprefix(f'{what}: '))}</li>"
        for what, why in lines
    )
    return f'<h2>What failed</h2><ul class="failures">{rows}</ul>'


def _legend() -> str:
    meanings = [
        ("confidence", "confidence of the capture"),
        ("missing", "motion that found no key model"),
    ]
    return f"<h2>Every take</h2>{key(meanings)}"


def _take(take: dict[str, Any]) -> str:
    lost = f"no face in {take['lost_frames']}: {_spans(take['lost'])}" if take["lost"] else ""
    shown = (
        _strip(take["capture"], take["name"]) if take["pictures"] else '<div class="blank"></div>'
    )
    return (
        f'<section class="take"><figure>{shown}<figcaption><b>{escape(take["name"])}</b>'
        f"{_bar('confidence', take['confidence'])}"
        f"<span>{take['frames']} frames, {take['seconds']:.1f} s</span> "
        f'<span class="warn">{lost}</span></figcaption></figure>'
        + "".join(map(_act, take["characters"]))
        + "</section>"
    )


def _act(act: dict[str, Any]) -> str:
    name = escape(act["character"])
    if "error" in act:
        return (
            f'<figure><div class="blank"></div><figcaption><b>{name}</b>'
            f'<span class="warn">{escape(act["error"])}</span></figcaption></figure>'
        )
    files = " ".join(
        f'<a href="{quote(file)}">{escape(Path(file).suffix.lstrip(".") or Path(file).name)}</a>'
        for file in act["files"]
    )
    unreached = act["unreached_frames"]
    told = f"{unreached} frames not reached" if unreached else ""
    return (
        f"<figure>{_strip(act['result'], act['character'])}<figcaption><b>{name}</b>"
        f"{_bar('missing', act['missing'])}<span>{files}</span> "
        f'<span class="warn">{told}</span></figcaption></figure>'
    )


def _strip(folder: str, label: str) -> str:
    return f'<img loading="lazy" alt="{escape(label)}" src="{quote(folder)}/{PICTURE}">'


def _bar(kind: str, share: float) -> str:
    return (
        f'<span class="bar {kind}" style="--share:{min(share, 1.0):.3f}" '
        f'title="{kind} {share:.0%}"><i></i>{share:.0%}</span>'
    )


def _spans(spans: list[list[float]]) -> str:
    shown = ", ".join(f"{first:.1f}-{last:.1f} s" for first, last in spans[:3])
    return f"{shown} and more" if len(spans) > 3 else shown

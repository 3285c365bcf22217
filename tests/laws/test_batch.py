"""Names made of content, takes found, stores that share a folder, pages that believe nobody."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from mien.batch.digest import digest_of, digest_of_facts
from mien.batch.order import Order, Role, formats, roles
from mien.batch.page import batch_page
from mien.batch.store import Store, account_of, kept
from mien.batch.takes import find_takes
from mien.errors import InputError, OutputError


def test_content_makes_the_name(tmp_path: Path) -> None:
    for name, content in (("a", b"one"), ("b", b"one"), ("c", b"two")):
        (tmp_path / name).write_bytes(content)
    assert digest_of(tmp_path / "a") == digest_of(tmp_path / "b") != digest_of(tmp_path / "c")
    before = digest_of(tmp_path)
    (tmp_path / "c").rename(tmp_path / "d")
    assert digest_of(tmp_path) != before
    assert digest_of_facts({"x": 1, "y": 2}) == digest_of_facts({"y": 2, "x": 1})
    with pytest.raises(InputError, match="no such file"):
        digest_of(tmp_path / "absent")


def test_all_that_changes_a_result_changes_its_name(tmp_path: Path) -> None:
    told = tmp_path / "ann.performer"
    told.write_text("1")
    role = Role("man", "man", "0")
    plain = Order((role,), looking={"method": "landmarks", "performer": told})
    key = plain.capture_key("take")
    told.write_text("2")
    others = [
        plain.capture_key("take"),
        plain.capture_key("another take"),
        Order((role,), looking={"method": "snakes"}).capture_key("take"),
        Order((role,), version="0").capture_key("take"),
    ]
    assert len({key, *others}) == 5
    results = [
        plain.result_key(key, role),
        plain.result_key(key, Role("man", "man", "1")),
        plain.result_key(others[0], role),
        Order((role,), formats=("csv",)).result_key(key, role),
        Order((role,), acting={"gain": 2.0}).result_key(key, role),
    ]
    assert len(set(results)) == 5
    moved = Role("man", "elsewhere/man.npz", "0")
    assert plain.result_key(key, moved) == results[0]


def test_characters_and_formats_are_checked_before_the_work() -> None:
    assert [role.name for role in roles(())] == ["man", "woman", "monkey", "toy"]
    assert formats([".GLB", "csv", "glb"]) == ("glb", "csv")
    with pytest.raises(InputError, match="twice"):
        roles(["man", "man"])
    with pytest.raises(InputError, match="docx"):
        formats(["docx"])


def test_takes_are_found_at_any_depth(tmp_path: Path) -> None:
    for name in ("a.mp4", "poster.jpg", "deep/a.mov", "deep/er/1.png", "deep/er/2.png", "n.txt"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    (tmp_path / ".hidden.mp4").touch()
    found = find_takes([tmp_path, tmp_path / "a.mp4", tmp_path / "n.txt"])
    assert [Path(take.path).relative_to(tmp_path).as_posix() for take in found] == [
        "a.mp4",
        "deep/a.mov",
        "deep/er",
        "n.txt",
    ]
    assert [take.name("0123456789") for take in found] == ["a-01234567", "a-01234567", "er", "n"]


def test_a_store_holds_whole_results_only(tmp_path: Path) -> None:
    store = Store(tmp_path / "out")
    with store.opened():
        with kept(store.results / "k", {"b": 1, "a": 2}) as room:
            (room / "man.glb").write_bytes(b"glb")
        with pytest.raises(ZeroDivisionError), kept(store.results / "half", {}):
            _ = 1 / 0
        store.publish("k", "clip")
        store.publish("k", "clip")
        (store.results / ".mien-left").mkdir()
    assert [path.name for path in store.results.iterdir()] == ["k"]
    assert account_of(store.results / "k") == {"a": 2, "b": 1}
    assert (store.takes / "clip/man.glb").samefile(store.results / "k/man.glb")


def test_two_batches_do_not_share_a_folder(tmp_path: Path) -> None:
    store = Store(tmp_path / "out")
    with store.opened(), pytest.raises(OutputError, match="another batch"), store.opened():
        pass
    with store.opened():
        pass


def test_a_page_believes_no_name() -> None:
    bad = '<script src="http://example.org/x.js">&"'
    account = {
        "mien": "0",
        "characters": [bad],
        "options": {"mapping": bad},
        "run": {
            "started": "2026-01-01T00:00:00+00:00",
            "seconds": 1.0,
            "workers": 2,
            "count": {"captured": 1, "captures_found": 0, "acted": 1, "acts_found": 0},
        },
        "takes": [
            {"take": bad, "name": bad, "sha256": "", "error": bad},
            {
                "take": bad,
                "name": bad,
                "capture": "captures/k",
                "pictures": True,
                "frames": 10,
                "seconds": 0.3,
                "confidence": 0.9,
                "lost": [[0.1, 0.2]],
                "lost_frames": 3,
                "characters": [
                    {"character": bad, "error": bad},
                    {
                        "character": bad,
                        "missing": 1.5,
                        "unreached_frames": 2,
                        "result": "results/k",
                        "files": [f"takes/{bad}/man.glb"],
                    },
                ],
            },
        ],
    }
    page = batch_page(account)
    assert "<script" not in page
    assert 'src="http' not in page
    body = page[page.index("<body>") : page.index("</html>")]
    ElementTree.fromstring(
        body.replace('loading="lazy" ', "").replace("<img", "<br").replace('.jpg">', '.jpg"/>')
    )

"""Opens the studio in Chromium with a video as its camera, uses it, and prints what it saw as JSON.

BROWSER_PYTHON page.py ADDRESS CAMERA.mjpeg CHROMIUM FOLDER

FOLDER holds squashed.glb, a face that nobody finds by looking, squashed.json, where its feature
points are, and film.mp4.
"""

import base64
import json
import math
import os
import struct
import sys
import time
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

DROP = """([name, data]) => {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    const carried = new DataTransfer();
    carried.items.add(new File([bytes], name));
    dispatchEvent(new DragEvent("drop", { dataTransfer: carried, cancelable: true }));
}"""
"""Lets a file go over the page."""
HALF_FIELD = math.radians(12.0)
"""Half of the picker's field of view, and ..."""
AWAY = 2.4
"""... how far it looks from, in sizes of the face."""


def weights(page: Page) -> list[float]:
    """The bars' levels."""
    script = "b => b.map(i => Number(i.style.transform.slice(7, -1) || 0))"
    found: list[float] = page.eval_on_selector_all(".bar .track i", script)
    return found


def moving(page: Page, far: float) -> float:
    """The furthest any bar has moved, once that is ``far``, or after ten seconds."""
    first = weights(page)
    furthest, end = 0.0, time.monotonic() + 10.0
    while furthest < far and time.monotonic() < end:
        page.wait_for_timeout(50.0)
        changes = [abs(a - b) for a, b in zip(first, weights(page), strict=True)]
        furthest = max(furthest, *changes)
    return furthest


def until(true: Callable[[], bool]) -> None:
    """Waits; the page's own rules let nobody evaluate in it again and again."""
    end = time.monotonic() + 60.0
    while not true():
        assert time.monotonic() < end, "never came"
        time.sleep(0.05)


def picture(page: Page, name: str) -> None:
    """A picture of the page, for those who name a folder to look at them."""
    if "MIEN_PICTURES" in os.environ:
        page.screenshot(path=Path(os.environ["MIEN_PICTURES"], f"{name}.png"))


def place(page: Page) -> float:
    """Where the slider of the timeline is, seconds."""
    return float(page.input_value("#place"))


def said(page: Page) -> str:
    """What came of a face that was held."""
    page.wait_for_selector('#cue[data-quality]:not([data-quality=""])', state="attached")
    return page.locator("#cue").get_attribute("data-quality") or ""


def chosen(page: Page, press: str, path: Path) -> None:
    """A file, through the chooser that a button opens."""
    with page.expect_file_chooser() as chooser:
        page.click(press)
    chooser.value.set_files(path)


def got(page: Page, press: str, path: Path) -> str:
    """The file that a button gives."""
    with page.expect_download() as download:
        page.locator(press).first.click()
    download.value.save_as(path)
    return str(path)


def points_on_page(
    page: Page, model: bytes, places: list[list[float]]
) -> list[tuple[float, float]]:
    """Where in the picker places of a model are seen from its front."""
    size = struct.unpack_from("<I", model, 12)[0]
    face = json.loads(model[20 : 20 + size])["scenes"][0]["extras"]["face"]
    low, high, facing = face["low"], face["high"], face["facing"]
    middle = [(a + b) / 2.0 for a, b in zip(low, high, strict=True)]
    away, box = AWAY * math.dist(low, high), page.locator("#pickCanvas").bounding_box()
    assert box is not None
    found = []
    for x, y, z in places:
        scale = box["height"] / 2.0 / math.tan(HALF_FIELD) / (away - facing * (z - middle[2]))
        across = box["x"] + box["width"] / 2.0 + facing * (x - middle[0]) * scale
        found.append((across, box["y"] + box["height"] / 2.0 - (y - middle[1]) * scale))
    return found


def open_page(page: Page, folder: Path) -> dict[str, object]:
    """Whoever opens the page sees the sample act."""
    page.wait_for_selector("#state[data-state=following]")
    picture(page, "open")
    return {"first": page.evaluate("document.body.dataset.source")}


def perform(page: Page, folder: Path) -> dict[str, object]:
    """The camera moves the characters; weights are pinned and let go."""
    page.click("#camera")
    page.wait_for_selector("body[data-source=camera]")
    page.wait_for_selector("#state[data-state=following]")
    stage = page.locator("#theatre")
    before = stage.screenshot()
    moved = moving(page, 0.3)
    picture(page, "camera")
    late = page.evaluate("performance.getEntriesByName('camera to canvas').map(e => e.duration)")
    page.locator(".bar input").first.fill("0.5")
    until(lambda: weights(page)[0] == 0.5)
    page.locator(".bar .mute").nth(1).click()
    picture(page, "pinned")
    page.click("#letgo")
    until(lambda: weights(page)[0] != 0.5)
    return {
        "weights_moved": moved,
        "canvas_changed": stage.screenshot() != before,
        "late_ms": sorted(late),
    }


def hold(page: Page, folder: Path) -> dict[str, object]:
    """The performer is learnt, holds faces, is kept, forgotten and met again."""
    page.keyboard.press("n")
    rest = said(page)
    for _ in range(8):  # some moments of the sample are no face but rest
        page.keyboard.press("e")
        if said(page) != "refused":
            break
    picture(page, "held")
    learnt = page.locator("#faces em").count()
    kept = got(page, "#keep", folder / "me.performer")
    page.click("#forget")
    page.wait_for_selector("#faces .none")
    chosen(page, "#meet", Path(kept))
    page.wait_for_selector("#faces em")
    met = page.locator("#faces em").count()
    page.click("#tabWeights")
    return {"rest": rest, "learnt": learnt, "met": met, "performer": kept}


def record(page: Page, folder: Path) -> dict[str, object]:
    """A take is recorded with what the microphone hears, played, wound and exported."""
    page.wait_for_selector("#state[data-state=following]")
    page.click("#microphone")
    page.click("#record")
    page.wait_for_selector("#record[aria-pressed=true]")
    page.wait_for_timeout(1500.0)
    with page.expect_response(lambda answer: answer.url.endswith("/sound")):
        page.click("#record")
    page.wait_for_selector("#record[aria-pressed=false]")
    page.click("#takes button")
    page.wait_for_selector("#timeline:not([hidden])")
    page.wait_for_selector("#hear:not([hidden])")
    until(lambda: place(page) > 0.1)
    page.click("#play")
    page.wait_for_timeout(400.0)
    stopped = place(page)
    page.wait_for_timeout(300.0)
    still = place(page) == stopped
    page.evaluate(
        "const slider = document.getElementById('place'); slider.value = 0.8;"
        "slider.dispatchEvent(new Event('input'))"
    )
    page.wait_for_timeout(500.0)
    wound = place(page)
    page.keyboard.press("t")
    page.keyboard.press("x")
    picture(page, "take_dark")
    export = got(page, "#exports a:text('GLB')", folder / "export.glb")
    table = got(page, "#exports a:text('CSV')", folder / "export.csv")
    told = got(page, "#exports a:text('Live Link')", folder / "told.csv")
    page.keyboard.press("x")
    return {"still": still, "wound": wound, "export": export, "table": table, "told": told}


def bring(page: Page, folder: Path) -> dict[str, object]:
    """Somebody's take plays, and a video with its sound, which is let go over the page."""
    chosen(page, "#open", folder / "told.csv")
    page.wait_for_selector("#takes button:text('told')")
    take = moving(page, 0.02)
    picture(page, "take_brought")
    film = base64.b64encode((folder / "film.mp4").read_bytes()).decode()
    page.evaluate(DROP, ["film.mp4", film])
    page.wait_for_selector("body[data-source=video]")
    page.wait_for_selector("#state[data-state=following]")
    page.wait_for_selector("#hear:not([hidden])")
    return {"take_moved": take}


def point(page: Page, folder: Path) -> dict[str, object]:
    """A character whose face is not found is pointed at, and acts."""
    with page.expect_response(lambda answer: "/models/" in answer.url) as answer:
        chosen(page, "#cast .add", folder / "squashed.glb")
    page.wait_for_selector("#picking[open]")
    page.wait_for_selector(".notes .busy", state="detached")
    places = json.loads((folder / "squashed.json").read_text())
    for x, y in points_on_page(page, answer.value.body(), places):
        page.mouse.click(x, y)
    page.keyboard.press("z")
    page.mouse.click(x, y)
    picture(page, "picked")
    page.click("#pickDone")
    page.wait_for_selector("#plates span:text('squashed')")
    page.select_option("#actor", "squashed")
    moved = moving(page, 0.1)
    picture(page, "brought")
    return {"guest_moved": moved}


def without_camera(page: Page, folder: Path) -> dict[str, object]:
    """A camera that may not be used is told, and the sample plays."""
    page.evaluate("() => { navigator.mediaDevices.getUserMedia = () => Promise.reject(Error()); }")
    page.click("#camera")
    note = page.wait_for_selector("#notes .error")
    told = note.text_content() if note else ""  # it goes after some seconds
    page.wait_for_selector("body[data-source=sample]")
    picture(page, "no_camera")
    return {"told_of_camera": told}


STEPS: tuple[Callable[[Page, Path], dict[str, object]], ...] = (
    open_page,
    perform,
    hold,
    record,
    bring,
    point,
    without_camera,
)


def main() -> None:
    """Use the page as a person would."""
    address, camera, chromium, folder = sys.argv[1:]
    arguments = [
        "--no-sandbox",
        "--use-fake-ui-for-media-stream",
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-video-capture={camera}",
    ]
    seen: dict[str, object] = {}
    errors: list[str] = []
    foreign: list[str] = []

    def ask(url: str) -> None:
        if not url.startswith((address, "blob:", "data:")):
            foreign.append(url)

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=arguments)
        context = browser.new_context(
            viewport={"width": 1280, "height": 720}, permissions=["camera", "microphone"]
        )
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", lambda request: ask(request.url))
        page.goto(address)
        page.wait_for_selector("#cast button")
        for step in STEPS:
            begin = time.monotonic()
            seen |= step(page, Path(folder))
            print(f"{step.__name__} {time.monotonic() - begin:.1f} s", file=sys.stderr)
        browser.close()
    print(json.dumps({**seen, "errors": errors, "foreign": foreign}))


if __name__ == "__main__":
    main()

"""Opens the studio in Chromium with a video as its camera, uses it, and prints what it saw as JSON.

BROWSER_PYTHON page.py ADDRESS CAMERA.mjpeg CHROMIUM FOLDER

FOLDER holds squashed.glb, a face that nobody finds by looking, squashed.json, where its feature
points are, and film.mp4.
"""

import json
import math
import struct
import sys
import time
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

HALF_FIELD = math.radians(12.0)
"""Half of the picker's field of view, and ..."""
AWAY = 2.4
"""... how far it looks from, in sizes of the face."""


def weights(page: Page) -> list[float]:
    """The bars' levels."""
    script = "b => b.map(i => Number(i.style.transform.slice(7, -1) || 0))"
    found: list[float] = page.eval_on_selector_all(".bar .track i", script)
    return found


def moving(page: Page, seconds: float) -> float:
    """The furthest any bar moves in that time."""
    first = weights(page)
    furthest = 0.0
    for _ in range(int(seconds / 0.25)):
        time.sleep(0.25)
        changes = [abs(a - b) for a, b in zip(first, weights(page), strict=True)]
        furthest = max(furthest, *changes)
    return furthest


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


def perform(page: Page, folder: Path) -> dict[str, object]:
    """The camera moves the characters."""
    page.screenshot(path=folder / "open.png")
    page.click("#camera")
    page.wait_for_selector("#state[data-state=following]")
    stage = page.locator("#theatre")
    before = stage.screenshot()
    moved = moving(page, 4.0)
    page.screenshot(path=folder / "camera.png")
    late = page.evaluate("performance.getEntriesByName('camera to canvas').map(e => e.duration)")
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
    page.screenshot(path=folder / "held.png")
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
    time.sleep(2.0)
    with page.expect_response(lambda answer: answer.url.endswith("/sound")):
        page.click("#record")
    page.wait_for_selector("#record[aria-pressed=false]")
    page.click("#takes button")
    page.wait_for_selector("#timeline:not([hidden])")
    page.wait_for_selector("#hear:not([hidden])")
    page.wait_for_function("Number(document.getElementById('place').value) > 0.3")
    page.click("#play")
    time.sleep(0.6)
    stopped = place(page)
    time.sleep(0.4)
    still = place(page) == stopped
    page.evaluate(
        "const slider = document.getElementById('place'); slider.value = 1;"
        "slider.dispatchEvent(new Event('input'))"
    )
    time.sleep(0.8)
    wound = place(page)
    page.keyboard.press("t")
    page.screenshot(path=folder / "take_dark.png")
    export = got(page, "#exports a:text('GLB')", folder / "export.glb")
    table = got(page, "#exports a:text('CSV')", folder / "export.csv")
    return {"still": still, "wound": wound, "export": export, "table": table}


def bring(page: Page, folder: Path) -> dict[str, object]:
    """A video plays with its sound; a character whose face is not found is pointed at, and acts."""
    chosen(page, "#video-file", folder / "film.mp4")
    page.wait_for_selector("#state[data-state=following]")
    page.wait_for_selector("#hear:not([hidden])")
    with page.expect_response(lambda answer: "/models/" in answer.url) as answer:
        chosen(page, "#cast .add", folder / "squashed.glb")
    page.wait_for_selector("#picking[open]")
    page.wait_for_selector(".notes .busy", state="detached")
    places = json.loads((folder / "squashed.json").read_text())
    for x, y in points_on_page(page, answer.value.body(), places):
        page.mouse.click(x, y)
    page.keyboard.press("z")
    page.mouse.click(x, y)
    page.screenshot(path=folder / "picked.png")
    page.click("#pickDone")
    page.wait_for_selector("#plates span:text('squashed')")
    page.select_option("#actor", "squashed")
    moved = moving(page, 4.0)
    page.screenshot(path=folder / "brought.png")
    return {"guest_moved": moved, "points": page.url + "points/squashed.toml"}


def without_camera(page: Page, folder: Path) -> dict[str, object]:
    """A camera that may not be used is told, and nothing breaks."""
    page.evaluate("() => { navigator.mediaDevices.getUserMedia = () => Promise.reject(Error()); }")
    page.click("#camera")
    page.wait_for_selector("#notes .error")
    page.screenshot(path=folder / "no_camera.png")
    return {"told": page.locator("#notes .error").last.text_content()}


STEPS: tuple[Callable[[Page, Path], dict[str, object]], ...] = (
    perform,
    hold,
    record,
    bring,
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

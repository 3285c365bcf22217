"""Opens the studio in Chromium with a video as its camera, uses it, and prints what it saw as JSON.

BROWSER_PYTHON page.py ADDRESS CAMERA.mjpeg CHROMIUM FOLDER
"""

import json
import sys
import time
from pathlib import Path

from playwright.sync_api import Page, sync_playwright


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


def main() -> None:
    """Use the page as a person would."""
    address, camera, chromium, folder = sys.argv[1:]
    arguments = ["--no-sandbox", "--use-fake-ui-for-media-stream"]
    arguments += [
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-video-capture={camera}",
    ]
    seen: dict[str, object] = {}
    errors: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=arguments)
        context = browser.new_context(
            viewport={"width": 1280, "height": 720}, permissions=["camera"]
        )
        page = context.new_page()
        page.set_default_timeout(60_000)
        page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: errors.append(str(error)))
        foreign = []
        page.on(
            "request",
            lambda r: (
                foreign.append(r.url) if not r.url.startswith((address, "blob:", "data:")) else None
            ),
        )
        page.goto(address)
        page.wait_for_selector("#cast button")
        page.screenshot(path=f"{folder}/open.png")
        page.click("#camera")
        page.wait_for_selector("#state[data-state=following]")
        stage = page.locator("#theatre")
        before = stage.screenshot()
        seen["weights_moved"] = moving(page, 6.0)
        seen["canvas_changed"] = stage.screenshot() != before
        page.screenshot(path=f"{folder}/camera.png")
        page.click("#tabFaces")
        page.click("#poses button[data-pose=neutral]")
        page.wait_for_selector("#state[data-state=waiting]")
        page.wait_for_selector("#state[data-state=following]")
        page.click("#record")
        page.wait_for_selector("#record[aria-pressed=true]")
        time.sleep(3.0)
        page.click("#record")
        page.wait_for_selector("#record[aria-pressed=false]")
        page.click("#takes button")
        page.wait_for_selector("#timeline:not([hidden])")
        time.sleep(2.0)
        page.click("#theme")
        page.screenshot(path=f"{folder}/take_dark.png")
        with page.expect_download() as download:
            page.click("#exports a")
        path = Path(folder) / "export.glb"
        download.value.save_as(path)
        seen["export"] = str(path)
        browser.close()
    print(json.dumps({**seen, "errors": errors, "foreign": foreign}))


if __name__ == "__main__":
    main()

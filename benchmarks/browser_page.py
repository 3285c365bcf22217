"""The studio's page in Chromium, with a video as its camera: says "following" once it follows, and
after a line from its input what it measured since, as JSON.

BROWSER_PYTHON browser_page.py ADDRESS CAMERA.mjpeg CHROMIUM
"""

import json
import sys
import time
from statistics import quantiles

from playwright.sync_api import sync_playwright

DRAWN = """() => {
    window.drawn = 0;
    const draw = () => { drawn++; requestAnimationFrame(draw); };
    draw();
}"""
LATE = "performance.getEntriesByName('camera to canvas').map(entry => entry.duration)"


def main() -> None:
    """Act before the page."""
    address, camera, chromium = sys.argv[1:]
    arguments = [
        "--no-sandbox",
        "--use-fake-ui-for-media-stream",
        "--use-fake-device-for-media-stream",
        f"--use-file-for-fake-video-capture={camera}",
    ]
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=arguments)
        context = browser.new_context(
            viewport={"width": 1280, "height": 720}, permissions=["camera", "microphone"]
        )
        page = context.new_page()
        page.set_default_timeout(120_000)
        page.goto(address)
        page.wait_for_selector("#cast button")
        page.click("#camera")
        page.wait_for_selector("body[data-source=camera]")
        page.wait_for_selector("#state[data-state=following]")
        page.evaluate(DRAWN)
        begin = time.monotonic()
        print("following", flush=True)
        sys.stdin.readline()
        late, drawn = page.evaluate(LATE), page.evaluate("drawn")
        seconds = time.monotonic() - begin
        browser.close()
    told = quantiles(late, n=20)
    figures = {
        "canvas_p50_ms": told[9],
        "canvas_p95_ms": told[18],
        "shown_fps": len(late) / seconds,
        "drawn_fps": drawn / seconds,
    }
    print(json.dumps(figures))


if __name__ == "__main__":
    main()

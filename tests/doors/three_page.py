"""Opens a page that draws with three.js, waits for it to move, and prints what it saw as JSON.

BROWSER_PYTHON three_page.py CHROMIUM ADDRESS FOLDER
"""

import json
import sys
import time

from playwright.sync_api import sync_playwright

SOFTWARE = ["--no-sandbox", "--use-gl=swiftshader", "--enable-unsafe-swiftshader"]


def main() -> None:
    """Look at the canvas until it changes."""
    chromium, address, folder = sys.argv[1:]
    errors: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=SOFTWARE)
        page = browser.new_context(viewport={"width": 480, "height": 360}).new_page()
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto(address)
        canvas = page.wait_for_selector("canvas")
        pictures = set()
        for _ in range(60):
            pictures.add(canvas.screenshot(path=f"{folder}/page.png"))
            if len(pictures) > 3 or errors:
                break
            time.sleep(0.5)
        browser.close()
    print(json.dumps({"errors": errors, "pictures": len(pictures)}))


if __name__ == "__main__":
    main()

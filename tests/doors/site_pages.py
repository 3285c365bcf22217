"""Opens pages of a built site in Chromium, takes their pictures, and prints what was asked of whom.

BROWSER_PYTHON site_pages.py CHROMIUM ADDRESS FOLDER PAGE...
"""

import json
import sys

from playwright.sync_api import sync_playwright


def main() -> None:
    """Read the pages as a person would: from top to bottom, and search."""
    chromium, address, folder, *paths = sys.argv[1:]
    requests: list[str] = []
    errors: list[str] = []
    broken: dict[str, list[str]] = {}
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        page.on("console", lambda m: errors.append(m.text) if m.type == "error" else None)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", lambda request: requests.append(request.url))
        for path in paths:
            page.goto(f"{address}/{path}")
            page.wait_for_load_state("networkidle")
            name = path.replace("/", "_").removesuffix(".html")
            page.screenshot(path=f"{folder}/{name}.png")
            page.screenshot(path=f"{folder}/{name}_whole.png", full_page=True)
            script = "all => all.filter(i => !i.complete || !i.naturalWidth).map(i => i.src)"
            broken[path] = page.eval_on_selector_all("article img", script)
        page.keyboard.press("/")
        page.keyboard.type("neutral")
        page.wait_for_selector(".md-search-result__item")
        found = page.locator(".md-search-result__item").count()
        browser.close()
    print(json.dumps({"requests": requests, "errors": errors, "broken": broken, "found": found}))


if __name__ == "__main__":
    main()

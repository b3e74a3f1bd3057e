"""Look at a built site in headless Chromium: python -m tools.site.look FOLDER PICTURES.

Each page is opened on a desk in light colors and on a telephone in dark ones. axe judges it, such
as its contrast and what a screen reader is told. Nothing may ask the network, or be wider than a
telephone. The keyboard alone has to lead to the text, and to what the search finds.
"""

from __future__ import annotations

import shutil
import sys
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Browser, Page, TimeoutError, sync_playwright

FRONT = "docs/site/index.html"
# Kept as pictures.
SEEN = (FRONT, "docs/manual.html", "docs/site/python_api.html", "docs/notebooks/figures.html")
SCREENS: dict[str, dict[str, Any]] = {
    "desk": {"viewport": {"width": 1280, "height": 900}, "color_scheme": "light"},
    "telephone": {"viewport": {"width": 390, "height": 844}, "color_scheme": "dark"},
}
# What is checked by axe: the levels A and AA of WCAG 2.1 and 2.2.
RULES = {"runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]}
# What is searched for, and how long anything may take, ms.
WORD, WAIT = "thickness", 20_000


def main() -> None:
    """Tell what is wrong with the pages, and exit with a message if anything is."""
    site, pictures = (Path(argument).resolve() for argument in sys.argv[1:3])
    pictures.mkdir(parents=True, exist_ok=True)
    folders = (site.glob("*.html"), (site / "docs").rglob("*.html"))
    found = {str(page.relative_to(site)) for folder in folders for page in folder}
    pages = sorted(found - {"index.html"})  # which leads on to the front page
    chromium = shutil.which("chromium") or sys.exit(
        "there is no chromium; apt-get install chromium"
    )
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    home = f"http://127.0.0.1:{server.server_port}/"
    with sync_playwright() as playwright:
        # Debian's sandbox needs rights that root in a container lacks; the pages are our own.
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        problems = [
            problem
            for screen in SCREENS
            for problem in faults(browser, home, pages, screen, pictures)
        ]
        problems += keyboard_faults(browser, home)
        browser.close()
    server.shutdown()
    print(f"{len(pages)} pages looked at on {len(SCREENS)} screens; pictures are in {pictures}")
    if problems:
        sys.exit("\n".join(problems))


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and logs nothing."""

    def log_message(self, *_: object) -> None:
        """Leave it."""


def faults(browser: Browser, home: str, pages: list[str], screen: str, pictures: Path) -> list[str]:
    """What is wrong with the pages on one screen."""
    problems: list[str] = []
    page = browser.new_context(**SCREENS[screen]).new_page()
    page.on(
        "request",
        lambda request: (
            request.url.startswith((home, "data:", "blob:", "about:"))
            or problems.append(f"{page.url} asks for {request.url}")
        ),
    )
    page.on("pageerror", lambda error: problems.append(f"{page.url}: {error}"))
    for name in pages:
        page.goto(home + name, wait_until="load")
        where = f"{name} on the {screen}"
        if name in SEEN:
            page.screenshot(path=pictures / f"{Path(name).stem}_{screen}.png")
        wide = page.evaluate("document.documentElement.scrollWidth - window.innerWidth")
        if wide > 0:
            problems.append(f"{where} is {wide} pixels too wide")
        for violation in Axe().run(page, options=RULES).response["violations"]:
            places = {node["html"][:200] for node in violation["nodes"]}
            problems.append(f"{where}: {violation['help']}: {len(places)}, as {min(places)}")
    page.context.close()
    return problems


def keyboard_faults(browser: Browser, home: str) -> list[str]:
    """What cannot be reached without a mouse."""
    page = browser.new_context(**SCREENS["desk"]).new_page()
    page.goto(home + FRONT)
    problems = []
    page.keyboard.press("Tab")
    if focused(page, "getAttribute('href')") != "#main-content":
        problems.append("the first Tab does not lead to the link that skips to the text")
    page.keyboard.press("Enter")
    if not page.url.endswith("#main-content"):
        problems.append("the link that skips to the text does not lead there")
    page.keyboard.press("Control+k")
    page.wait_for_selector("input[type=search]:focus")
    page.keyboard.type(WORD)
    page.keyboard.press("Enter")
    page.wait_for_selector("#search-results li a", timeout=WAIT)
    for _ in range(60):
        page.keyboard.press("Tab")
        if focused(page, "closest('#search-results') !== null"):
            break
    target = focused(page, "href")
    page.keyboard.press("Enter")
    try:
        page.wait_for_url(lambda url: "search.html" not in url, timeout=WAIT)
    except TimeoutError:
        problems.append(f"the keyboard does not lead to {target}, found for {WORD}")
    if WORD not in page.inner_text("main").lower():
        problems.append(f"{page.url}, found for {WORD}, does not have it")
    page.context.close()
    return problems


def focused(page: Page, what: str) -> Any:
    """Something of the element that has the focus."""
    return page.evaluate(f"document.activeElement.{what}")


if __name__ == "__main__":
    main()

"""A real Chromium without a window, for tests of pages. It may not go to the network."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.support.ui import WebDriverWait

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
_HAS_CHROMIUM = pytest.mark.skipif(
    not (CHROMIUM and DRIVER), reason="Chromium and its driver are not installed"
)

_FLAGS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync", "--proxy-server=127.0.0.1:9",
)  # fmt: skip
"""The proxy is where nobody listens: what a page wanted to load would be an error in the console."""

PATIENCE_S = 60

PAPER_PX = 717
"""An A4 page between Chromium's margins."""

CUT_OFF = """Array.from(document.querySelectorAll('body :not(.unseen)')).filter(
    each => each.clientWidth && each.scrollWidth > each.clientWidth && getComputedStyle(each).overflowX != 'visible'
).map(each => each.outerHTML.slice(0, 99))"""
"""An expression for what has more in it than it shows."""


def needs_chromium(test: Callable[..., None]) -> Callable[..., None]:
    """Skip a test where there is none. To start one takes seconds: such tests are exhaustive."""
    marked: Callable[..., None] = pytest.mark.exhaustive(_HAS_CHROMIUM(test))
    return marked


class Browser:
    """One page of a browser."""

    def __init__(self, driver: webdriver.Chrome) -> None:
        self.driver = driver

    def look(self, *, width: int = 1280, height: int = 900, scheme: str = "light", medium: str = "") -> None:
        """Be as wide as this, and as light or dark; the medium is "print" for paper."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        media = {"media": medium, "features": [{"name": "prefers-color-scheme", "value": scheme}]}
        self.driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
        self.driver.execute_cdp_cmd("Emulation.setEmulatedMedia", media)

    def open(self, page: Path) -> None:
        """Open a page and wait for its charts."""
        self.driver.get(page.as_uri())
        drawn = "return document.documentElement.dataset.drawn === 'yes'"
        WebDriverWait(self.driver, PATIENCE_S).until(lambda driver: driver.execute_script(drawn))

    def ask(self, script: str) -> object:
        """Return the value of an expression."""
        return self.driver.execute_script(f"return {script}")

    def complaints(self) -> list[str]:
        """Return what the console said since the last time, warnings included."""
        return [each["message"] for each in self.driver.get_log("browser")]


@contextmanager
def browsing(folder: Path) -> Iterator[Browser]:
    """Yield a new browser that keeps all of its own in `folder`."""
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM or ""
    for each in (*_FLAGS, f"--user-data-dir={folder}"):
        options.add_argument(each)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options=options, service=Service(DRIVER))
    try:
        yield Browser(driver)
    finally:
        driver.quit()

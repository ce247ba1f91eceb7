"""Windows of Chromium without a screen, in which the pages of others are opened and photographed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from selenium import webdriver
from selenium.webdriver.support.ui import WebDriverWait

PATIENCE_S = 60
FLAGS = ("--headless=new", "--no-sandbox", "--hide-scrollbars", "--enable-unsafe-swiftshader")
"""Without a display, as root too, and with WebGL where there is no graphics card."""


@contextmanager
def window(width: int, height: int) -> Iterator[tuple[webdriver.Chrome, WebDriverWait[webdriver.Chrome]]]:
    """Open a window, and return it with one that waits for it to have drawn something."""
    options = webdriver.ChromeOptions()
    for flag in FLAGS:
        options.add_argument(flag)
    driver = webdriver.Chrome(options)
    try:
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)  # a window has borders, too
        yield driver, WebDriverWait(driver, PATIENCE_S)
    finally:
        driver.quit()


def settle(driver: webdriver.Chrome) -> None:
    """Wait until a page that draws as its data come has drawn."""
    driver.execute_async_script("setTimeout(arguments[0], 3000)")

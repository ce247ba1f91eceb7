"""Open a flame graph in speedscope's own page, and keep a picture of it: `pip install -e ".[pictures]"; python docs/made/flame_graph.py`.

npm brings that page, and nothing is loaded from elsewhere. Its buttons have emoji: Debian's fonts-noto-color-emoji.
"""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import tarfile
import tempfile
from pathlib import Path

from pictures import bfsim, keep_small
from selenium.webdriver.common.by import By
from windows import settle, window

SPEEDSCOPE = "speedscope@1.25.0"
SIZE = 1200, 245


def page_of(package: str, folder: Path) -> Path:
    """Fetch a version of speedscope, and return its page."""
    npm = shutil.which("npm")
    assert npm, "npm must be installed: it brings speedscope"
    subprocess.run([npm, "pack", package, "--silent"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    (archive,) = folder.glob("*.tgz")
    with tarfile.open(archive) as content:
        content.extractall(folder, filter="data")
    return folder / "package" / "dist" / "release" / "index.html"


def photograph(flame: Path, page: Path, picture: Path) -> None:
    """Take a picture of the first profile of a file, the dearest first. A page without a server is told a file by a script."""
    script = flame.with_suffix(".js")
    content = json.dumps(base64.b64encode(flame.read_bytes()).decode())
    script.write_text(f"speedscope.loadFileFromBase64({json.dumps(flame.name)}, {content})")
    with window(*SIZE) as (driver, wait):
        driver.get(f"{page.as_uri()}#localProfilePath={str(script)[1:]}&view=left-heavy")
        wait.until(lambda each: "core A" in each.find_element(By.TAG_NAME, "body").text)
        settle(driver)
        driver.save_screenshot(str(picture))


def main() -> None:
    """Write `docs/images/flame.png`."""
    with tempfile.TemporaryDirectory() as name:
        flame, picture = Path(name) / "run.json", Path(name) / "flame.png"
        bfsim("run", "--flame", str(flame))
        photograph(flame, page_of(SPEEDSCOPE, Path(name)), picture)
        keep_small(picture, "flame.png", SIZE[0])


if __name__ == "__main__":
    main()

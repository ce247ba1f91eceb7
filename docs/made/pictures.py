"""Make the pictures of the documentation: `python docs/made/pictures.py` after a change that they show."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import rooms
from PIL import Image

IMAGES = Path(__file__).parent.parent / "images"
PROFILING = IMAGES.parent / "how-to" / "profile.md"
CHROMIUM = shutil.which("chromium")
PAGE_SIZE = "1280,2560"  # of the window in px: from the verdict to the Gantt chart
FRAME = 2  # of the built-in recording: the ball rolls before the goal


def bfsim(*arguments: str) -> None:
    """Run a command of this checkout."""
    subprocess.run([sys.executable, "-m", "bfsim", *arguments], check=True, stdout=subprocess.DEVNULL)


def keep_small(source: Path, name: str, width: int) -> None:
    """Keep a picture in `docs/images`, `width` pixels wide and with 256 colours, so that it loads fast."""
    with Image.open(source) as picture:
        height = picture.height * width // picture.width
        small = picture.convert("RGB").resize((width, height), Image.Resampling.LANCZOS)
        small.quantize(256).save(IMAGES / name, optimize=True)


def photograph(page: Path, picture: Path) -> None:
    """Take a picture of the top of a page with Chromium, with a new profile beside it."""
    flags = ("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--virtual-time-budget=10000",
             f"--user-data-dir={picture.parent / 'chromium'}", f"--window-size={PAGE_SIZE}")  # fmt: skip
    subprocess.run(
        [CHROMIUM, *flags, f"--screenshot={picture}", page.as_uri()], check=True, capture_output=True
    )


def heat_of_the_case(folder: Path) -> None:
    """Show where in the picture the firmware of the page on profiling spends its time."""
    (case,) = re.findall(r'```python title="gradient.py"\n(.*?)```', PROFILING.read_text(), re.DOTALL)
    firmware = folder / "gradient.py"
    firmware.write_text(case)
    bfsim("run", "--firmware", f"{firmware}:firmware", "--frames", "1", "--overlay", str(folder / "heat"),
          "--heat", "Slopes")  # fmt: skip
    keep_small(folder / "heat" / "frame-0000.png", "slow_rows.png", 1148)


def main() -> None:
    """Write every picture into `docs/images`."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        bfsim("run", "--frames", str(FRAME + 1), "--overlay", folder)
        keep_small(sorted(Path(folder).glob("frame-*.png"))[FRAME], "overlay.png", 1320)
        colours = Path(folder) / "colours.png"
        bfsim("colours", "--frame", str(FRAME), "--out", str(colours))
        keep_small(colours, "colours.png", 980)
        if CHROMIUM:
            page = Path(folder) / "run.html"
            bfsim("run", "--html", str(page), "--target", "15Hz")
            photograph(page, page.with_suffix(".png"))
            keep_small(page.with_suffix(".png"), "page.png", 1280)
        else:
            sys.stderr.write("page.png stays as it is: Chromium is not installed\n")
        heat_of_the_case(Path(folder))
        placement = Path(folder) / "placement.png"
        bfsim("ldf", "--picture", str(placement))
        keep_small(placement, "placement.png", 1360)
    (IMAGES / "rooms.svg").write_text(rooms.drawing())


if __name__ == "__main__":
    main()

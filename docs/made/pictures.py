"""Make the pictures of the documentation: `python docs/made/pictures.py` after a change that they show."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

import rooms
from PIL import Image

IMAGES = Path(__file__).parent.parent / "images"
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


def main() -> None:
    """Write every picture into `docs/images`."""
    IMAGES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        bfsim("run", "--frames", str(FRAME + 1), "--overlay", folder)
        keep_small(sorted(Path(folder).glob("frame-*.png"))[FRAME], "overlay.png", 1320)
        colours = Path(folder) / "colours.png"
        bfsim("colours", "--frame", str(FRAME), "--out", str(colours))
        keep_small(colours, "colours.png", 980)
        placement = Path(folder) / "placement.png"
        bfsim("ldf", "--picture", str(placement))
        keep_small(placement, "placement.png", 1360)
    (IMAGES / "rooms.svg").write_text(rooms.drawing())


if __name__ == "__main__":
    main()

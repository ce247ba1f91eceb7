"""The pictures of an overlay as one file that shows them one after the other: GIF, WebP, APNG, MP4."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from bfsim.errors import ConfigError
from bfsim.report.overlay.style import PAPER

FRAME_MS = 200
"""How long an animated file shows a frame: long enough to look at it."""

TAG = "bfsim overlay"
"""A remark in each file, by which an earlier overlay is known."""


def _images(frames: Sequence[Path]) -> Iterator[Image.Image]:
    """Yield the pictures, all on paper as large as the largest: firmware may change the size during a run."""
    sizes = []
    for each in frames:
        with Image.open(each) as image:
            sizes.append(image.size)
    # video has one sample of colour for two by two pixels: no odd row or column
    width, height = (-(-max(size[axis] for size in sizes) // 2) * 2 for axis in (0, 1))
    for each in frames:
        paper = Image.new("RGB", (width, height), PAPER)
        with Image.open(each) as image:
            paper.paste(image)
        yield paper


def _save_animation(images: Iterator[Image.Image], target: Path, **options: Any) -> None:
    first, *others = images
    first.save(target, save_all=True, append_images=others, duration=FRAME_MS, loop=0, **options)


def _encode_gif(frames: Sequence[Path], target: Path) -> None:
    # of Pillow's palettes this one keeps the colours of thin marks
    few = (
        image.quantize(method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
        for image in _images(frames)
    )
    _save_animation(few, target, format="GIF", comment=TAG)


def _encode_webp(frames: Sequence[Path], target: Path) -> None:
    _save_animation(_images(frames), target, format="WEBP", quality=85, method=2, xmp=TAG.encode())


def _encode_apng(frames: Sequence[Path], target: Path) -> None:
    _save_animation(_images(frames), target, format="PNG", pnginfo=png_remark())


def _encode_mp4(frames: Sequence[Path], target: Path) -> None:
    import av

    with av.open(str(target), "w") as container:
        container.metadata["comment"] = TAG
        stream = container.add_stream("libx264", rate=1000 // FRAME_MS, options={"crf": "18"})
        stream.pix_fmt = "yuv420p"
        for image in _images(frames):
            if not stream.codec_context.is_open:
                stream.width, stream.height = image.size
            container.mux(stream.encode(av.VideoFrame.from_ndarray(np.asarray(image), format="rgb24")))
        container.mux(stream.encode(None))


ENCODERS: dict[str, Callable[[Sequence[Path], Path], None]] = {
    ".gif": _encode_gif,
    ".webp": _encode_webp,
    ".apng": _encode_apng,
    ".mp4": _encode_mp4,
}


def encoder_of(path: Path) -> Callable[[Sequence[Path], Path], None]:
    """Return what makes the file; raise ConfigError if nothing does."""
    suffix = path.suffix.lower()
    if suffix not in ENCODERS:
        raise ConfigError(f"--overlay must be a folder or a file *{', *'.join(ENCODERS)}, not {path}")
    if suffix == ".mp4":
        try:
            import av  # noqa: F401
        except ImportError:
            raise ConfigError(
                f'{path}: writing video needs the package PyAV; install it with: pip install "bfsim[video]"'
            ) from None
    return ENCODERS[suffix]


def png_remark() -> PngInfo:
    """Return the remark as PNG has it."""
    remark = PngInfo()
    remark.add_text("Comment", TAG)
    return remark

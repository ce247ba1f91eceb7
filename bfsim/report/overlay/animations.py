"""The pictures of an overlay as one animated file: GIF, WebP, APNG, MP4."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
"""A remark in each file that identifies an earlier overlay."""


Frame = Callable[[int], Image.Image]
"""The number of a picture → the picture."""


class _Film(Image.Image):
    """Pictures in the form in which Pillow has those of an animated file: only the current one is in memory."""

    def __init__(self, frame: Frame, count: int) -> None:
        super().__init__()
        self.n_frames = count
        self._frame = frame
        self._number = -1
        self.seek(0)

    def seek(self, frame: int) -> None:
        """Go to a picture."""
        if frame >= self.n_frames:
            raise EOFError
        if frame != self._number:
            image = self._frame(frame)
            self.im, self._mode, self._size, self.palette = image.im, image.mode, image.size, image.palette
            self._number = frame

    def tell(self) -> int:
        """Return the number of the current picture."""
        return self._number


def _on_paper(frames: Sequence[Path]) -> Frame:
    """Return a function that puts each picture on a sheet of the largest size: the size may change during a run."""
    sizes = []
    for each in frames:
        with Image.open(each) as image:
            sizes.append(image.size)
    # video stores colours for blocks of two by two pixels, so width and height must be even
    width, height = (-(-max(size[axis] for size in sizes) // 2) * 2 for axis in (0, 1))

    def frame(number: int) -> Image.Image:
        paper = Image.new("RGB", (width, height), PAPER)
        with Image.open(frames[number]) as image:
            paper.paste(image)
        return paper

    return frame


def _save_animation(frame: Frame, count: int, target: Path, **options: Any) -> None:
    _Film(frame, count).save(target, save_all=True, duration=FRAME_MS, loop=0, **options)


def _encode_gif(frames: Sequence[Path], target: Path) -> None:
    # of Pillow's palettes, this one keeps the colours of thin marks
    whole = _on_paper(frames)

    def frame(number: int) -> Image.Image:
        return whole(number).quantize(method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)

    _save_animation(frame, len(frames), target, format="GIF", comment=TAG)


def _encode_webp(frames: Sequence[Path], target: Path) -> None:
    options = {"quality": 85, "method": 2, "xmp": TAG.encode()}
    _save_animation(_on_paper(frames), len(frames), target, format="WEBP", **options)


def _encode_apng(frames: Sequence[Path], target: Path) -> None:
    _save_animation(_on_paper(frames), len(frames), target, format="PNG", pnginfo=png_remark())


def _encode_mp4(frames: Sequence[Path], target: Path) -> None:
    import av

    with av.open(str(target), "w") as container:
        container.metadata["comment"] = TAG
        stream = container.add_stream("libx264", rate=1000 // FRAME_MS, options={"crf": "18"})
        stream.pix_fmt = "yuv420p"
        for image in map(_on_paper(frames), range(len(frames))):
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
    """Return the function that makes such a file; raise ConfigError if there is none."""
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
    """Return the remark in the form for PNG."""
    remark = PngInfo()
    remark.add_text("Comment", TAG)
    return remark

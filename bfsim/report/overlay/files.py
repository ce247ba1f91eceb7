"""Overlays as files: a picture per frame in a folder, or one file that shows them one after the other."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from mmap import ACCESS_READ, mmap
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from bfsim.errors import ConfigError
from bfsim.files.drafts import draft_folder, sweep
from bfsim.files.save import require_name, require_place
from bfsim.report.overlay.layers import LAYERS
from bfsim.report.overlay.overlay import overlay_of
from bfsim.report.overlay.style import PAPER
from bfsim.seen import SeenFrame

FRAME_MS = 200
"""How long an animated file shows a frame: long enough to look at it."""

TAG = "bfsim overlay"
"""A remark in each file, by which an earlier overlay is known."""

KEPT_LEVEL, DRAFT_LEVEL = 4, 1
"""Of zlib, for pictures that are kept and for those that one file is made of: Pillow's 6 takes 1.6 to 2.5 times as long as 4 for 1 to 6 % less."""

_NAME = re.compile(r"frame-\d+\.png")


class OverlayWriter:
    """Context manager that draws frames for a folder, or for a file *.gif, *.webp, *.apng or *.mp4.

    All is drawn beside `path` and put in its place on a clean exit of the `with` block; after an error or Ctrl-C
    nothing is left. `layers` are what is drawn. An earlier overlay is replaced, and anything else in the folder
    refused: ConfigError, as for a place that cannot be written.
    """

    def __init__(self, path: Path, layers: Collection[str] = LAYERS) -> None:
        self.path = path
        self._layers = layers
        self._encode = None if path.is_dir() or not path.suffix else _encoder_of(path)
        if self._encode is None:
            _require_folder(path)
        else:
            require_place(path)
            if path.exists() and not _is_overlay(path):
                raise ConfigError(f"{path} must be a new file or an earlier overlay, not another file")
        self._drawn: list[Path] = []

    def __enter__(self) -> Self:
        with _writing(self.path), ExitStack() as stack:
            where = self.path if self.path.is_dir() else self.path.parent
            self._folder = stack.enter_context(draft_folder(where)) / "overlay"
            self._folder.mkdir()
            self._cleanup = stack.pop_all()
        return self

    def add(self, frame: SeenFrame) -> None:
        """Draw a frame."""
        file = self._folder / f"frame-{frame.index:04d}.png"
        level = DRAFT_LEVEL if self._encode else KEPT_LEVEL
        with _writing(self.path):
            overlay_of(frame, self._layers).save(file, "PNG", pnginfo=_remark(), compress_level=level)
        self._drawn.append(file)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._cleanup, _writing(self.path):
            if kind is None:
                self._publish()

    def _publish(self) -> None:
        if self._encode is not None:
            draft = self._folder / self.path.name
            self._encode(self._drawn, draft)
            draft.replace(self.path.resolve())
        elif self.path.is_dir():
            for old in list(_earlier(self.path)):
                old.unlink()
            for each in self._drawn:
                each.replace(self.path / each.name)
        else:
            self._folder.replace(self.path)


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
    _save_animation(_images(frames), target, format="PNG", pnginfo=_remark())


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


def _encoder_of(path: Path) -> Callable[[Sequence[Path], Path], None]:
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


def _require_folder(path: Path) -> None:
    """Raise ConfigError unless `path` can be the folder: new, empty, or of an earlier overlay."""
    if not path.is_dir():
        if path.exists():
            raise ConfigError(f"{path} must be a folder for the overlay, not a file")
        if not path.parent.is_dir():
            raise ConfigError(f"{path}: the folder {path.parent} must exist to make a folder there")
        require_name(path)
        return
    sweep(path)
    foreign = set(path.iterdir()) - set(_earlier(path))
    if foreign:
        raise ConfigError(
            f"{path} must be a new folder, an empty one or one of an earlier overlay, "
            f"but holds {min(foreign).name}, which is not of one"
        )


def _earlier(folder: Path) -> Iterator[Path]:
    """Return the pictures of an earlier overlay in a folder."""
    for file in folder.iterdir():
        if _NAME.fullmatch(file.name) and file.is_file() and _is_overlay(file):
            yield file


def _is_overlay(file: Path) -> bool:
    """Whether a file has the remark of an overlay, which every format stores as plain text."""
    if not file.stat().st_size:
        return False
    with file.open("rb") as stream, mmap(stream.fileno(), 0, access=ACCESS_READ) as content:
        return content.find(TAG.encode()) >= 0


def _remark() -> PngInfo:
    remark = PngInfo()
    remark.add_text("Comment", TAG)
    return remark


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise ConfigError(f"{path} must be writable: {error.strerror or error}") from error

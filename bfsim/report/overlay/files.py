"""Overlays as files: a picture per frame in a folder, or one animated file."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from contextlib import ExitStack, contextmanager
from mmap import ACCESS_READ, mmap
from pathlib import Path
from types import TracebackType
from typing import Self

from bfsim.errors import ConfigError
from bfsim.files.drafts import draft_folder, sweep
from bfsim.files.save import require_name, require_place
from bfsim.report.overlay.animations import TAG, encoder_of, png_remark
from bfsim.report.overlay.layers import LAYERS
from bfsim.report.overlay.overlay import overlay_of
from bfsim.seen import SeenFrame

KEPT_LEVEL, DRAFT_LEVEL = 4, 1
"""Levels of zlib for pictures that are kept, and for those that go into an animated file.

Pillow's 6 takes 1.6 to 2.5 times as long as 4 for files that are 1 to 6 % smaller.
"""

_NAME = re.compile(r"frame-\d+\.png")


class OverlayWriter:
    """Context manager that draws frames for a folder, or for a file *.gif, *.webp, *.apng or *.mp4.

    Everything is drawn beside `path` and moved into place on a clean exit of the `with` block; after an error or Ctrl-C
    nothing is left. `layers` are the layers to draw. An earlier overlay is replaced; if the folder holds anything else,
    or the place cannot be written, ConfigError is raised.
    """

    def __init__(self, path: Path, layers: Collection[str] = LAYERS) -> None:
        self.path = path
        self._layers = layers
        self._encode = None if path.is_dir() or not path.suffix else encoder_of(path)
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
            overlay_of(frame, self._layers).save(file, "PNG", pnginfo=png_remark(), compress_level=level)
        self._drawn.append(file)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._cleanup, _writing(self.path):
            if kind is None:
                self._publish()

    def _publish(self) -> None:
        if self._encode is not None:
            if not self._drawn:
                raise ConfigError(
                    f"{self.path}: there is nothing to draw: the firmware's view has shown nothing"
                )
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


def _require_folder(path: Path) -> None:
    """Raise ConfigError unless `path` can be the folder: new, empty, or with an earlier overlay in it."""
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
    """Whether a file contains the remark of an overlay, which every format stores as plain text."""
    if not file.stat().st_size:
        return False
    with file.open("rb") as stream, mmap(stream.fileno(), 0, access=ACCESS_READ) as content:
        return content.find(TAG.encode()) >= 0


@contextmanager
def _writing(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise ConfigError(f"{path} must be writable: {error.strerror or error}") from error

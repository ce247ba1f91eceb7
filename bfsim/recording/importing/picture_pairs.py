"""The pictures of both cameras, pair by pair, in the size of a recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

from bfsim.errors import RecordingError
from bfsim.recording.importing.import_checks import check_halves
from bfsim.recording.importing.sources import PictureSource, Skipped
from bfsim.recording.planes import YuvPlanes


@dataclass(slots=True)
class PicturePairs:
    """The pairs that exist; afterwards, what was `skipped`, and the `sizes` of the pictures.

    `sources`: one for the left and one for the right camera, or a single one with both halves `side_by_side` or with
    pictures for both. `resize`, `crop`: the (width, height) to which every picture is scaled or cut.
    """

    sources: Sequence[PictureSource]
    side_by_side: bool
    resize: tuple[int, int] | None
    crop: tuple[int, int] | None
    skipped: list[Skipped] = field(init=False)
    sizes: set[tuple[int, int]] = field(init=False, default_factory=set)

    def __post_init__(self) -> None:
        self.skipped = [each for source in self.sources for each in source.skipped]

    def __iter__(self) -> Iterator[tuple[int, YuvPlanes, YuvPlanes]]:
        """Yield number, left and right picture of each pair. Raises RecordingError if one camera has more pictures."""
        for index, sides in enumerate(_stereo_pairs(self.sources, self.side_by_side)):
            left, right = fitted = [_fitted(side, index, self.resize, self.crop) for side in sides]
            if isinstance(left, Skipped) or isinstance(right, Skipped):
                self.skipped += dict.fromkeys(each for each in fitted if isinstance(each, Skipped))
                continue
            self.sizes |= {side.size for side in sides if isinstance(side, YuvPlanes)}
            yield index, left, right


def _stereo_pairs(
    sources: Sequence[PictureSource], side_by_side: bool
) -> Iterator[tuple[YuvPlanes | Skipped, YuvPlanes | Skipped]]:
    """Yield the left and the right picture of each stereo frame."""
    if len(sources) == 1:
        for picture in sources[0].pictures():
            if side_by_side and isinstance(picture, YuvPlanes):
                check_halves(sources[0].name, picture.size)
                yield picture.halves()
            else:
                yield picture, picture
        return
    for count, (left, right) in enumerate(zip_longest(*(each.pictures() for each in sources))):
        if left is None or right is None:
            ended, other = sources if left is None else reversed(sources)
            raise RecordingError(
                f"both cameras must have the same number of images, but {ended.name} ends after {count} "
                f"and {other.name} has more"
            )
        yield left, right


def _fitted(
    picture: YuvPlanes | Skipped, index: int, resize: tuple[int, int] | None, crop: tuple[int, int] | None
) -> YuvPlanes | Skipped:
    """Return a picture of one side in the size of the recording, or the reason why not."""
    if isinstance(picture, Skipped):
        return picture
    if resize:
        return picture.resized(*resize)
    if crop:
        width, height = picture.size
        if width < crop[0] or height < crop[1]:
            reason = f"{width}x{height} is too small for `--crop` {crop[0]}x{crop[1]}; `--resize` scales"
            return Skipped(f"picture {index}", reason)
        return picture.cropped(*crop)
    return picture

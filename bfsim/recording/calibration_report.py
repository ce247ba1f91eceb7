"""The result of a calibration as a recording keeps it: errors of all pictures, what was left out, and the lenses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Literal

from bfsim.errors import RecordingError, cut
from bfsim.recording.importing.sources import Skipped

if TYPE_CHECKING:
    from pydantic import TypeAdapter

LensName = Literal["pinhole", "fisheye"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewError:
    """A view of the board: the names of its pictures, of one camera or the left and the right one, and their errors.

    errors_px are the RMS distances between the corners found and those of the fitted cameras. `is_outlier`: the cameras
    were fitted without it.
    """

    names: tuple[str, ...]
    errors_px: tuple[float, ...]
    is_outlier: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LensFit:
    """A fitted camera: focal lengths and principal point, across and down, and the terms of distortion."""

    focal_px: tuple[float, float]
    principal_px: tuple[float, float]
    distortion: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationReport:
    """The result of a calibration with chessboards.

    reprojection_px is the RMS distance between the corners found and those of the fitted cameras, without outliers.
    vertical_rms_px and vertical_worst_px tell how far the rows of a corner differ between the rectified pictures, and
    vertical_before_px (RMS) between the recorded ones; they are 0 for a single camera, as is baseline_mm. focal_px is
    that of the rectified pictures, whose principal point is their middle; baseline_mm is as accurate as the size of the
    squares.
    """

    lens: LensName
    cameras: tuple[LensFit, ...]
    views: tuple[ViewError, ...]
    skipped: tuple[Skipped, ...]
    reprojection_px: float
    vertical_before_px: float
    vertical_rms_px: float
    vertical_worst_px: float
    focal_px: float
    baseline_mm: float

    @property
    def used(self) -> tuple[ViewError, ...]:
        """The views that the cameras were fitted to."""
        return tuple(view for view in self.views if not view.is_outlier)

    @property
    def outliers(self) -> tuple[ViewError, ...]:
        """The views that were left out because they fit none of the others."""
        return tuple(view for view in self.views if view.is_outlier)

    @property
    def has_measured_focal(self) -> bool:
        """Whether the focal length was measured, as the mean of the left camera's, rather than given."""
        return any(self.focal_px == mean_focal_px(left.focal_px) for left in self.cameras[:1])

    def to_json(self) -> str:
        """Return the report as text."""
        return _adapter().dump_json(self).decode()

    @classmethod
    def from_json(cls, text: str) -> CalibrationReport:
        """Return the report from its text. Raises RecordingError."""
        from pydantic import ValidationError

        try:
            return _adapter().validate_json(text)
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"])) or "it"
            raise RecordingError(
                f"calibration must be as bfsim writes it: {cut(where)}: {cut(first['msg'])}"
            ) from None


def mean_focal_px(focal_px: tuple[float, float]) -> float:
    """Return the single focal length of a rectified picture, from the ones across and down of its camera."""
    return sum(focal_px) / 2


@cache
def _adapter() -> TypeAdapter[CalibrationReport]:
    """Return the adapter for the JSON of reports, made when needed: few recordings have one, and pydantic loads slowly."""
    from pydantic import TypeAdapter

    return TypeAdapter(CalibrationReport)

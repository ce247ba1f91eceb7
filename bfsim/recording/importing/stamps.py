"""When the pictures of a recording were taken: evenly, or at the times of their sources."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from bfsim.errors import RecordingError
from bfsim.recording.importing.sources import PictureSource

DEFAULT_FPS = Fraction(30)
"""For sources that do not say: the VGA rate of the OmniVision sensors."""

FPS_PARTS = 1_000_000
"""The largest denominator of a frame rate as a fraction; also the highest rate."""


@dataclass(frozen=True, slots=True)
class Stamps:
    """The time stamps of stereo frames from `sources`. `is_even`: the sources' own times are ignored.

    `has_pairs`: pictures were paired by their times, however far apart these are.
    """

    sources: list[PictureSource]
    rate: Fraction
    is_even: bool
    has_pairs: bool

    def of(self, index: int, number: int) -> tuple[int, int]:
        """Return the times in ns of the pictures `index` of the sources, for the stereo frame `number`.

        Raises RecordingError for pictures that were not taken at the same time.
        """
        even_ns = round(number * 1_000_000_000 / self.rate)
        left_ns, right_ns = (
            even_ns if each.times_ns is None or self.is_even else each.times_ns[index]
            for each in (self.sources[0], self.sources[-1])
        )
        if not self.has_pairs and 2 * self.rate * abs(left_ns - right_ns) > 1_000_000_000:
            raise RecordingError(
                f"{' and '.join(each.name for each in self.sources)}: pictures {index} must be taken at once, "
                f"not {abs(left_ns - right_ns) / 1e6:.0f} ms apart; `--fps` passes over their times"
            )
        return left_ns, right_ns


def frame_rate(fps: Fraction | float | None, sources: list[PictureSource]) -> Fraction:
    """Return the number of stereo frames per second: `fps`, or what the sources say.

    Raises RecordingError if the sources do not agree, or if `fps` is out of its range.
    """
    rates = {source.fps for source in sources if source.fps is not None and source.times_ns is None}
    rates = rates or {sources[0].fps or DEFAULT_FPS}  # their times decide whether pictures belong together
    if fps is None and len(rates) > 1:
        described = " and ".join(f"{float(rate):g}" for rate in sorted(rates))
        raise RecordingError(f"both cameras must have one frame rate, not {described}; `--fps` sets it")
    if fps is not None and not 1 <= fps * FPS_PARTS <= FPS_PARTS**2:
        raise RecordingError(f"frame rate must be 0.000001 to 1000000 per second, not {fps}")
    return Fraction(fps).limit_denominator(FPS_PARTS) if fps is not None else next(iter(rates), DEFAULT_FPS)

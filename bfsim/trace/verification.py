"""Records of `bfsim verify`: estimates beside the cycles of the real compiler's code, and values derived from these."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class VerifiedKernel:
    """One kernel: its calls in a frame, how many were played, and the cycles of a frame, estimated and measured.

    `different` is the number of played calls with other resulting bits than the kernel here; `unequal`, the number of calls for
    which the translated code took other cycles than the GNU simulator counts.
    """

    kernel: str
    file: str
    first_line: int
    calls: float
    played: int
    estimated_cclk: float
    measured_cclk: float
    different: int
    unequal: int

    @property
    def error(self) -> float:
        """Error of the estimate, relative to the measured cycles."""
        return self.estimated_cclk / self.measured_cclk - 1 if self.measured_cclk else 0.0


@dataclass(frozen=True, slots=True)
class Verification:
    """All kernels of a run, the slowest first. `compiler` is the compiler's version.

    `is_judged` says whether the GNU simulator played the calls, too. If not, the measured cycles are those of the translated code.
    """

    profile: str
    compiler: str
    frames: int
    is_judged: bool
    kernels: tuple[VerifiedKernel, ...]

    @property
    def measured_cclk(self) -> float:
        """Issue cycles of a frame, all cores, by the compiler's code."""
        return sum(each.measured_cclk for each in self.kernels)

    @property
    def signed_error(self) -> float:
        """Relative error of the frame's estimate. Errors of kernels may cancel out."""
        return sum(each.estimated_cclk for each in self.kernels) / self.measured_cclk - 1

    @property
    def error_by_share(self) -> float:
        """Relative error of all kernels, by their share of the frame. Errors do not cancel out."""
        return (
            sum(abs(each.estimated_cclk - each.measured_cclk) for each in self.kernels) / self.measured_cclk
        )

    @property
    def different(self) -> int:
        """Number of calls with other resulting bits than the kernels here."""
        return sum(each.different for each in self.kernels)

    @property
    def played(self) -> int:
        """Number of played calls."""
        return sum(each.played for each in self.kernels)

    @property
    def unequal(self) -> int:
        """Number of calls for which the translated code took other cycles than the GNU simulator counts."""
        return sum(each.unequal for each in self.kernels)

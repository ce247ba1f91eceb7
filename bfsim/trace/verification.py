"""Records of `bfsim verify`: estimates beside what the real compiler's code takes. Data, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class VerifiedKernel:
    """One kernel: its calls in a frame, how many were played, and the cycles of a frame, estimated and measured.

    `different`: how many of the calls that were played left other bits than the kernel here. `unequal`: of how many the
    translated code took other cycles than the GNU simulator counts.
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
        """By how much the estimate is off, as a part of what was measured."""
        return self.estimated_cclk / self.measured_cclk - 1 if self.measured_cclk else 0.0


@dataclass(frozen=True, slots=True)
class Verification:
    """All kernels of a run, the one that takes longest first. `compiler`: its version.

    `is_judged`: whether the GNU simulator played the calls too. If it did not, what is measured are the translated code's cycles.
    """

    profile: str
    compiler: str
    frames: int
    is_judged: bool
    kernels: tuple[VerifiedKernel, ...]

    @property
    def measured_cclk(self) -> float:
        """Issue cycles of a frame, both cores, by the compiler's code."""
        return sum(each.measured_cclk for each in self.kernels)

    @property
    def signed_error(self) -> float:
        """By how much the estimate of the frame is off, where one kernel's error makes up for another's."""
        return sum(each.estimated_cclk for each in self.kernels) / self.measured_cclk - 1

    @property
    def error_by_share(self) -> float:
        """By how much the kernels are off, where none makes up for another."""
        return (
            sum(abs(each.estimated_cclk - each.measured_cclk) for each in self.kernels) / self.measured_cclk
        )

    @property
    def different(self) -> int:
        """How many calls left other bits than the kernels here."""
        return sum(each.different for each in self.kernels)

    @property
    def played(self) -> int:
        """How many calls were played."""
        return sum(each.played for each in self.kernels)

    @property
    def unequal(self) -> int:
        """Of how many calls the translated code took other cycles than the GNU simulator counts."""
        return sum(each.unequal for each in self.kernels)

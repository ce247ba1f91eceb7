"""An induction variable: a pointer that a loop steps along, and the accesses that share it."""

from __future__ import annotations

from dataclasses import dataclass, field

from bfsim.kernel.estimate.induction_variables.kept_addresses import Access, distances
from bfsim.kernel.estimate.loops.scalar_evolution import Increment
from bfsim.kernel.ir.control_flow import Loop
from bfsim.kernel.ir.text import Instruction, SourceLine


@dataclass(slots=True)
class InductionVariable:
    """Accesses at constant distances from one pointer, which advances by the same amount with each iteration of `loop`."""

    name: str
    loop: Loop
    root: str
    increment: Increment
    line: SourceLine
    accesses: list[Access] = field(default_factory=list)
    start: tuple[tuple[str, int], ...] = ()
    """What is added to the array's address where the loop starts, with factors: values that the loop around does not step along."""
    stepping: Access | None = None
    """The access behind which GCC steps the pointer."""
    steps_free: bool = False
    keeps_address: bool = False
    """Whether an iteration keeps what the pointer was before its step, which is a sum of its own then."""
    offset_apart: bool = False
    neighbour: InductionVariable | None = None
    """The variable whose pointer serves this one as well, at a distance that does not change."""
    distance: tuple[tuple[str, int], ...] = ()
    """The terms of that distance, with factors."""
    follows: bool = False
    """Whether the neighbour's pointer is there in the next iteration: its step computes both."""
    like: str = ""
    """The variable of its loop that steps as far, if this is not the first of these."""

    def distance_of(self, access: Instruction) -> int:
        """Return how many bytes an access is from where the pointer is then."""
        assert self.stepping is not None
        step = self.increment.constant if self.steps_free else 0
        found = distances(self.accesses, self.stepping, step)
        return next(
            away for away, each in zip(found, self.accesses, strict=True) if each.instruction is access
        )

    @property
    def stride(self) -> str | None:
        """The register that holds the step, if it is no constant; those that step as far have one."""
        return f"{self.like or self.name}.stride" if self.increment.symbolic else None

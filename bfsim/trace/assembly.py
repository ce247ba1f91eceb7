"""A kernel instruction by instruction, as its object code is timed."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceText:
    """A line of a source file."""

    file: str
    line: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class AssemblyInstruction:
    """An instruction, or several that are issued together: `text` has one of them each.

    `source`: the line that it was made of, None where none is known. `cclk`: cycles of one execution without waits;
    `taken_cclk`: of a branch that is taken, None of others. `stall_cclk`: how long it waits, at the worst, for the
    register `waits_for`. `starts_block`: control may come to it from elsewhere. `executions`, `taken` and `total_cclk`
    are those of a run, None without one.
    """

    address: int
    nbytes: int
    text: tuple[str, ...]
    source: SourceText | None
    cclk: int
    taken_cclk: int | None
    stall_cclk: int
    waits_for: str
    depth: int
    starts_block: bool
    executions: int | None
    taken: int | None
    total_cclk: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class AssemblyLoop:
    """A loop, whose instructions lie between the addresses `first` and `last`.

    `least_cclk` and `most_cclk`: one turn on the cheapest and the dearest way, loops in it once and without what it
    calls. Of the dearest: `issue_cclk` to issue its instructions, `jump_cclk` more for its jumps and branches,
    `stall_cclk` for registers that it waits for. `chain_cclk`: the registers of `chain` depend on each other from turn
    to turn and take so long, whatever is issued beside them. `bound`: what bounds it. `turns` and `total_cclk` are
    those of a run, None without one.
    """

    first: int
    last: int
    depth: int
    is_hardware: bool
    instructions: int
    least_cclk: int
    most_cclk: int
    issue_cclk: int
    jump_cclk: int
    stall_cclk: int
    chain_cclk: float
    chain: tuple[str, ...]
    bound: str
    calls: tuple[str, ...]
    turns: int | None
    total_cclk: int | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Assembly:
    """The code of one kernel. `compiler` made it; `timing` counts its cycles, as `timing_about` says. `callees`: functions that it calls.

    `calls` are those of a run, None without one; its cycles are then those of all instructions.
    """

    kernel: str
    file: str
    first_line: int
    compiler: str
    timing: str
    timing_about: str
    code_bytes: int
    calls: int | None
    instructions: tuple[AssemblyInstruction, ...]
    loops: tuple[AssemblyLoop, ...]
    callees: tuple[str, ...]

    @property
    def total_cclk(self) -> int | None:
        """Cycles of the run, without those of what it calls; None without one."""
        if self.calls is None:
            return None
        return sum(each.total_cclk or 0 for each in self.instructions)

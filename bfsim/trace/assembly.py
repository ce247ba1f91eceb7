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
    """An instruction, or several that are issued together, each an element of `text`.

    `source` is the line that it was made from, None if unknown. `cclk` are the cycles of one execution without waits;
    `taken_cclk` those of a taken branch, None for other instructions. `stall_cclk` is the longest wait for the register
    `waits_for`. With `starts_block`, control may come from elsewhere. `executions`, `taken` and `total_cclk` come from a
    run, None without one.
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

    `least_cclk` and `most_cclk` are one iteration on the cheapest and the most expensive path, with inner loops once and
    without callees. Of the latter, `issue_cclk` issue its instructions, `jump_cclk` more are for its jumps and branches, and
    `stall_cclk` for registers that it waits for. The registers of `chain` depend on each other across iterations and take
    `chain_cclk`, whatever else is issued. `bound` says what limits the loop. `turns` and `total_cclk` come from a run,
    None without one.
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
    """The code of one kernel. `compiler` made it; `timing` counts its cycles, as `timing_about` says. It calls the functions `callees`.

    `calls` are from a run, None without one; its cycles are then those of all instructions.
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
        """Cycles of the run without its callees, None without a run."""
        if self.calls is None:
            return None
        return sum(each.total_cclk or 0 for each in self.instructions)

"""The remarks of a placement: who uses a part how often, and what it would cost elsewhere."""

from __future__ import annotations

import pytest

from bfsim.machine.code import SECTION
from bfsim.placing.latencies import Latencies
from bfsim.placing.measured import Accesses, Measured
from bfsim.placing.model import Model
from bfsim.placing.reasons import reason
from bfsim.placing.stretches import Level
from tests.placing.made_models import BOARD, model


def said(placed: Model, level: Level, measured: Measured) -> list[str]:
    """The words about the first part of a firmware, which lies in a memory of that level."""
    part = placed.parts[0]
    stretch = next(each for each in placed.possible(part, measured) if placed.stretches[each].level is level)
    return reason(placed, part, stretch, measured).split("; ")


@pytest.mark.parametrize(
    ("accesses", "streamed", "use"),
    [
        (Accesses(), [], ["not used in the frames measured"]),
        (Accesses(4, 0), [], ["4 reads, 0 writes"]),
        (Accesses(0, 1_000), [], ["0 reads, 1,000 writes"]),
        (Accesses(), ["row"], ["DMA"]),
        (Accesses(4, 2), ["row"], ["4 reads, 2 writes", "DMA"]),
    ],
)
def test_a_buffer_is_read_written_or_moved(accesses: Accesses, streamed: list[str], use: list[str]) -> None:
    """By the core that has it; what is too short to be told costs nothing."""
    measured = Measured(accesses={("A", "row"): accesses}, streamed=frozenset(streamed))
    found = said(model("thesis", ("row", "L1_data_a", 1_064, "p0")), Level.L1, measured)
    assert found[: 1 + len(use)] == ["1,064 B", *use]


def test_waits_are_told_here_and_in_the_next_dearer_memory() -> None:
    """In ms of the core's clock; what both cores use cannot be in L1."""
    measured = Measured(accesses={("A", "row"): Accesses(60_000, 0)})
    l2_ms, sdram_ms = (
        Latencies(BOARD).data_cclk(level, 60_000, 0) / 600e3 for level in (Level.L2, Level.SDRAM)
    )
    own = model("thesis", ("row", "L1_data_a", 64, "p0"))
    assert said(own, Level.L1, measured)[2:] == [f"in L2 {l2_ms:.3f} ms"]
    assert said(own, Level.L2, measured)[2:] == [f"{l2_ms:.3f} ms, in SDRAM {sdram_ms:.3f} ms"]
    assert said(own, Level.SDRAM, measured)[2:] == [f"{sdram_ms:.3f} ms"]
    shared = model("thesis", ("row", "l2_shared", 64, None))
    assert said(shared, Level.SDRAM, measured)[2:] == [f"{sdram_ms:.3f} ms", "both cores: no L1"]


@pytest.mark.parametrize(
    ("cycles", "use"), [(0, "not run in the frames measured"), (1_234, "1,234 issue cycles")]
)
def test_a_kernel_runs_or_does_not(cycles: int, use: str) -> None:
    """As often as its core has run it."""
    measured = Measured(issue_cclk={("A", "kernel0"): cycles})
    too_many = [(f"kernel{number}", SECTION, 3000, "p0") for number in range(11)]
    assert said(model("thesis", *too_many), Level.L1_CODE, measured)[:2] == ["3,000 B", use]

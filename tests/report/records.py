"""Small runs made by hand and by hypothesis, for the tests of the reports."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

from hypothesis import strategies as st

from bfsim.trace import (
    REST,
    AccessRecord,
    BudgetRow,
    BufferRecord,
    CoreFrame,
    FrameRecord,
    Identity,
    KernelRecord,
    LineCost,
    Reference,
    RunRecord,
    StageCost,
    StallReason,
    TrafficRecord,
)

IDENTITY = Identity(
    recording="soccer",
    recording_digest="1" * 64,
    firmware="tinyphoon",
    firmware_digest="2" * 64,
    firmware_files=("tinyphoon/__init__.py", "tinyphoon/core_a.py"),
    board="cm-bf561",
    board_digest="3" * 64,
    ldf="thesis",
    ldf_digest="4" * 64,
    compiler="gcc-O2",
    compiler_digest="4" * 64,
    board_files=("boards.py",),
    compiler_files=("compilers.py",),
    feed="demand",
    script_digest="5e",
    fidelity="fast",
    bfsim_version="0.1.0",
    llvm_version="20.1.8",
    cclk_hz=1_000_000.0,
    sclk_hz=200_000.0,
    width_px=320,
    height_px=240,
)
"""A clock of 1 MHz: 1000 cycles are 1 ms."""

ROWS = (
    BudgetRow(stage="Edge detection", reference_ms=87.0),
    BudgetRow(stage="Open & closing", reference_ms=26.0),
)


REFERENCE = Reference(name="board", about="means of 100 frames on a board.")


def cost(
    stage: str, issue_cclk: int, stall_cclk: Mapping[StallReason, int] | None = None, idle_cclk: int = 0
) -> StageCost:
    """One stage; without stalls and idling unless they are given."""
    return StageCost(stage=stage, issue_cclk=issue_cclk, stall_cclk=stall_cclk or {}, idle_cclk=idle_cclk)


def core_frame(core: str, begin_cclk: int, *stages: StageCost) -> CoreFrame:
    """One frame of one core that ends where its stages have filled it."""
    end_cclk = begin_cclk + sum(stage.elapsed_cclk for stage in stages)
    return CoreFrame(core=core, begin_cclk=begin_cclk, end_cclk=end_cclk, stages=stages)


def frame(index: int, *cores: CoreFrame, latency_cclk: int = 10) -> FrameRecord:
    """One frame whose result is out when its last core ends."""
    end_cclk = max(core.end_cclk for core in cores)
    return FrameRecord(
        index=index, last_line_cclk=end_cclk - latency_cclk, result_cclk=end_cclk, cores=cores, results={}
    )


def run_of(frames: Sequence[FrameRecord], missed: tuple[int, ...] = ()) -> RunRecord:
    """A run of these frames, without kernels and traffic."""
    return RunRecord(
        identity=IDENTITY,
        firmware_place="built in",
        ldf_place="shipped",
        rows=ROWS,
        reference=REFERENCE,
        frames=tuple(frames),
        missed=missed,
        interrupted=False,
        kernels=(),
        accesses=(),
        paths=(),
        buffers=(),
        code=(),
        traffic=(),
        messages=(),
        device_notes={},
        geometry="",
        assumptions=(),
        losses={"edges_lost": "edges without room"},
        interrupts={},
        events=0,
    )


def edge_run(*edge_cclk: int, rest_cclk: int = 50) -> RunRecord:
    """A run of one frame per number: core A spends it in edge detection, core B half of it; both have a rest."""
    frames, begin = [], {"A": 0, "B": 0}
    for index, cclk in enumerate(edge_cclk):
        cores = [
            core_frame(
                core,
                begin[core],
                cost("Edge detection", own),
                cost(REST, 0, idle_cclk=cclk - own + rest_cclk),
            )
            for core, own in (("A", cclk), ("B", cclk // 2))
        ]
        begin = {core.core: core.end_cclk for core in cores}
        frames.append(frame(index, *cores))
    return run_of(frames)


def kernel(stage: str, name: str, *lines: LineCost, core: str = "A", **changes: object) -> KernelRecord:
    """A kernel of two source lines, 10 and 11, of which `lines` were executed."""
    record = KernelRecord(
        core=core,
        stage=stage,
        kernel=name,
        symbol=name,
        file="/robot/edges.py",
        first_line=10,
        text=("for x in range(n):", "    total += row[x]"),
        calls=1,
        issue_cclk=sum(line.issue_cclk for line in lines),
        stall_cclk=sum((Counter(line.stall_cclk) for line in lines), Counter()),
        lines=lines,
    )
    return replace(record, **changes)  # type: ignore[arg-type]


def access(
    stage: str, symbol: str, name: str, reads: int, writes: int, *, core: str = "A", line: int = 11
) -> AccessRecord:
    """What a line of a kernel accessed in a buffer, without waiting."""
    return AccessRecord(
        core=core, stage=stage, symbol=symbol, line=line, buffer=name, reads=reads, writes=writes, fills=0, stall_cclk={}
    )  # fmt: skip


def buffer(name: str, memory: str) -> BufferRecord:
    """A buffer of 1 KB in a memory."""
    return BufferRecord(buffer=name, core="A", memory=memory, address=0, nbytes=1024)


def traffic(memory: str, master: str, busy_cclk: int) -> TrafficRecord:
    """What one master moved; the bytes and pages are the same each time."""
    return TrafficRecord(
        memory=memory,
        buffer="image",
        master=master,
        read_bytes=2000,
        written_bytes=1000,
        page_hits=90,
        page_misses=4,
        page_conflicts=6,
        busy_cclk=busy_cclk,
    )


_cycles = st.integers(min_value=0, max_value=10**9)


@st.composite
def runs(draw: st.DrawFn) -> RunRecord:
    """Any run that keeps the promises of `bfsim.trace`: stages fill the frame, no empty frame, no stall of 0."""
    stages = st.builds(
        cost,
        st.sampled_from([row.stage for row in ROWS]),
        _cycles,
        st.dictionaries(st.sampled_from(StallReason), st.integers(1, 10**9)),
        _cycles,
    )
    begin, frames = {"A": 0, "B": 0}, []
    for index in range(draw(st.integers(1, 6))):
        costs = {core: draw(st.lists(stages, max_size=3)) for core in begin}
        cores = [
            core_frame(core, begin[core], *costs[core], cost(REST, draw(st.integers(1, 10**9))))
            for core in begin
        ]
        begin = {core.core: core.end_cclk for core in cores}
        frames.append(frame(index, *cores))
    return run_of(frames)

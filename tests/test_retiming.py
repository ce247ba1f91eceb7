"""A recorded run that is played on other hardware is the run of the firmware there, to the cycle; else it is refused in words."""

from __future__ import annotations

import json
import random
import sys
import zipfile
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zstandard

from bfsim.errors import ConfigError, WorkError
from bfsim.kernel import access_trace as log
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.work import BYTE, CALL, KIND, SITE, FrameWork
from bfsim.machine.retiming.work_check import check
from bfsim.result import Run
from bfsim.run import Feed, Fidelity, simulate
from bfsim.work_file import FORMAT, _read, _written
from tests.eyes import FIRMWARE, record
from tests.tiers import exhaustive

FRAMES = 2
HOSTS_OWN = {"events"}
"""Fields of a run that say what it took the host; the ones below also say what was asked for."""


def random_hardware(seed: int) -> dict[str, object]:
    """Return numbers of a board to change: clocks, latencies, DMA and bus settings."""
    among = random.Random(seed)
    return {
        "clocks.cclk_hz": among.choice([300e6, 450e6, 500e6, 600e6]),
        "clocks.sclk_hz": among.choice([75e6, 100e6, 120e6]),
        "sdram.nRP": among.randint(2, 5),
        "sdram.nRCD": among.randint(2, 5),
        "chip.l2.read_cclk": among.randint(5, 30),
        "chip.events.mmr_write_cclk": among.randint(1, 9),
        "dma_over_core": among.random() < 0.5,
        "deb_period_transfers": among.choice([0, 3, 15]),
        "mdma_period_transfers": among.choice([0, 5]),
    }


def differing(one: Run, other: Run) -> set[str]:
    """Return the fields in which two runs differ."""
    compared = [each.name for each in fields(one) if each.compare]
    return {each for each in compared if getattr(one, each) != getattr(other, each)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder for recorded runs."""
    return tmp_path_factory.mktemp("work")


@pytest.fixture(scope="module")
def plain() -> Run:
    """Return a run of the built-in firmware."""
    return simulate(frames=FRAMES)


@pytest.fixture(scope="module")
def work(folder: Path, plain: Run) -> Path:
    """Return the recorded work of that run; recording it changes nothing, and takes no event more: it runs ahead, too."""
    path = folder / "thesis.work"
    assert not differing(plain, simulate(frames=FRAMES, record_work=path))
    return path


def test_a_recorded_run_is_played_as_it_was(work: Path, plain: Run) -> None:
    """Every record is the same: frames, owners, stalls by site, traffic, results, messages, identity."""
    assert differing(plain, simulate(frames=FRAMES, work=work)) <= HOSTS_OWN


@pytest.mark.parametrize("seed", [0, *exhaustive(1, 2, 3)])
def test_it_is_the_run_of_other_hardware(work: Path, plain: Run, seed: int) -> None:
    """Whatever the clocks, the latencies, and the settings of DMA and bus."""
    settings = random_hardware(seed)
    there = simulate(frames=FRAMES, settings=settings)
    assert there.frames != plain.frames
    assert differing(there, simulate(frames=FRAMES, work=work, settings=settings)) <= HOSTS_OWN


@pytest.mark.exhaustive
@pytest.mark.parametrize("profile", ["gcc-adi", "vdsp-O2"])
def test_it_is_the_run_of_another_placement(folder: Path, profile: str) -> None:
    """What was recorded with buffers outside of L1 is played where they are elsewhere, and code that is fetched, too.

    The reverse is refused, with a buffer's name.
    """
    path = folder / "sdram.work"
    outside = simulate(frames=1, ldf=Path("sdram"), profile=profile, record_work=path)
    for ldf in ("thesis", "l2"):
        there = simulate(frames=1, ldf=Path(ldf), profile=profile)
        assert there.frames != outside.frames
        assert differing(there, simulate(frames=1, ldf=Path(ldf), profile=profile, work=path)) <= HOSTS_OWN
    simulate(frames=1, profile=profile, record_work=path)
    with pytest.raises(WorkError, match=r"must be in L1, for it was when the run was recorded"):
        simulate(frames=1, ldf=Path("sdram"), profile=profile, work=path)


@pytest.mark.exhaustive
def test_caches_are_played_with_their_ldf(folder: Path) -> None:
    """Which lines a cache fetches depends on addresses: another board is the same run, another LDF is refused."""
    path, settings = folder / "cache.work", {"sdram.nRP": 5}
    simulate(frames=1, ldf=Path("cache"), record_work=path)
    there = simulate(frames=1, ldf=Path("cache"), settings=settings)
    assert differing(there, simulate(frames=1, ldf=Path("cache"), work=path, settings=settings)) <= HOSTS_OWN
    with pytest.raises(WorkError, match=r"must be played with the LDF that it was recorded with"):
        simulate(frames=1, work=path)


def test_missed_frames_are_said(folder: Path) -> None:
    """Where slower cores miss a frame, they do something else than was recorded."""
    path = folder / "recorded.work"
    simulate(frames=5, feed=Feed.RECORDED, record_work=path)
    with pytest.raises(WorkError, match=r"core [AB] gets .* where it got frame \d when the run was recorded"):
        simulate(frames=5, feed=Feed.RECORDED, work=path, settings={"clocks.cclk_hz": 200e6})


WITH_HANDLERS = """
from dataclasses import replace

from tinyphoon import tinyphoon


def with_handler(main):
    def handled(core):
        core.on_interrupt("SPI_DMA", lambda _: None)
        yield from main(core)

    return handled


interrupted = replace(tinyphoon, mains={core: with_handler(main) for core, main in tinyphoon.mains.items()})
"""


def test_handlers_of_interrupts_are_said(folder: Path) -> None:
    """They come when the hardware has them, between other calls on other hardware."""
    path, source = folder / "handlers.work", folder / "with_handlers.py"
    source.write_text(WITH_HANDLERS)
    firmware = f"{source}:interrupted"
    simulate(firmware=firmware, frames=1, record_work=path)
    with pytest.raises(WorkError, match="core A has a handler of the interrupt SPI_DMA"):
        simulate(firmware=firmware, frames=1, work=path)


def small(folder: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """Go where a firmware of one kernel is, `fw_mixed`; return a recording for it, and where to record its work."""
    (folder / "fw_mixed.py").write_text(FIRMWARE)
    monkeypatch.chdir(folder)
    return record(folder / "drive.mcap", FRAMES), folder / "thesis.work"


def test_an_interrupted_run_leaves_the_file_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A part of a run cannot be played: it is not put in the place of a whole one, nor where there was none."""
    recording, path = small(tmp_path, monkeypatch)
    stops = FIRMWARE.replace(
        "core.next_frame())) is not None:\n",
        "core.next_frame())) is not None:\n        if frame.index:\n            raise KeyboardInterrupt\n",
    )
    (tmp_path / "fw_stops.py").write_text(stops)
    assert simulate(recording, firmware="fw_stops:eyes", record_work=path).interrupted
    assert not path.exists()
    simulate(recording, firmware="fw_mixed:eyes", record_work=path)
    whole = path.read_bytes()
    assert simulate(recording, firmware="fw_stops:eyes", record_work=path).interrupted
    assert path.read_bytes() == whole


@pytest.mark.parametrize(
    ("what", "said"),
    [
        ({"frames": 1}, r"must be played for as many frames as it has, 2, not for 1"),
        ({"profile": "gcc-O2"}, r"must be recorded with the same compiler, 'gcc-O2', not with 'gcc-adi'"),
    ],
)
def test_another_run_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, what: dict[str, Any], said: str
) -> None:
    """Frames and compiler must be those of the recorded run."""
    recording, path = small(tmp_path, monkeypatch)
    simulate(recording, firmware="fw_mixed:eyes", record_work=path)
    with pytest.raises(WorkError, match=said):
        simulate(recording, firmware="fw_mixed:eyes", work=path, **what)


def test_what_needs_more_than_cycles_is_refused(work: Path, folder: Path) -> None:
    """There are no pictures, and no events of single words."""
    with pytest.raises(ConfigError, match="--work must go without pictures"):
        simulate(frames=FRAMES, work=work, on_seen=lambda _: None)
    with pytest.raises(ConfigError, match="--work must go with --fidelity fast"):
        simulate(frames=FRAMES, work=work, fidelity=Fidelity.DETAILED)
    with pytest.raises(ConfigError, match="--record-work must go with --fidelity fast"):
        simulate(frames=FRAMES, record_work=folder / "none.work", fidelity=Fidelity.DETAILED)
    with pytest.raises(ConfigError, match="--record-work must go without --trace"):
        simulate(frames=FRAMES, record_work=folder / "none.work", on_spans=lambda _: None)
    assert not (folder / "none.work").exists()


def test_a_device_is_no_file() -> None:
    """It may never end: a process that read one took all memory there is."""
    with pytest.raises(WorkError, match="/dev/null must be an ordinary file, not a folder or a device"):
        simulate(frames=FRAMES, work=Path("/dev/null"))


@pytest.mark.parametrize("part", [0.0, 0.4, 0.999])
def test_a_part_of_a_file_is_refused(work: Path, folder: Path, part: float) -> None:
    """It is told at opening, before anything runs."""
    octets = work.read_bytes()
    cut = folder / "cut.work"
    cut.write_bytes(octets[: int(len(octets) * part)])
    with pytest.raises(WorkError, match=r"cut\.work must be a whole file"):
        simulate(frames=FRAMES, work=cut)


def test_another_version_is_refused(work: Path, folder: Path) -> None:
    """Another bfsim may cost kernels otherwise."""
    other = folder / "other.work"
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(other, "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name).replace(b'"format": %d' % FORMAT, b'"format": 0'))
    with pytest.raises(WorkError, match="must be recorded by this bfsim"):
        simulate(frames=FRAMES, work=other)


@pytest.mark.parametrize(
    "frame", [b"", b"no frame", zstandard.compress(b"{}\n"), b"\x28\xb5\x2f\xfd\xe0" + b"\xff" * 8]
)  # the last one says that it decompresses to more than there is memory in the world
def test_a_broken_frame_is_refused(work: Path, folder: Path, frame: bytes) -> None:
    """Where it is read, in the words for the file; nothing large is made for it."""
    broken = folder / "broken.work"
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(broken, "w") as new:
        for name in old.namelist():
            new.writestr(name, frame if name == "B/000001" else old.read(name))
    with pytest.raises(WorkError, match=r"broken\.work must be a whole file"):
        simulate(frames=FRAMES, work=broken)


def changed(work: Path, path: Path, change: Callable[[FrameWork], None]) -> Path:
    """Write a recorded run with other numbers in the second frame of core A."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == "A/000001":
                done = _read("A", zstandard.decompress(content))
                change(done)
                content = zstandard.compress(_written(done))
            new.writestr(name, content)
    return path


def test_a_fetch_of_code_that_is_none_is_refused(work: Path, folder: Path) -> None:
    """Its site must be that of a routine outside of L1."""

    def change(done: FrameWork) -> None:
        assert (done.accesses[:, KIND] == log.FETCHES).any()
        done.accesses[done.accesses[:, KIND] == log.FETCHES, SITE] = w.MAX_SITES - 1

    with pytest.raises(WorkError, match="code is fetched from where none lies"):
        simulate(frames=FRAMES, work=changed(work, folder / "fetch.work", change))


@pytest.mark.parametrize(
    ("kind", "column", "number"),
    [(w.ACCESS, 4, 1 << 30), (w.COPY, 1, 1 << 30), (w.SET_UP, 3, w.MAX_ACCOUNTS - 1), (w.AWAIT, 3, w.MAX_ACCOUNTS - 1)],
)  # fmt: skip
def test_operations_with_what_is_not_there_are_refused(
    work: Path, folder: Path, kind: int, column: int, number: int
) -> None:
    """Calls, copies and accounts that nothing has prepared, in words and not in memory that is somebody else's."""

    def change(done: FrameWork) -> None:
        done.operations[done.operations[:, 0] == kind, column] = number

    with pytest.raises(WorkError, match="that is not there"):
        simulate(frames=FRAMES, work=changed(work, folder / "odd.work", change))


def test_memory_and_counters_that_are_not_there_are_refused(work: Path, folder: Path) -> None:
    """As above."""

    def far(done: FrameWork) -> None:
        done.accesses[:, BYTE] = log.OFFSET_MASK

    def many(done: FrameWork) -> None:
        done.events[:, 1] = 1 << 30

    for change in (far, many):
        with pytest.raises(WorkError, match="that is not there"):
            simulate(frames=FRAMES, work=changed(work, folder / "odd.work", change))


def rewritten(
    work: Path, path: Path, change: Callable[[dict[str, Any]], None], part: str = "run.json"
) -> Path:
    """Write a recorded run with other words on what was run."""
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if name == part:
                run = json.loads(content)
                change(run)
                content = json.dumps(run).encode()
            new.writestr(name, content)
    return path


def test_other_code_outside_of_l1_is_refused(work: Path, folder: Path) -> None:
    """Its fetches are recorded, and those of others are not."""
    other = rewritten(work, folder / "less.work", lambda run: run["routines_outside"].pop())
    with pytest.raises(WorkError, match=r"and \w+ of core [AB] is there and is not in both"):
        simulate(frames=FRAMES, work=other)


@pytest.mark.parametrize("routine", [["A"], [0, "routine"], ["A", 7], ["A", "routine", 0], 7])
def test_a_routine_that_is_none_is_refused(work: Path, folder: Path, routine: Any) -> None:
    """At opening."""
    other = rewritten(work, folder / "odd.work", lambda run: run["routines_outside"].append(routine))
    with pytest.raises(WorkError, match=r"odd\.work must be a whole file"):
        simulate(frames=FRAMES, work=other)


@pytest.mark.parametrize(
    ("part", "key", "value"),
    [
        ("run.json", "identity", 3),
        ("run.json", "identity", {"recording": 3}),
        ("run.json", "buffers", [1.5]),
        ("run.json", "buffers", True),
        ("end.json", "modules", 7),
        ("end.json", "modules", [None]),
        ("end.json", "frame_digests", "none"),
        ("end.json", "obstacles", {}),
    ],
)
def test_what_was_run_must_be_of_its_types(
    work: Path, folder: Path, part: str, key: str, value: object
) -> None:
    """Numbers where names must be, and the other way round, ended in tracebacks."""
    other = rewritten(work, folder / "odd.work", lambda run: run.update({key: value}), part)
    with pytest.raises(WorkError, match=r"odd\.work must be a whole file"):
        simulate(frames=FRAMES, work=other)


def test_what_was_run_must_be_a_table(work: Path, folder: Path) -> None:
    """And a whole one, however deep it is nested."""
    for content in (b"3", b"[]", b"[" * 100_000):
        with zipfile.ZipFile(work) as old, zipfile.ZipFile(folder / "odd.work", "w") as new:
            for name in old.namelist():
                new.writestr(name, content if name == "run.json" else old.read(name))
        with pytest.raises(WorkError, match=r"odd\.work must be a whole file"):
            simulate(frames=FRAMES, work=folder / "odd.work")


def test_firmware_that_imports_while_it_runs_is_played(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A module of its own folder, and no other that the file names: it ended in a ModuleNotFoundError."""
    kernel, main = FIRMWARE[: FIRMWARE.index("def main")], FIRMWARE[FIRMWARE.index("def main") :]
    (tmp_path / "fw_kernels.py").write_text(kernel)
    head, _, rest = main.partition("\n")
    api = "from bfsim.api import *\n"
    (tmp_path / "fw_late.py").write_text(f"{api}{head}\n    from fw_kernels import threshold\n{rest}")
    record(tmp_path / "drive.mcap", 1)
    what = {"recording": tmp_path / "drive.mcap", "firmware": f"{tmp_path}/fw_late.py"}
    plain = simulate(**what, record_work=tmp_path / "run.work")
    other = rewritten(
        tmp_path / "run.work",
        tmp_path / "odd.work",
        lambda end: end["modules"].append("antigravity"),
        "end.json",
    )
    monkeypatch.setitem(sys.modules, "antigravity", None)  # would be an ImportError
    for path in (tmp_path / "run.work", other):
        monkeypatch.setattr("bfsim.loading._imported", {})  # as in another process
        assert simulate(**what, work=path).frames == plain.frames


def test_a_frame_takes_less_than_200_kb(work: Path) -> None:
    """With the LDF of the built-in firmware."""
    assert work.stat().st_size / FRAMES < 200_000


NOTHING = FrameWork(
    core="A",
    operations=np.zeros((0, 5), np.int64),
    accesses=np.zeros((0, 5), np.uint32),
    events=np.zeros((0, 3), np.int64),
    copies=np.zeros((0, 6), np.int64),
    calls=(),
    accounts=(),
)


@pytest.mark.parametrize(
    "operation",
    [(CALL + 1, 0, 0, 0, 0), (w.RUN, -1, 0, 0, 0), (w.ACCESS, 1, 0, 1, 0), (w.SET_UP, 1, 0, w.MAX_ACCOUNTS, 0), (CALL, 0, 0, 0, 0)],
)  # fmt: skip
def test_numbers_that_the_bus_cannot_play_are_refused(operation: tuple[int, ...]) -> None:
    """Kinds that there are not, negative cycles, accesses and calls that are missing, accounts that have no room."""
    check(NOTHING, 3)
    with pytest.raises(ValueError, match=r"out of its range|as many calls"):
        check(replace(NOTHING, operations=np.array([operation], np.int64)), 3)


def test_what_leaves_l1_is_refused_even_beside_what_was_outside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A kernel with one array in L2 has accesses on record, but not those to its rows in L1, which `l2` puts outside."""
    recording, path = small(tmp_path, monkeypatch)
    simulate(recording, firmware="fw_mixed:eyes", record_work=path)
    with pytest.raises(WorkError, match=r"ring \(A\), out \(A\) must be in L1"):
        simulate(recording, firmware="fw_mixed:eyes", ldf=Path("l2"), work=path)

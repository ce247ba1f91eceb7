"""A file that is no whole recorded run, or has in it what there is not, is refused in words."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.errors import WorkError
from bfsim.kernel.calls import access_log as log
from bfsim.machine.bus import state as w
from bfsim.machine.retiming.work import BYTE, CALL, KIND, OWNER, SITE, FrameWork
from bfsim.run import simulate
from bfsim.running.frame_file import TABLES, read, written
from bfsim.running.work_file import FORMAT, compressed
from tests.work_files import changed, rewritten, unpacked

FRAMES = 2


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder for recorded runs."""
    return tmp_path_factory.mktemp("work")


@pytest.fixture(scope="module")
def work(folder: Path) -> Path:
    """Return the recorded work of a run of the built-in firmware."""
    path = folder / "thesis.work"
    simulate(frames=FRAMES, record_work=path)
    return path


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
    with pytest.raises(WorkError, match=r"cut\.work must be a complete file"):
        simulate(frames=FRAMES, work=cut)


@pytest.mark.parametrize(("byte", "number"), [(6, 118), (8, 1), (10, 99), (10, 8), (42, 255)])
def test_a_broken_index_is_refused(work: Path, folder: Path, byte: int, number: int) -> None:
    """A later version of ZIP, an encrypted or packed part, a place that cannot be: each is an error of another type."""
    octets = bytearray(work.read_bytes())
    for at in (octets.index(b"PK\x01\x02"), octets.rindex(b"PK\x01\x02")):
        octets[at + byte] = number
    broken = folder / "index.work"
    broken.write_bytes(octets)
    with pytest.raises(WorkError, match=r"index\.work must be a complete file"):
        simulate(frames=FRAMES, work=broken)


def test_another_version_is_refused(work: Path, folder: Path) -> None:
    """Another bfsim may cost kernels otherwise."""
    other = folder / "other.work"
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(other, "w") as new:
        for name in old.namelist():
            new.writestr(name, old.read(name).replace(b'"format": %d' % FORMAT, b'"format": 0'))
    with pytest.raises(WorkError, match="must be recorded by this version of bfsim"):
        simulate(frames=FRAMES, work=other)


@pytest.mark.parametrize(
    "frame", [b"", b"no frame", compressed(b"{}\n"), b"\xff" * 8]
)  # the last one says that it decompresses to more than there is memory in the world
def test_a_broken_frame_is_refused(work: Path, folder: Path, frame: bytes) -> None:
    """Where it is read, in the words for the file; nothing large is made for it."""
    broken = folder / "broken.work"
    with zipfile.ZipFile(work) as old, zipfile.ZipFile(broken, "w") as new:
        for name in old.namelist():
            new.writestr(name, frame if name == "B/000001" else old.read(name))
    with pytest.raises(WorkError, match=r"broken\.work must be a complete file"):
        simulate(frames=FRAMES, work=broken)


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

    def later(done: FrameWork) -> None:  # at the end of a stage, within a stretch
        done.events[len(done.events) // 2 :, 1] = 1 << 30

    for change in (far, many, later):
        with pytest.raises(WorkError, match="that is not there"):
            simulate(frames=FRAMES, work=changed(work, folder / "odd.work", change))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (("next_frame", (0, 0.5)), "must be as it was recorded"),
        (("prepare", ("\x1b[31m", [])), r"kernel '\\x1b\[31m' must stand in a module"),
    ],
)
def test_a_call_of_what_is_none_is_refused(
    work: Path, folder: Path, call: tuple[str, Any], message: str
) -> None:
    """It is not the firmware that has failed then, and the terminal is told nothing."""

    def change(done: FrameWork) -> None:
        object.__setattr__(done, "calls", (call, *done.calls[1:]))

    with pytest.raises(WorkError, match=message):
        simulate(frames=FRAMES, work=changed(work, folder / "call.work", change))


def test_other_code_outside_of_l1_is_refused(work: Path, folder: Path) -> None:
    """Its fetches are recorded, and those of others are not."""
    other = rewritten(work, folder / "less.work", lambda run: run["routines_outside"].pop())
    with pytest.raises(WorkError, match=r"but \w+ of core [AB] lies there only now"):
        simulate(frames=FRAMES, work=other)


@pytest.mark.parametrize("routine", [["A"], [0, "routine"], ["A", 7], ["A", "routine", 0], 7])
def test_a_routine_that_is_none_is_refused(work: Path, folder: Path, routine: Any) -> None:
    """At opening."""
    other = rewritten(work, folder / "odd.work", lambda run: run["routines_outside"].append(routine))
    with pytest.raises(WorkError, match=r"odd\.work must be a complete file"):
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
        ("end.json", "frames", "none"),
        ("end.json", "frames", {"digests": [], "times_ns": [[1, 2]], "stored_end": 0, "stored_digest": ""}),
        ("end.json", "frames", {"digests": ["a"], "times_ns": [[1]], "stored_end": 0, "stored_digest": ""}),
        ("end.json", "obstacles", {}),
        ("end.json", "doubts", [[16, 16]]),
        ("end.json", "doubts", [[16, "all"], [0, 0], [0, 0]]),
    ],
)
def test_what_was_run_must_be_of_its_types(
    work: Path, folder: Path, part: str, key: str, value: object
) -> None:
    """Numbers where names must be, and the other way round, ended in tracebacks."""
    other = rewritten(work, folder / "odd.work", lambda run: run.update({key: value}), part)
    with pytest.raises(WorkError, match=r"odd\.work must be a complete file"):
        simulate(frames=FRAMES, work=other)


def test_what_was_run_must_be_a_table(work: Path, folder: Path) -> None:
    """And a whole one, however deep it is nested."""
    for content in (b"3", b"[]", b"[" * 100_000):
        with zipfile.ZipFile(work) as old, zipfile.ZipFile(folder / "odd.work", "w") as new:
            for name in old.namelist():
                new.writestr(name, content if name == "run.json" else old.read(name))
        with pytest.raises(WorkError, match=r"odd\.work must be a complete file"):
            simulate(frames=FRAMES, work=folder / "odd.work")


@pytest.mark.parametrize(
    ("kind", "column", "number"),
    [(w.RUN, 0, CALL + 1), (w.RUN, 0, -1), (w.RUN, 1, -1), (w.RUN, 2, 1 << 41), (w.SET_UP, 3, w.MAX_ACCOUNTS), (w.AWAIT, 1, 0)],
)  # fmt: skip
def test_numbers_that_the_bus_cannot_play_are_refused(
    work: Path, folder: Path, kind: int, column: int, number: int
) -> None:
    """Kinds that there are not, negative cycles and such of centuries, accounts that have no room."""

    def change(done: FrameWork) -> None:
        done.operations[done.operations[:, 0] == kind, column] = number

    with pytest.raises(WorkError, match="a number that is out of its range"):
        simulate(frames=FRAMES, work=changed(work, folder / "odd.work", change))


@pytest.mark.parametrize(
    ("column", "number"), [(KIND, log.FETCHES + 1), (OWNER, 1 << 20), (BYTE, log.OFFSET_MASK + 1), (SITE, w.MAX_SITES)]
)  # fmt: skip
def test_accesses_that_the_bus_cannot_play_are_refused(
    work: Path, folder: Path, column: int, number: int
) -> None:
    """They would be of no kind, or counted in memory that is somebody else's."""

    def change(done: FrameWork) -> None:
        done.accesses[len(done.accesses) // 2, column] = number

    with pytest.raises(WorkError, match="a number that is out of its range"):
        simulate(frames=FRAMES, work=changed(work, folder / "odd.work", change))


def test_calls_and_accesses_that_are_missing_are_refused(work: Path, folder: Path) -> None:
    """There must be as many calls as operations that stand for one, and the accesses that operations have."""

    def more_calls(done: FrameWork) -> None:
        done.operations[done.operations[:, 0] == w.RUN, 0] = CALL

    def more_accesses(done: FrameWork) -> None:
        done.operations[np.flatnonzero(done.operations[:, 0] == w.ACCESS)[-1], 3] += 1

    for change, said in (
        (more_calls, "more calls of its firmware"),
        (more_accesses, "that is not there"),
    ):
        with pytest.raises(WorkError, match=said):
            simulate(frames=FRAMES, work=changed(work, folder / "odd.work", change))


@pytest.mark.parametrize(
    "odd", [{"rows": {"operations": -1}}, {"rows": {"accesses": 1 << 40}}, {"widths": [-2] * 21}, {"widths": [4] * 21}, {"widths": []}]
)  # fmt: skip
def test_columns_that_are_not_in_the_file_are_refused(odd: dict[str, Any]) -> None:
    """Compiled code reads them, which would read memory behind the file."""
    head = {
        "calls": [],
        "accounts": [],
        "stages": [],
        "results": {},
        "widths": [0] * 21,
        "rows": dict.fromkeys(TABLES, 0),
    }
    assert read("A", json.dumps(head).encode() + b"\n").calls == ()
    head = {**head, **odd, "rows": dict.fromkeys(TABLES, 0) | odd.get("rows", {})}
    with pytest.raises(ValueError, match=r"columns must be|not in range|shorter than"):
        read("A", json.dumps(head).encode() + b"\n")


def test_a_frame_is_read_as_it_was_written() -> None:
    """Whatever its numbers: narrow and wide ones, calls without accesses, and stamps that begin anew with each call."""
    among = np.random.default_rng(0)
    for top in (1 << 6, 1 << 12, 1 << 30):
        counts = [0, 3, 0, 5, 1]
        accesses = among.integers(0, top, (sum(counts), 5)).astype(np.uint32)
        operations = np.array([(w.ACCESS, 1, top, count, 0) for count in counts], np.int64)
        events, copies = among.integers(0, top, (4, 3)), among.integers(0, top, (2, 6))
        work = FrameWork(
            core="A", operations=operations, accesses=accesses, events=events, copies=copies, calls=(("post", ("x",)),), accounts=("y",),
            stages=("z",), results={"seen": 1},
        )  # fmt: skip
        again = unpacked(read("A", written(work)))
        for table in ("operations", "accesses", "events", "copies"):
            assert (getattr(again, table) == getattr(work, table)).all(), table
        assert (again.calls, again.accounts) == (work.calls, work.accounts)
        assert (again.stages, again.results) == (work.stages, work.results)

"""The cache of compiled kernels: found again, never stale, never in the way."""

from __future__ import annotations

import errno
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from bfsim.errors import BfsimWarning
from bfsim.files import store
from bfsim.kernel import VDSP_O2, Kernel
from bfsim.kernel.estimate import costing
from bfsim.kernel.host_code import instrument
from bfsim.kernel.profile import DEFAULT
from bfsim.machine_code.caller import caller
from tests.kernel.modules import HEADER, import_text
from tests.kernel.running import CALLING_VDSP, cclk

TEXT = "@kernel\ndef f(a: u8[:], b: u8[:]):\n    for i in range(len(a)):\n        b[i] = a[i] // 3\n"
RUN = """
import numpy as np
from bfsim.errors import BfsimWarning
from bfsim.kernel import VDSP_O2
from bfsim.kernel.host_code import instrument
from program import f
compiles = []
real = instrument.instrument
instrument.instrument = lambda *given, **named: compiles.append(1) or real(*given, **named)
a = np.arange(64, dtype=np.uint8); b = a.copy()
code = f.compile(VDSP_O2)
work = f.prepare(code, [a, b], code.new_totals()).run(a, b)
assert (b == a // 3).all()
print(work.issue_cclk, len(compiles))
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Use an empty cache, in a process that knows how to call kernels already."""
    caller()
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def compiles(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """List the kernels that are really compiled for the host from now on."""
    return _noted(monkeypatch, instrument, "instrument", lambda _, function, *__, **___: function.name)


@pytest.fixture
def costings(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """List the routines that are really costed from now on."""
    return _noted(monkeypatch, costing, "cost", lambda routine, _: routine.symbol)


def _noted(
    monkeypatch: pytest.MonkeyPatch, module: ModuleType, name: str, of: Callable[..., str]
) -> list[str]:
    """List what a function of a module is called for from now on."""
    found: list[str] = []
    real = getattr(module, name)

    def noted(*arguments: object, **options: object) -> object:
        found.append(of(*arguments, **options))
        return real(*arguments, **options)

    monkeypatch.setattr(module, name, noted)
    return found


def entries(folder: Path) -> list[Path]:
    """Return the files of the cache about compiled kernels: those with counters first, then those with machine code."""
    files = [each for each in folder.rglob("*") if each.is_file() and not is_of_source(each)]
    return sorted(files, key=lambda each: b'{"counters"' not in each.read_bytes()[:64])


def is_of_source(entry: Path) -> bool:
    """Whether an entry says what was read in a source: a list."""
    return entry.read_bytes()[store.CHECKSUM_BYTES :].startswith(b"[")


def cost_of(kernel: Kernel) -> int:
    """Run a kernel of TEXT and return its cycles, after checking its pixels."""
    a = np.arange(64, dtype=np.uint8)
    b = np.zeros_like(a)
    cycles = cclk(kernel, a, b)
    np.testing.assert_array_equal(b, a // 3)
    return cycles


def start(tmp_path: Path, cache: Path, **environment: str) -> subprocess.Popen[str]:
    """Run the kernel of TEXT in a process of its own; it prints its cycles and how often it compiled."""
    tmp_path.mkdir(exist_ok=True)
    (tmp_path / "program.py").write_text(HEADER + TEXT)
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-c", RUN],
        cwd=tmp_path,
        env=os.environ | {"BFSIM_CACHE_DIR": str(cache)} | environment,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_kernel_is_compiled_once(folder: Path, compiles: list[str], tmp_path: Path) -> None:
    """The same source, read again in the same process, is taken from the cache with all its counters."""
    first: Kernel = import_text(TEXT, tmp_path, "same").f
    second: Kernel = import_text("# moved down\n\n" + TEXT, tmp_path, "same").f
    assert cost_of(first) == cost_of(second)
    assert first.compile(VDSP_O2).counters == second.compile(VDSP_O2).counters
    assert compiles == ["f"]
    assert len(entries(folder)) == 2


@pytest.mark.parametrize(("old", "new"), [("// 3", "// 5"), ("a[i]", "b[i]"), ("b: u8[:]", "b: i8[:]")])
def test_a_changed_source_is_compiled_again(
    old: str, new: str, folder: Path, compiles: list[str], tmp_path: Path
) -> None:
    """A kernel that reads differently never meets the entry of what it was."""
    for text in (TEXT, TEXT.replace(old, new)):
        import_text(text, tmp_path, "same").f.compile(VDSP_O2)
    assert compiles == ["f", "f"]
    assert len(entries(folder)) == 2 * 2


def test_what_is_never_run_is_never_compiled(
    folder: Path, compiles: list[str], costings: list[str], tmp_path: Path
) -> None:
    """The size of a kernel is known from its costs; its machine code, in every build, is compiled when it is called."""
    kernel: Kernel = import_text(TEXT, tmp_path, "same").f
    assert sum(kernel.code_bytes(VDSP_O2).values()) > 0
    assert (compiles, costings, len(entries(folder))) == ([], ["same_f"], 1)
    for traced in (False, True):
        assert kernel.compile(VDSP_O2, traced=traced).counters == kernel.counters(VDSP_O2)
    assert (compiles, costings, len(entries(folder))) == (["f", "f"], ["same_f"], 3)


def test_a_changed_callee_profile_or_variant_is_compiled_again(
    folder: Path, compiles: list[str], costings: list[str], tmp_path: Path
) -> None:
    """What a kernel calls, the compiler profile and the kind of build belong to the entry's name."""
    for factor in (2, 3):
        text = f"@kernel\ndef g(x: i32) -> i32:\n    return x * {factor}\n@kernel\ndef f(x: i32) -> i32:\n    return g(x)\n"
        module = import_text(text, tmp_path, "same")
        assert module.f(5) == 5 * factor
    module.f.compile(CALLING_VDSP)
    module.f.compile(DEFAULT, counted=False)
    module.f.compile(DEFAULT, traced=True)
    assert compiles == ["f"] * 5
    assert costings == ["same_f"] * 2 + ["same_g", "same_f"]
    estimates = 2 * 2  # of both kernels with either factor, from which it is decided what is inlined
    assert len(entries(folder)) == 5 + 3 + estimates


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("damage", ["cut", "emptied", "flipped", "swapped"])
def test_a_damaged_entry_is_made_again(
    damage: str, which: int, folder: Path, compiles: list[str], costings: list[str], tmp_path: Path
) -> None:
    """An entry that was cut short or has a flipped bit is noticed, replaced, and never used."""
    cycles = cost_of(import_text(TEXT, tmp_path, "same").f)
    entry = entries(folder)[which]
    good = entry.read_bytes()
    flipped = bytearray(good)
    flipped[len(good) // 2] ^= 4
    bad = {"cut": good[:-9], "emptied": b"", "flipped": bytes(flipped), "swapped": good[32:] + good[:32]}[
        damage
    ]
    entry.write_bytes(bad)
    assert cost_of(import_text(TEXT, tmp_path, "same").f) == cycles
    assert (len(costings), len(compiles)) == [(2, 1), (1, 2)][which]
    assert entry.read_bytes() == good


def test_a_folder_that_cannot_be_written_is_no_obstacle(
    folder: Path, compiles: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a cache every start compiles, which is told, and nothing is left half-written. A full disk was told of nowhere."""
    folder.write_text("a file, not a folder")
    with pytest.warns(
        BfsimWarning, match="must be a folder, and there is none and none can be made: File exists"
    ) as told:
        assert cost_of(import_text(TEXT, tmp_path, "same").f) > 0
    assert "chmod" not in str(told[0].message)
    folder.unlink()
    store._trusted.cache_clear()
    full = OSError(errno.ENOSPC, "No space left on device")
    monkeypatch.setattr(os, "replace", lambda *_: (_ for _ in ()).throw(full))
    with pytest.warns(
        BfsimWarning, match=r"must take more, and does not \(No space left on device\): every start"
    ) as told:
        assert cost_of(import_text(TEXT, tmp_path, "same").f) > 0
    assert len(told) == 1
    assert compiles == ["f", "f"]
    assert entries(folder) == []


def test_an_entry_is_text_or_machine_code(folder: Path, tmp_path: Path) -> None:
    """An entry is a checksum and one line of JSON or an object file: nothing in it is unpickled."""
    cost_of(import_text(TEXT, tmp_path, "same").f)
    header, code = (each.read_bytes()[store.CHECKSUM_BYTES :] for each in entries(folder))
    assert header.startswith(b'{"counters":[["same_f"')
    assert b"ELF" in code[:4] or code[:4] in (b"\xcf\xfa\xed\xfe", b"\x64\x86\x00\x00")


@pytest.mark.usefixtures("folder")
def test_data_are_made_once() -> None:
    """And come from the cache as they did when they were made: as JSON has them."""
    made = iter([{"a": (1, 2)}])
    found = [store.kept("0" * 64, lambda: next(made)) for _ in range(2)]
    assert found == [{"a": [1, 2]}] * 2


def test_processes_share_the_cache_and_agree_on_the_cycles(tmp_path: Path) -> None:
    """Two processes that start at once, in other folders and with other hash seeds, count the same cycles.

    Both leave a good cache behind: a third one, later, compiles nothing.
    """
    cache = tmp_path / "cache"
    both = [start(tmp_path / seed, cache, PYTHONHASHSEED=seed) for seed in ("1", "2")]
    results = [each.communicate()[0].split() for each in both]
    assert [each.returncode for each in both] == [0, 0]
    later = start(tmp_path / "later", cache, PYTHONHASHSEED="3")
    cycles, compiled = later.communicate()[0].split()
    assert compiled == "0"
    assert {result[0] for result in results} == {cycles}
    assert (
        len(entries(cache)) == 4
    )  # of the kernel its code and its costs, what calls it, and how such a call is left


FOLLOW = """
from bfsim.kernel.native.entries import native_entry

@native_entry("int64", "int64")
def follow(word):
    return word + 1

print(follow.address() > 0)
"""


ROOM_FOR_NONE = 64


def follow_in(folder: Path, *, limit_bytes: int = resource.RLIM_INFINITY) -> None:
    """Compile a part as the tracing of accesses is one, in a process that can write files of a limited size, or take it from the cache."""
    program = folder.with_name("follow.py")
    limit = f"import resource as r; r.setrlimit(r.RLIMIT_FSIZE, ({limit_bytes}, {limit_bytes}))"
    program.write_text(limit + FOLLOW)
    # the limit would cut what Python keeps of the modules, too, which it then cannot read
    surroundings = {**os.environ, "BFSIM_CACHE_DIR": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    done = subprocess.run(
        [sys.executable, str(program)],
        capture_output=True,
        check=False,
        env=surroundings,
        text=True,
    )
    assert done.stdout == "True\n"
    assert ("(File too large): every start compiles" in done.stderr) == (limit_bytes == ROOM_FOR_NONE)


@pytest.mark.exhaustive
def test_a_damaged_or_full_cache_of_the_follower_is_no_obstacle(folder: Path) -> None:
    """It is compiled again, and kept if there is room."""
    follow_in(folder, limit_bytes=ROOM_FOR_NONE)
    assert entries(folder) == []
    follow_in(folder)
    (entry,) = entries(folder)
    good = entry.read_bytes()
    entry.write_bytes(good[:50])
    follow_in(folder)
    assert entry.read_bytes() == good


def others_may_write(folder: Path) -> None:
    """Open a folder to all users."""
    folder.chmod(0o777)


def it_is_anothers(folder: Path) -> None:
    """Give a folder to another user; only root can."""
    os.chown(folder, 12345, -1)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (others_may_write, "others may write to it .mode 777."),
        pytest.param(
            it_is_anothers,
            "it belongs to the user with the number 12345",
            marks=pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a file away"),
        ),
    ],
)
def test_a_folder_that_others_can_write_is_not_used(
    folder: Path, compiles: list[str], tmp_path: Path, change: Callable[[Path], None], message: str
) -> None:
    """What is in it would be run; the user is told once, and all is compiled."""
    folder.mkdir(mode=0o700)
    change(folder)
    with pytest.warns(BfsimWarning, match=message) as told:
        cost_of(import_text(TEXT, tmp_path, "same").f)
        cost_of(import_text(TEXT, tmp_path, "same").f)
    assert len(told) == 1
    assert not store.can_keep()
    assert compiles == ["f", "f"]
    assert not list(folder.iterdir())


def test_a_folder_that_cannot_be_written_is_told_of(
    folder: Path, compiles: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Once, and only where there is something new: what is in it is used."""
    cost_of(import_text(TEXT, tmp_path, "same").f)
    monkeypatch.setattr("os.access", lambda *_arguments: False)  # root can write everywhere
    store._is_writable.cache_clear()
    cost_of(import_text(TEXT, tmp_path, "same").f)
    assert compiles == ["f"]
    with pytest.warns(BfsimWarning, match="must be writable: every start compiles what is not in it") as told:
        store.save("one", b"1")
        store.save("two", b"2")
    assert len(told) == 1
    assert store.load("one") is None
    assert not store.can_keep()


def test_the_home_folder_may_be_written_as_in_a_shell(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A file of a CI service that sets BFSIM_CACHE_DIR to `~/...` made a folder called `~`."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for name, folder in (
        ("~/kept-here", tmp_path / "kept-here"),
        ("~nobody-at-all/x", Path("~nobody-at-all/x")),
    ):
        monkeypatch.setenv("BFSIM_CACHE_DIR", name)
        assert store.folder() == folder


def test_a_new_folder_is_private(folder: Path, tmp_path: Path) -> None:
    """Nobody else writes in it, whatever the user's umask is."""
    before = os.umask(0)
    try:
        cost_of(import_text(TEXT, tmp_path, "same").f)
    finally:
        os.umask(before)
    assert folder.stat().st_mode & 0o777 == 0o700
    assert not [each for each in folder.rglob("*") if each.stat().st_mode & 0o022]


def test_an_entry_that_others_can_write_is_not_used(
    folder: Path, compiles: list[str], tmp_path: Path
) -> None:
    """The folder may have been open to all when it was written."""
    cost_of(import_text(TEXT, tmp_path, "same").f)
    for each in entries(folder):
        each.chmod(0o666)
    cost_of(import_text(TEXT, tmp_path, "same").f)
    assert compiles == ["f", "f"]


def test_entries_that_changed_places_are_not_used(folder: Path) -> None:
    """Each is whole, but it is another kernel's."""
    store.save("aa1", b"one")
    store.save("bb2", b"other")
    one, other = folder / "aa" / "aa1", folder / "bb" / "bb2"
    kept = one.read_bytes()
    one.write_bytes(other.read_bytes())
    other.write_bytes(kept)
    assert store.load("aa1") is None
    assert store.load("bb2") is None

"""Settings for every test.

`pytest --recording FILE tests/firmware` also compares what the firmware makes of the pictures of a recording.
"""

from __future__ import annotations

import os
import shutil
import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import settings

from bfsim.compiling.toolchain import GCC
from tests.pages import path_without_compiler
from tests.tiers import leaves_examples_open

# no deadline, for the first example compiles kernels, and machines are busy
settings.register_profile("bfsim", deadline=None, derandomize=True)  # the same examples every time
settings.register_profile("few", settings.get_profile("bfsim"), max_examples=25)
settings.register_profile("search", deadline=None)  # others every time
settings.load_profile("bfsim")

PATH = os.environ["PATH"]
TESTS = Path(__file__).parent
Write = Callable[[str, str], Path]
"""The fixture `write`."""
WHOLE_COMMANDS = (TESTS, TESTS / "cli")
"""Folders of tests that do what users do."""
COMPILES = (
    TESTS / "firmware" / "test_areas.py",
    TESTS / "kernel" / "estimate" / "test_firmware_twins.py",
    TESTS / "test_verifying.py",
)
"""Their tests compile the built-in firmware as it is estimated, and its kernels as -O2 estimates them, which takes up to a minute."""


@pytest.hookimpl(trylast=True)
def pytest_configure(config: pytest.Config) -> None:
    """Try few examples of a property in plain `pytest`, unless it says how many; what is exhaustive has all of them.

    Numpy and SciPy keep to one core in each of the workers, which begin after this: together they have all.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    if config.option.markexpr == "not exhaustive" and not config.getoption("--hypothesis-profile"):
        settings.load_profile("few")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Run what does not ask for a Blackfin's compiler as where there is none: with one, kernels would take other cycles."""
    needs_compiler = item.get_closest_marker("toolchain") is not None
    os.environ["PATH"] = PATH if needs_compiler else path_without_compiler()
    if needs_compiler and shutil.which(GCC) is None:
        pytest.skip("no bfin-elf toolchain on PATH")


@pytest.fixture(scope="session", autouse=True)
def no_terminal() -> None:
    """Reports are as wide as without a terminal; pytest-xdist gives its workers one."""
    os.environ.pop("COLUMNS", None)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Begin with what compiles: later both cores would, at the same time. Then come whole commands, the longest tests.

    So at the end no core waits for the other.

    Properties that plain `pytest` tries on few examples are tried on all where what is exhaustive is asked for.
    """
    items.sort(key=lambda item: (item.path not in COMPILES, item.path.parent not in WHOLE_COMMANDS))
    for item in items if config.option.markexpr == "exhaustive" else ():
        if leaves_examples_open(getattr(item, "obj", None)):
            item.add_marker(pytest.mark.exhaustive)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Take recordings beside those that the tests have themselves."""
    parser.addoption("--recording", action="append", default=[], type=Path, help="play these pictures, too")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Let a test that takes a `given_recording` run on each of them."""
    if "given_recording" in metafunc.fixturenames:
        given = metafunc.config.getoption("recording")
        metafunc.parametrize("given_recording", given, ids=[path.stem for path in given])


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Write a file of a name and a text into the current folder, which is a new one."""
    monkeypatch.chdir(tmp_path)

    def write_file(name: str, text: str) -> Path:
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    return write_file


@pytest.fixture(scope="session", autouse=True)
def ctrl_c() -> None:
    """Ctrl-C interrupts, also where the tests run in the background of a shell, which has it ignored."""
    signal.signal(signal.SIGINT, signal.default_int_handler)

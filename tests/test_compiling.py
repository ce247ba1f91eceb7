"""Object code of kernels: kept by what it was made of, with and without a compiler. A stand-in makes code for this machine."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from benchmarks.toolchain.keep import FOLDER, first_calls, programs, recipes
from bfsim import compiling
from bfsim.blackfin.elf.objects import read_object
from bfsim.compiling.first_calls import FIRST_CALLS
from bfsim.compiling.object_code import PROGRAMS, InC, object_code
from bfsim.compiling.recipes import KEPT_COMPILER
from bfsim.compiling.toolchain import Toolchain, blackfin_compiler, prefer
from bfsim.errors import ConfigError
from bfsim.files import store
from bfsim.kernel import GCC_O0, GCC_O2
from tests.kernel import c_kernels
from tests.kernel.host_c import COMPILER, needs_compiler

KERNELS = [c_kernels.narrowed]


@pytest.fixture(autouse=True)
def _empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("BFSIM_CACHE_DIR", str(tmp_path / "cache"))


@needs_compiler
def test_code_is_made_once_for_each_compiler_and_level() -> None:
    """The second time the same file comes from the cache; another level is another file."""
    tools = Toolchain((COMPILER or "",))
    made = object_code(KERNELS, KERNELS, GCC_O2, tools)
    broken = Toolchain((COMPILER or "",), libraries=("-lno_such_library",))
    assert object_code(KERNELS, KERNELS, GCC_O2, broken) == made
    with pytest.raises(ConfigError, match="no_such_library"):
        object_code(KERNELS, KERNELS, GCC_O0, broken)
    assert made.symbol_of(c_kernels.narrowed.function) == "_narrowed"


def test_what_a_compiler_says_of_a_file_obeys_no_terminal(tmp_path: Path) -> None:
    """It quotes lines of a file that is no source, escape sequences and all."""
    tools = Toolchain(("sh", "-c", r"printf 'x.c:1:1: error\n    1 | \033[2J\n' >&2; exit 1"))
    with pytest.raises(ConfigError, match=r"says: x.c:1:1: error\n    1 \| \\x1b\[2J$"):
        tools.build(tmp_path, (), ())


def test_what_a_compiler_says_in_another_encoding_is_told(tmp_path: Path) -> None:
    """As GCC does in a locale of ISO 8859: it ended in a traceback."""
    tools = Toolchain(("sh", "-c", r"printf 'x.c:1:1: Fehler: \374ber\n' >&2; exit 1"))
    with pytest.raises(ConfigError, match="says: x.c:1:1: Fehler: .ber$"):
        tools.build(tmp_path, (), ())


def test_a_compiler_that_makes_nothing_is_named(tmp_path: Path) -> None:
    """Told was a file of a folder that is gone."""
    with pytest.raises(ConfigError, match="^true must be GCC for the Blackfin, but makes no object file$"):
        Toolchain(("true",)).build_object(tmp_path, ("x.c",), ())


@pytest.mark.parametrize(
    "error",
    ["x.c:40:1: error: expected ';'", "x.s:7: Error: syntax error", "cc1: internal compiler error: no"],
)
def test_an_error_is_not_lost_behind_warnings(tmp_path: Path, error: str) -> None:
    """Real code has pages of them, and the first ten lines were all that was told."""
    tools = Toolchain(("sh", "-c", f'seq -f "x.c:%g:1: warning: unused" 30 >&2; echo "{error}" >&2; exit 1'))
    with pytest.raises(ConfigError) as told:
        tools.build(tmp_path, (), ())
    assert str(told.value) == f"sh must run without an error, but says: {error}"


def test_without_a_compiler_code_must_be_kept() -> None:
    """What is missing, whose code it would be, and what helps."""
    with pytest.raises(
        ConfigError,
        match=r"bfin-elf-gcc must be on the PATH to compile c_kernels.c, of which no code of GCC 12",
    ):
        object_code(KERNELS, KERNELS, GCC_O2, None)


def test_a_folder_that_is_named_must_have_a_compiler(tmp_path: Path) -> None:
    """On the PATH there may be none."""
    with pytest.raises(ConfigError, match=f"bfin-elf-gcc must be in {tmp_path}, but is not; CONTRIBUTING.md"):
        prefer(tmp_path)


def test_a_folder_that_is_named_comes_before_the_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The folder itself, or its `bin`, as a toolchain is installed."""
    for name, folder in (("path", "path"), ("named", "named/bin")):
        program = tmp_path / folder / "bfin-elf-gcc"
        program.parent.mkdir(parents=True)
        program.write_text(f"#!/bin/sh\necho {name}\n")
        program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'path'}:/bin:/usr/bin")
    for folder, version in ((None, "path"), ("named", "named"), ("path", "path"), ("named/bin", "named")):
        if folder:
            prefer(tmp_path / folder)
        found = blackfin_compiler()
        assert found and found.identity.version == version


@pytest.mark.exhaustive
def test_what_comes_with_bfsim_is_the_code_of_what_it_is_now() -> None:
    """Kernels of the built-in firmware, and examples: `python -m benchmarks.toolchain.keep` compiles what was changed."""
    in_c = programs()
    compiled = {each.digest(KEPT_COMPILER) for each in recipes(in_c.values())}
    assert {each.name for each in FOLDER.iterdir()} == compiled | in_c.keys() | {PROGRAMS, FIRST_CALLS}
    assert (store.shipped(compiling.__name__, PROGRAMS) or b"").decode().split() == [*in_c]
    assert (store.shipped(compiling.__name__, FIRST_CALLS) or b"").decode() == first_calls()
    for name, each in in_c.items():
        assert InC(**json.loads(store.shipped(compiling.__name__, name) or b"{}")) == each
    for each in compiled:
        assert read_object(store.shipped(compiling.__name__, each) or b"", each).symbols

"""Who may import whom (the rooms of the house), read from the sources themselves."""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from tests.rooms import BLACKFIN, CORE, ESTIMATE, KERNEL, MACHINE, MAY_IMPORT, READ_VERSION, REPORT

ROOT = Path(__file__).parent.parent


@cache
def imported_modules(path: Path) -> tuple[str, ...]:
    """Every module that a file imports, at its top, inside functions and for type checking alike."""
    return tuple(_imported(path))


def _imported(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (each.name for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}:{node.lineno}: imports are absolute"
            assert node.module
            if node.module == "bfsim":
                yield from (f"bfsim.{each.name}" for each in node.names)
            else:
                yield node.module
                names = (f"{node.module}.{each.name}" for each in node.names)
                yield from (each for each in names if (ROOT / f"{each.replace('.', '/')}.py").exists())


def room_of(path: Path) -> str:
    """The folder or file of bfsim/ that a source belongs to."""
    return path.relative_to(ROOT / "bfsim").parts[0].removesuffix(".py")


SOURCES = sorted(
    path
    for path in (ROOT / "bfsim").rglob("*.py")
    if path.parent != ROOT / "bfsim" or path.stem != "__init__"
)


def imports_in(room: str) -> Iterator[tuple[Path, str]]:
    """Each import of a room: the file, and the module that it imports."""
    for path in SOURCES:
        if room_of(path) == room:
            yield from ((path, module) for module in imported_modules(path))


def test_every_room_is_listed() -> None:
    """A new room must be given its place in the house."""
    assert {room_of(each) for each in SOURCES} == set(MAY_IMPORT)


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_a_room_stands_above_those_that_it_imports(room: str) -> None:
    """The table goes from the bottom of the house to the top: so no rooms import each other in a circle."""
    rooms = [*MAY_IMPORT]
    assert MAY_IMPORT[room] <= {*rooms[: rooms.index(room)]}


@pytest.mark.parametrize("room", MAY_IMPORT)
def test_a_room_imports_what_the_table_says(room: str) -> None:
    """All of it and nothing else; nothing in bfsim imports firmware."""
    imported = set()
    for path, module in imports_in(room):
        parts = module.split(".")
        assert parts[0] != "tinyphoon", f"{path} imports {module}"
        if module == "bfsim.__version__":
            assert room in READ_VERSION, f"{path} imports {module}"
        elif parts[0] == "bfsim" and parts[1] != room:
            assert parts[1] in MAY_IMPORT[room], f"{path} imports {module}"
            imported.add(parts[1])
    assert imported == MAY_IMPORT[room]


def test_a_block_of_the_machine_imports_only_what_it_is_wired_to() -> None:
    """The buses know no device, no device knows a core, and nobody knows the board."""
    for path, module in imports_in("machine"):
        block = path.relative_to(ROOT / "bfsim/machine").parts[0].removesuffix(".py")
        if block not in {"board", "__init__"} and module.startswith("bfsim.machine."):
            other = module.split(".")[2]
            assert other == block or other in MACHINE[block], f"{path} imports {module}"


@pytest.mark.parametrize(
    ("folder", "parts"),
    [
        ("machine/core", CORE),
        ("blackfin", BLACKFIN),
        ("kernel", KERNEL),
        ("kernel/estimate", ESTIMATE),
        ("report", REPORT),
    ],
)
def test_parts_stand_above_those_that_they_import(folder: str, parts: dict[str, set[str]]) -> None:
    """The table of the parts of a room goes from the bottom to the top, and names all that each imports of the others."""
    name, found = f"bfsim.{folder.replace('/', '.')}.", {each: set[str]() for each in parts}
    for path in (each for each in SOURCES if each.is_relative_to(ROOT / "bfsim" / folder)):
        part = path.relative_to(ROOT / "bfsim" / folder).parts[0].removesuffix(".py")
        if part != "__init__":
            modules = (each for each in imported_modules(path) if each.startswith(name))
            found[part] |= {each.removeprefix(name).split(".")[0] for each in modules} - {part}
    assert found == parts
    order = [*parts]
    assert all(parts[each] <= {*order[:number]} for number, each in enumerate(order))


def test_a_peripheral_is_known_to_the_table_alone() -> None:
    """Its file, and the line that wires it: whoever else needs peripherals takes them from there."""
    folder = ROOT / "bfsim/machine/peripherals"
    common = {"__init__", "device", "peripheral", "table", "wire"}
    own = {
        f"bfsim.machine.peripherals.{each.stem}" for each in folder.glob("*.py") if each.stem not in common
    }
    importing = {
        path.relative_to(ROOT / "bfsim").as_posix() for path in SOURCES if own & {*imported_modules(path)}
    }
    assert len(own) > 1
    # the API has what firmware derives its devices from
    assert importing == {"machine/peripherals/table.py", "api.py"}


def test_the_uart_is_named_where_the_recipe_says() -> None:
    """docs/how-to/peripheral.md says what a peripheral needs, and nothing else of bfsim may know that this one is there."""
    named = {
        path.relative_to(ROOT / "bfsim").as_posix()
        for path in SOURCES
        if re.search(r"(?<![A-Za-z])(uart|Uart|UART)", path.read_text())
    }
    assert named == {
        "api.py",
        "chip/dma_channels.py",
        "chip/interrupts.py",
        "chip/uart_registers.py",
        "machine/bus/masters.py",
        "machine/bus/state.py",
        "machine/peripherals/table.py",
        "machine/peripherals/uart.py",
        "machine/program.py",
    }


def test_no_files_import_each_other_in_a_circle() -> None:
    """Not for their types either: each can be read with what stands below it alone."""
    files = {".".join(each.relative_to(ROOT).with_suffix("").parts): each for each in SOURCES}
    left = {name: {*imported_modules(path)} & files.keys() for name, path in files.items()}
    while lowest := {name for name, imports in left.items() if not imports & left.keys()}:
        left = {name: imports for name, imports in left.items() if name not in lowest}
    assert not left


def test_a_command_imports_no_other() -> None:
    """What several commands take stands in cli/options, which knows no command; `main` alone imports them all."""
    cli = ROOT / "bfsim/cli"
    commands = {each for each in imported_modules(cli / "main.py") if each.startswith("bfsim.cli.")}
    assert len(commands) > 10
    for path in cli.rglob("*.py"):
        if path.name != "main.py":
            assert not commands & set(imported_modules(path)), path


def test_simpy_stays_in_the_machine() -> None:
    """Only bfsim/machine knows the simulation kernel."""
    importing = {room for room in MAY_IMPORT for _, each in imports_in(room) if each.split(".")[0] == "simpy"}
    assert importing == {"machine"}


def test_firmware_imports_only_the_api() -> None:
    """Firmware imports bfsim.api, numpy, itself and the standard library; its scenes are data of the renderer."""
    allowed = {"numpy", "tinyphoon", *sys.stdlib_module_names}
    for path in sorted((ROOT / "firmware").rglob("*.py")):
        facade = "bfsim.recording.scenes" if path.parent.name == "scenes" else "bfsim.api"
        for module in imported_modules(path):
            assert module == facade or module.split(".")[0] in allowed, f"{path} imports {module}"


ROBOT_WORDS = re.compile(
    r"tinyphoon|\bthesis|\bT (§|Table|Fig|Eq)|strategy|edge detection|open & closing|blob detection|line detection"
    r"|shape detection|object detection",
    re.IGNORECASE,
)
"""What the built-in firmware is about: its robot, the thesis behind it, its stages, who gives it orders and how."""


def test_the_simulator_knows_no_robot() -> None:
    """Another firmware, with another device beside another robot, must not need a change of bfsim.

    Two places may: `shipped` has the names of what comes with bfsim, and chip/ the thesis as the source of a number.
    """
    for path in (each for each in SOURCES if room_of(each) != "shipped"):
        named = [line for line in path.read_text().splitlines() if ROBOT_WORDS.search(line)]
        if room_of(path) == "chip":
            named = [line for line in named if "#" not in line]
        assert not named, f"{path} names the robot: {named}"


def test_the_page_names_every_room() -> None:
    """docs/architecture.md says of each room, and of each part of a core, of the Blackfin, of the kernel and of the reports, what is in it."""
    page = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    rooms = {
        each
        for each in (*MAY_IMPORT, *CORE, *BLACKFIN, *KERNEL, *ESTIMATE, *REPORT)
        if not each.startswith("__")
    }
    assert {each for each in rooms if f"`{each}`" not in page} == set()

"""Programs that GCC has compiled, under the GNU simulator and translated: what they print, which is their cycles and checksums.

    python -m benchmarks.real_programs                the C twins at -O2 and -O0
    python -m benchmarks.real_programs fir_i16 ...     only these

Needs a bfin-elf toolchain on PATH. Whole programs run, start-up code and newlib's printf included; the monitor below stands for the
simulator's. At the end is how fast both are: simulated cycles a second of the host's time, without compiling.
"""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.given_names import given_names
from benchmarks.twins.measure import FLAGS, SOURCES
from bfsim.blackfin.elf.linking import link
from bfsim.blackfin.elf.objects import read_object
from bfsim.blackfin.execution.address_space import AddressSpace
from bfsim.blackfin.execution.processor import Processor
from bfsim.blackfin.instructions.event import Event

MEMORY_BYTES = 0x8000000
"""Of the GNU simulator, from address 0; the stack begins at its end."""
SYSCFG = 0x30
"""As the GNU simulator starts."""
EXIT, OPEN, READ, WRITE = 1, 2, 4, 5
"""Calls of the monitor, by P0: R0 has the address of their arguments, and gets the result."""
REFUSED = 0xFFFFFFFF


@dataclass(frozen=True, slots=True)
class Run:
    """What a program printed, its cycles, and the seconds that it took."""

    printed: str
    cclk: int
    seconds: float


def translated(program: Path) -> Run:
    """Run a program as native code; it is run twice, and the second time is timed."""
    image = link(read_object(program.read_bytes(), program.name))
    space = AddressSpace()
    memory = space.add(0, MEMORY_BYTES).octets
    core = Processor(space, entries={each.address for each in image.routines})
    for _ in range(2):
        memory[:] = 0
        for each in image.segments:
            memory[each.address : each.end] = np.frombuffer(each.octets, np.uint8)
        core.state.slots[:] = 0
        core.state["PC"], core.state["SP"], core.state["SYSCFG"] = (
            image.address_of("__start"),
            MEMORY_BYTES,
            SYSCFG,
        )
        begin = time.perf_counter()
        printed = b"".join(_printed(core, memory, program.parent))
        seconds = time.perf_counter() - begin
    return Run(printed.decode(), core.state["CLOCK"], seconds)


def _printed(core: Processor, memory: NDArray[np.uint8], folder: Path) -> Iterator[bytes]:
    """Run a program until it ends; yield what it prints. It may read one file of `folder`."""
    words = memory.view("<u4")
    content, position = b"", 0
    while (event := core.run()) is Event.EXCEPTION:
        call, at = core.state["P0"], core.state["R0"] // 4
        _, address, nbytes = arguments = words[at : at + 3].tolist()
        result = REFUSED
        if call == EXIT:
            return
        if call == OPEN:
            name = memory[arguments[0] :][:80].tobytes().split(b"\0")[0].decode()
            content, position, result = (folder / name).read_bytes(), 0, 3
        elif call == READ:
            part = content[position : position + nbytes]
            memory[address : address + len(part)] = np.frombuffer(part, np.uint8)
            position, result = position + len(part), len(part)
        elif call == WRITE:
            yield memory[address : address + nbytes].tobytes()
            result = nbytes
        core.state["R0"] = result
    raise SystemExit(
        f"a program must end by a call of the monitor, not by {event.name} at {core.state['PC']:#010x}"
    )


def simulated(program: Path) -> Run:
    """Run a program under the GNU simulator."""
    begin = time.perf_counter()
    done = subprocess.run(
        ["bfin-elf-run", program], check=False, capture_output=True, text=True, cwd=program.parent
    )
    return Run(done.stdout, 0, time.perf_counter() - begin)


def main() -> None:
    """Compare the programs; the last line sums them up."""
    known = [each.stem.removeprefix("k_") for each in sorted(SOURCES.glob("k_*.c"))]
    names = given_names(__doc__, known) or known
    equal = total = 0
    cclk = there_seconds = here_seconds = 0.0
    with tempfile.TemporaryDirectory() as folder:
        for source in (SOURCES / f"k_{name}.c" for name in names):
            for level in ("-O2", "-O0"):
                program = Path(folder) / source.stem
                subprocess.run(["bfin-elf-gcc", *FLAGS, level, source, "-o", program], check=True)
                there, here = simulated(program), translated(program)
                total += 1
                equal += there.printed == here.printed
                cclk, there_seconds, here_seconds = (
                    cclk + here.cclk,
                    there_seconds + there.seconds,
                    here_seconds + here.seconds,
                )
                if there.printed != here.printed:
                    print(f"{source.stem} {level} differs:\n  {there.printed!r}\n  {here.printed!r}")
    print(f"{equal} of {total} programs print the same")
    print(
        f"{cclk:,.0f} cycles: {cclk / there_seconds:,.0f} a second simulated, {cclk / here_seconds:,.0f} translated"
    )


if __name__ == "__main__":
    main()

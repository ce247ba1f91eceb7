"""Programs that Csmith writes by chance, as GCC compiles them: what they compute and their cycles, here and under the GNU simulator.

    python -m benchmarks.random_programs                    25 programs at -O0, -O2, -Os and -O3
    python -m benchmarks.random_programs --first 100 --programs 50

Needs a bfin-elf toolchain with the simulator on PATH, csmith, and its header (Debian: csmith, libcsmith-dev). Each
program is called as a kernel of `kernel_from` is, and by a program under the simulator; both give the checksum of all
of its variables. Left out are programs that do not end in some seconds there, and those that need more stack than the
scratchpad has. Where the simulator ends a program for an access that is not aligned, bfsim must, too.
"""

from __future__ import annotations

import argparse
import subprocess
import tempfile
from collections import Counter
from enum import StrEnum
from pathlib import Path

from bfsim.api import kernel_from, u32
from bfsim.errors import KernelError

LEVELS = ("-O0", "-O2", "-Os", "-O3")
HEADERS = "/usr/include/csmith"
FLAGS = ("-mcpu=bf561", "-w", f"-I{HEADERS}")
SIMULATED_S = 3.0
AROUND_CCLK = 6
"""Of what the program around a call counts in its own: the call, and the second reading of CYCLES."""

KERNEL = """\
#include <stdio.h>
#include <string.h>
#define main inner
#define printf(...) 0
#include "program.c"
#undef main
unsigned entry(void)
{
    inner(0, 0);
    return crc32_context;
}
"""
AROUND = """\
#include <stdio.h>
unsigned entry(void);
int main(void)
{
    unsigned begin, end, sum;
    __asm__ volatile ("R0 = SYSCFG; BITSET (R0, 1); SYSCFG = R0; CSYNC;" ::: "R0", "CC");
    __asm__ volatile ("%0 = CYCLES;" : "=d" (begin) :: "memory");
    sum = entry();
    __asm__ volatile ("%0 = CYCLES;" : "=d" (end) :: "memory");
    printf("%u %u", sum, end - begin);
    return 0;
}
"""


class Outcome(StrEnum):
    """What came of a program at a level."""

    EQUAL = "equal, to the bit and the cycle"
    OTHER_RESULT = "another result"
    OTHER_CYCLES = "other cycles"
    ENDLESS = "does not end in time under the simulator"
    STACK = "needs a larger stack"


SAID = {"(Unaligned data access)": "no multiple of the 2 or 4 bytes"}
"""How both refuse a program: a part of what the simulator says, and of what bfsim does."""


def outcome(folder: Path, level: str) -> Outcome:
    """Compile the program in `folder`, and compare."""
    part, kernel, program = (folder / f"{each}{level}" for each in ("part", "kernel", "program"))
    part, kernel = part.with_suffix(".o"), kernel.with_suffix(".o")
    _run("bfin-elf-gcc", *FLAGS, level, "-c", folder / "kernel.c", "-o", part)
    _run("bfin-elf-gcc", *FLAGS, "-r", "-nostdlib", part, "-lc", "-lgcc", "-o", kernel)
    _run("bfin-elf-gcc", *FLAGS, "-msim", "-O2", folder / "around.c", part, "-o", program)
    refused = ""
    try:
        there = _run("bfin-elf-run", program, timeout=SIMULATED_S)
    except subprocess.TimeoutExpired:
        return Outcome.ENDLESS
    except subprocess.CalledProcessError as error:
        there, refused = "0 0", error.stderr
    value, cclk = map(int, there.split())
    try:
        found = kernel_from(kernel, "entry", result=u32)()
    except KernelError as error:
        if "its stack" in str(error):
            return Outcome.STACK
        both = any(one in refused and other in str(error) for one, other in SAID.items())
        return Outcome.EQUAL if both else Outcome.OTHER_RESULT
    if refused or found != value:
        return Outcome.OTHER_RESULT
    here = kernel_from(kernel, "entry", result=u32).cost(profile="gcc")
    return Outcome.EQUAL if here + AROUND_CCLK == cclk else Outcome.OTHER_CYCLES


def _run(*command: str | Path, timeout: float | None = None) -> str:
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=timeout)
    return done.stdout


def main() -> None:
    """Compare programs, and print how many came out how."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--first", type=int, default=1, help="seed of the first program")
    parser.add_argument("--programs", type=int, default=25)
    given = parser.parse_args()
    found: Counter[Outcome] = Counter()
    for seed in range(given.first, given.first + given.programs):
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "kernel.c").write_text(KERNEL)
            (folder / "around.c").write_text(AROUND)
            sizes = ("--max-funcs", "5", "--max-block-depth", "3")
            _run("csmith", "--seed", str(seed), *sizes, "-o", folder / "program.c")
            for level in LEVELS:
                found[came := outcome(folder, level)] += 1
                if came in (Outcome.OTHER_RESULT, Outcome.OTHER_CYCLES):
                    print(f"program {seed} at {level}: {came}")
    for each in Outcome:
        print(f"{found[each]:5} {each}")


if __name__ == "__main__":
    main()

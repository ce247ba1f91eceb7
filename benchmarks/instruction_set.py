"""bfsim's decoder and translator beside the GNU simulator: its own test programs, and random sequences of instructions.

    python -m benchmarks.instruction_set [SOURCES] [--seed N] [--sequences N] [--length N] [--record FILE]

SOURCES is the unpacked source of GDB, of which sim/testsuite/bfin is used (Debian: gdb-source). Its programs are
assembled, linked and run; how many pass is printed, and of the others why they do not. Then random sequences are run by
both, and all registers are compared. Needs bfin-elf-as, -ld, -gcc and -run on PATH. Some 20 minutes on one core for the
programs, 20 s for 1,000 sequences of 8.
"""

from __future__ import annotations

import argparse
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

from benchmarks.instructions.gnu import simulated
from benchmarks.instructions.programs import Outcome, Verdict, judged
from benchmarks.instructions.recorded import record
from benchmarks.instructions.sequences import (
    DEPARTURES,
    Registers,
    Sequence,
    random_sequence,
    random_start,
    translated,
)
from bfsim.blackfin.instructions.decode import disassemble
from bfsim.blackfin.instructions.text import text

TESTSUITE = "sim/testsuite/bfin"
STARTS = 24
"""As many different registers do sequences start with."""
SHOWN = 20
LONGEST_S = 60
"""[ours] Of a program."""


def main() -> None:
    """Run what the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sources", nargs="?", type=Path, help="the unpacked source of GDB")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sequences", type=int, default=1000)
    parser.add_argument("--length", type=int, default=8, help="instructions of a sequence")
    parser.add_argument("--record", type=Path, help="where the sequences go with the simulator's registers")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if given.sources:
            _programs(given.sources / TESTSUITE, Path(folder))
        _sequences(given.seed, given.sequences, given.length, Path(folder), given.record)


def _programs(testsuite: Path, folder: Path) -> None:
    sources = sorted(each for each in testsuite.iterdir() if each.suffix in {".s", ".S"})
    verdicts = [judged(each, folder, LONGEST_S) for each in sources]
    counts = Counter(each.outcome for each in verdicts)
    user = [each for each in verdicts if each.outcome in {Outcome.PASSES, Outcome.FAILS}]
    print(f"{len(sources)} programs in assembler; {counts[Outcome.PASSES]} of {len(user)} of user mode pass")
    for outcome in Outcome:
        if counts[outcome]:
            print(f"{counts[outcome]:6}  {outcome}")
    for each in verdicts:
        if each.outcome not in {Outcome.PASSES, Outcome.SUPERVISOR}:
            print(_line(each))


def _line(verdict: Verdict) -> str:
    return f"{verdict.name}: {verdict.outcome.name.lower()}: {verdict.detail.strip()}"


def _sequences(seed: int, number: int, length: int, folder: Path, recording: Path | None) -> None:
    rng = Random(seed)
    starts = [random_start(rng) for _ in range(STARTS)]
    sequences = [random_sequence(rng, length, starts[each % STARTS]) for each in range(number)]
    gnu = simulated(sequences, folder)
    ours = translated(sequences)
    wrong = [each for each in zip(sequences, ours, gnu, strict=True) if each[1] != each[2]]
    print(
        f"{number - len(wrong)} of {number} sequences of {length} instructions end with all registers equal (seed {seed})"
    )
    for each in wrong[:SHOWN]:
        print(_difference(*each))
    print(
        "not compared, for GNU's simulator departs from the programming reference:",
        *DEPARTURES.values(),
        sep="\n  ",
    )
    if recording:
        record(recording, sequences, gnu)


def _difference(sequence: Sequence, ours: Registers, gnu: Registers) -> str:
    code = "; ".join(map(text, disassemble(sequence.code, 0)))
    return f"{code}: " + ", ".join(
        f"{name} {ours[name]:#x}, not {gnu[name]:#x}" for name in ours if ours[name] != gnu[name]
    )


if __name__ == "__main__":
    main()

"""Give bfsim inputs that are wrong by chance, and see that each is taken or refused in a few words.

    python benchmarks/fuzz.py [--seed N] [--seconds S] [--count N] [--only NUMBER]

Every input must end with exit code 0, or with 2 and one message of at most LONGEST_STDERR characters without a traceback,
within SLOWEST_S of processor time and MOST_MEMORY_MB. Input NUMBER of a seed is always the same; --only gives it alone. One
in SAMPLED runs in a process of its own, too, and must end there as it did here. 10^5 inputs take about an hour.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import chdir
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from random import Random

import click
from click.testing import CliRunner

from benchmarks.fuzzing.inputs import KINDS
from bfsim.cli.main import main as bfsim

LONGEST_STDERR = 1500
SLOWEST_S = 20.0
MOST_MEMORY_MB = 1500
SAMPLED = 500
ROOT = Path(__file__).parent.parent


def _most_mb() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10


@dataclass(slots=True)
class Tally:
    """How many inputs of each kind ended how, and what was wrong with those that ended wrongly."""

    counts: Counter[tuple[str, int]] = field(default_factory=Counter)
    faults: list[str] = field(default_factory=list)
    sampled: int = 0
    begun_at_mb: int = field(default_factory=_most_mb)
    """What the process took before: a test's has done other things."""

    def lines(self) -> Iterator[str]:
        """Yield a line for each kind, and one for each fault."""
        for kind in KINDS:
            taken, refused = (self.counts[kind.__name__, code] for code in (0, 2))
            yield f"{kind.__name__:>15}: {taken} taken, {refused} refused"
        yield f"{sum(self.counts.values())} inputs, {self.sampled} of them in processes of their own; {len(self.faults)} ended wrongly"
        yield from self.faults


def fuzz(seed: int, *, seconds: float = float("inf"), most: float = float("inf")) -> Tally:
    """Try inputs of all kinds in turn until the time is over, or so many are tried."""
    tally = Tally()
    end = time.monotonic() + seconds
    for number in count():
        if time.monotonic() > end or number >= most:
            return tally
        try_one(seed, number, tally)
    raise AssertionError


def try_one(seed: int, number: int, tally: Tally) -> None:
    """Try one input, and enter how it ended."""
    kind = KINDS[number % len(KINDS)]
    random = Random(f"{seed} {number}")
    with tempfile.TemporaryDirectory() as name, chdir(name):
        arguments = kind(random, Path(name))
        begun = time.process_time()
        result = CliRunner().invoke(bfsim, arguments, prog_name="bfsim")
        spent_s, grown_mb = time.process_time() - begun, _most_mb() - tally.begun_at_mb
        problem = _problem(result.exit_code, result.stderr, spent_s, grown_mb)
        if result.exception and not isinstance(result.exception, SystemExit):
            problem = f"{type(result.exception).__name__}: {str(result.exception)[:200]}"
        if not problem and number % SAMPLED == SAMPLED - 1:
            tally.sampled += 1
            problem = _otherwise(arguments, result.exit_code)
    tally.counts[kind.__name__, result.exit_code] += 1
    if problem:
        shown = " ".join(each[:60] for each in arguments)
        tally.faults.append(f"--seed {seed} --only {number}: {kind.__name__}: {problem}: bfsim {shown!r}")


def _problem(code: int, stderr: str, seconds: float, used_mb: int) -> str:
    """Say what is wrong with how an input ended; nothing if all is well."""
    if code not in (0, 2):
        return f"exit code {code}"
    if code == 2 and not stderr.strip():
        return "no message"
    if len(stderr) > LONGEST_STDERR or "Traceback" in stderr:
        return f"message of {len(stderr)} characters: {stderr[:100]!r}"
    if seconds > SLOWEST_S:
        return f"{seconds:.0f} s"
    return f"{used_mb} MB of memory" if used_mb > MOST_MEMORY_MB else ""


def _otherwise(arguments: list[str], code: int) -> str:
    """Say how an input ends in a process of its own, if that is otherwise than here."""
    surroundings = {**os.environ, "PYTHONPATH": f"{ROOT}:{ROOT / 'firmware'}"}
    command = [sys.executable, "-m", "bfsim", *arguments]
    encoded = [os.fsencode(each) for each in command]
    try:
        done = subprocess.run(encoded, env=surroundings, capture_output=True, check=False, timeout=300)
    except OSError:  # the system takes no argument as long
        return ""
    return (
        "" if done.returncode == code else f"exit code {done.returncode} in a process of its own, {code} here"
    )


@click.command()
@click.option("--seed", default=1, show_default=True)
@click.option("--seconds", default=60.0, show_default=True)
@click.option("--count", "most", type=int, help="Stop after as many inputs.")
@click.option("--only", type=int, help="Try this one.")
def main(seed: int, seconds: float, most: int | None, only: int | None) -> None:
    """Give bfsim inputs that are wrong by chance, and print how they ended."""
    if only is not None:
        tally = Tally()
        try_one(seed, only, tally)
    else:
        tally = fuzz(seed, seconds=seconds, most=most or float("inf"))
    for line in tally.lines():
        click.echo(line)
    sys.exit(bool(tally.faults))


if __name__ == "__main__":
    main()

"""Make the IR of the native entries anew: it comes with bfsim, so that nobody else needs numba.

    python -m benchmarks.keep_native

It takes half a minute, and writes to `bfsim/kernel/native/kept`; what is there and no longer used is removed. After a change
of a function with `@native` or `@native_entry`, or of a number that one uses, it must be run again, or every cold start
takes that half minute.
"""

from __future__ import annotations

import argparse
import zlib
from pathlib import Path

from bfsim.files.store import KEPT
from bfsim.kernel import native
from bfsim.kernel.calls.traced_access import trace_access
from bfsim.machine.bus.tape import note, note_access, note_run
from bfsim.machine.bus.tape_lines import note_copy, note_fetch, note_program, note_row, note_send, note_wait
from bfsim.machine.bus.weave import advance
from bfsim.machine.calls.code_fetches import fetch_lines, fetch_singly
from bfsim.machine.calls.conflicts import charge_conflicts, count_events
from bfsim.machine.calls.ledger import charge_events, charge_sites
from bfsim.machine.calls.ready_calls import find_call
from bfsim.machine.retiming.laid_dictionaries import lay_dictionaries
from bfsim.machine.retiming.left_stage import end_stretch, leave_stage
from bfsim.machine.retiming.passed_mark import pass_mark
from bfsim.machine.retiming.written_stretch import write_stretch

FOLDER = Path(native.__file__).parent / KEPT
ENTRIES = (
    trace_access,
    advance,
    note,
    note_run,
    note_access,
    note_program,
    note_copy,
    note_wait,
    note_fetch,
    note_row,
    note_send,
    find_call,
    fetch_lines,
    fetch_singly,
    count_events,
    charge_conflicts,
    charge_events,
    charge_sites,
    write_stretch,
    lay_dictionaries,
    pass_mark,
    end_stretch,
    leave_stage,
)


def main() -> None:
    """Make and write what is not there."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    wanted = {each.digest(): each for each in ENTRIES}
    for old in {each.name for each in FOLDER.iterdir()} - wanted.keys():
        (FOLDER / old).unlink()
    for name, each in wanted.items():
        if not (FOLDER / name).exists():
            (FOLDER / name).write_bytes(zlib.compress(each.ir().encode(), 9))
        print(f"{name[:12]}  {(FOLDER / name).stat().st_size:7,} bytes  {each.symbol}")


if __name__ == "__main__":
    main()

"""The door of the command line: the installed script `bfsim`, and `python -m bfsim`.

Imports next to nothing, so that Ctrl-C finds somebody at home before the command line is there to hear it.
"""

from __future__ import annotations

import os
import signal
import sys


def main() -> None:
    """Call the command line."""
    # A stream that the shell closed (`>&-`) is None; what nobody wants to read goes nowhere.
    sys.stdout = sys.stdout or os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
    sys.stderr = sys.stderr or os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
    hear = signal.getsignal(signal.SIGINT)
    if hear is signal.default_int_handler:  # otherwise Ctrl-C is ignored: in the background of a shell
        signal.signal(signal.SIGINT, _leave)
    from bfsim.process.garbage import collect_no_more, collect_rarely
    from bfsim.process.signals import hear_signals, interrupted_code

    collect_rarely()
    # numpy's library has a thread for each processor otherwise, a quarter of its start; nothing here multiplies large matrices
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    from bfsim.cli.main import main as command
    from bfsim.process.endings import fault

    try:
        signal.signal(signal.SIGINT, hear)
        hear_signals()
        command(prog_name="bfsim")
    except KeyboardInterrupt:  # a moment before the command hears it, or behind its end
        sys.stderr.write("bfsim: interrupted\n")
        sys.exit(interrupted_code())
    except Exception:  # noqa: BLE001 - whatever comes as far as this
        sys.exit(fault())
    finally:
        collect_no_more()


def _leave(number: int, _frame: object) -> None:
    """End at once: nothing is begun yet that must be tidied up, and an import is no place to raise from."""
    sys.stderr.write("bfsim: interrupted\n")
    sys.stderr.flush()
    os._exit(128 + number)  # as `process.signals` has it, which is not imported yet


if __name__ == "__main__":
    main()

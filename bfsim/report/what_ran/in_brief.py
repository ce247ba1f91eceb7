"""What ran on what, in a few lines at the end of a screen. `configuration` has everything."""

from __future__ import annotations

from collections.abc import Iterator

from bfsim.report.what_ran.code import TRUST, code_in_words
from bfsim.report.what_ran.digest import cycle_digest, identity_digest
from bfsim.report.wording.units import mhz
from bfsim.trace import DIGITS_SHOWN, RunRecord


def what_ran(run: RunRecord) -> Iterator[tuple[str, str]]:
    """Yield whose code ran, the names of what ran, where to find the errors, and the digests of inputs and cycles."""
    identity = run.identity
    compiler = identity.compiler
    if run.object_share == 1:
        compiler += f" ({code_in_words(run)})"
    elif code := code_in_words(run):
        yield "Code", code
    size = f"{identity.width_px}x{identity.height_px}"
    board = f"{identity.board} ({mhz(identity.cclk_hz)}, SCLK {mhz(identity.sclk_hz)})"
    extras = [identity.ldf, compiler, f"feed {identity.feed}"]
    if identity.fidelity != "fast":
        extras.append(f"fidelity {identity.fidelity}")
    yield "Run", f"{identity.recording} {size}, {identity.firmware}, {board}, {', '.join(extras)}"
    yield TRUST
    digests = identity_digest(identity), cycle_digest(run.frames)
    yield "Digests", "identity {}, cycles {}".format(*(each[:DIGITS_SHOWN] for each in digests))

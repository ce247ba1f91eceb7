"""The page of a run: its watchers during the run, and writing it afterwards."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from bfsim import shipped
from bfsim.errors import ConfigError
from bfsim.files.outputs import PAGE, require_own
from bfsim.files.save import require_apart, require_place, write_text
from bfsim.loading.firmware import load_firmware
from bfsim.machine.program import Firmware
from bfsim.mapping import map_memory
from bfsim.recording import RecordingReader
from bfsim.report.budget.target import Target
from bfsim.report.heat.frames import HeatedFrames, stages_of
from bfsim.report.html.chosen import Chosen
from bfsim.report.html.frames import MOST
from bfsim.report.html.gantt import Gantts
from bfsim.report.html.pictures import Pictures
from bfsim.report.ldf.map import MemoryMap
from bfsim.report.what_ran.digest import cycle_digest
from bfsim.running.inputs import calibration_of, files_of_run
from bfsim.running.watchers import Watchers, calling
from bfsim.trace import DIGITS_SHOWN, BudgetRow, Identity, RunRecord

_PACKAGES = ("altair", "jinja2", "markdown_it", "vl_convert")


def require_page(path: Path, others: Iterable[Path | None]) -> None:
    """Raise ConfigError unless a page can be written to `path`, not one of the `others`, with the packages installed."""
    require_place(path)
    require_apart(path, others)
    require_own(path, PAGE)
    missing = [each for each in _PACKAGES if find_spec(each) is None]
    if missing:
        raise ConfigError(
            f'an HTML page needs the package {missing[0]}; install all that it needs with: pip install "bfsim[html]"'
        )


@contextmanager
def paged(watchers: Watchers, path: Path, target: Target | None, what: Mapping[str, Any]) -> Iterator[None]:
    """Have `watchers` write to `path` a page of the run that `what`, arguments of `simulate`, describes."""
    chosen = Chosen()
    with Pictures() as pictures, Gantts(chosen.has) as gantts:
        heats = HeatedFrames(stages_of(_rows(what["firmware"])), [pictures.add_with_heat], chosen.has)

        def make_room(_identity: Identity, frames: int) -> None:
            pictures.make_room(min(frames, MOST))

        watchers.before.extend((make_room, chosen.begin, gantts.begin, heats.begin))
        watchers.seen.append(heats.add)
        watchers.spans.extend((chosen.add, gantts.add, heats.add_spans))  # in this order
        watchers.done.append(partial(_write, path, target, chosen, pictures, gantts, what))
        yield


def write_page(run: RunRecord, again: partial[Any], path: Path, target: Target | None) -> None:
    """Write the page of a finished run; `again` makes the run once more, to show what was seen and when.

    Raises ConfigError as `require_page` does, and if the repeated run differs.
    """
    require_page(path, files_of_run(again.keywords))
    watchers = Watchers()
    with paged(watchers, path, target, again.keywords):
        before, on_seen, on_spans = (
            calling(each) for each in (watchers.before, watchers.seen, watchers.spans)
        )
        done = again(before=before, on_seen=on_seen, on_spans=on_spans)
        now, then = (cycle_digest(each.frames) for each in (done, run))
        if now != then:
            raise ConfigError(
                "firmware, recording and LDF must be as they were in the run, for its page repeats it: the digest of its cycles "
                f"is now {now[:DIGITS_SHOWN]}, not {then[:DIGITS_SHOWN]}"
            )
        for each in watchers.done:
            each(done)


def _rows(firmware: Firmware | str) -> tuple[BudgetRow, ...]:
    return firmware.rows if isinstance(firmware, Firmware) else load_firmware(firmware).firmware.rows


def _write(
    path: Path,
    target: Target | None,
    chosen: Chosen,
    pictures: Pictures,
    gantts: Gantts,
    what: Mapping[str, Any],
    run: RunRecord,
) -> None:
    from bfsim.report.html.page import Page  # its packages are an extra

    gantts.finish()
    pictures.finish()
    page = Page(
        run=run,
        pictures=pictures,
        gantts=gantts,
        accuracy=shipped.accuracy_on("In short"),
        unmodelled=shipped.accuracy_on("What is not modelled"),
        memory_map=_map_of(run, what),
        frames=chosen.frames,
        target=target,
    )
    write_text(path, page.chunks())


def _map_of(run: RunRecord, what: Mapping[str, Any]) -> MemoryMap:
    """Return where everything lay in a run."""
    with RecordingReader(what["recording"] or shipped.RECORDING) as reader:
        calibration = calibration_of(reader)
    given = ("firmware", "board", "settings", "profile", "defines", "include_dirs")
    return map_memory(
        what["ldf"],
        **{name: what[name] for name in given},
        width_px=run.identity.width_px,
        height_px=run.identity.height_px,
        calibration=calibration,
    )

"""Pages of runs made by hand."""

from __future__ import annotations

from bfsim.report.budget.target import Target
from bfsim.report.html.gantt import Gantts
from bfsim.report.html.page import Page
from bfsim.report.html.pictures import Pictures
from bfsim.trace import RunRecord
from tests.report.ldf_maps import a_map, a_segment


def page_of(
    run: RunRecord, pictures: Pictures, target: Target | None = None, gantts: Gantts | None = None
) -> str:
    """The page of a run with an empty memory."""
    with gantts or Gantts() as drawn:
        page = Page(
            run=run,
            pictures=pictures,
            gantts=drawn,
            accuracy="- **Good**: as far as it goes.",
            unmodelled="- The rest.",
            memory_map=a_map(a_segment("L2")),
            frames=len(run.frames),
            target=target,
        )
        return "".join(page.chunks())

"""Cycles by kind: work, each reason of a stall, idling; and their owners."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from rich.table import Table

from bfsim.report.profile.view import View
from bfsim.report.tables.table import new_table
from bfsim.report.wording.units import others_row

OWNERS_TOLD = 3
WORK, IDLE = "work", "idle"


def reasons_of(view: View) -> dict[str, Counter[tuple[str, str]]]:
    """Return the cycles of each kind by stage and owner: work, the reasons of stalls, idle."""
    found: dict[str, Counter[tuple[str, str]]] = {}
    for stage in view.profile.stages:
        for owner in stage.owners:
            kinds = {WORK: owner.cost.issue_cclk, IDLE: owner.cost.idle_cclk}
            kinds |= {reason.value: cclk for reason, cclk in owner.cost.stall_cclk.items()}
            for kind, cclk in kinds.items():
                if cclk:
                    found.setdefault(kind, Counter())[stage.stage, owner.owner] += cclk
    return found


def reason_tables(view: View) -> Iterator[Table]:
    """Yield one row for each kind of cycles, and below it the owners that have most of it."""
    table = new_table(view.title("reason"), "Reason / owner", "Stage", "ms", "%")
    table.columns[1].justify = "left"
    for kind, owners in sorted(reasons_of(view).items(), key=lambda each: -each[1].total()):
        table.add_row(kind, "", view.ms(owners.total()), view.share(owners.total()), style="bold")
        dearest = owners.most_common(OWNERS_TOLD)
        for (stage, owner), cclk in dearest:
            table.add_row(f"  {owner}", stage, view.ms(cclk), view.share(cclk))
        rest = owners.total() - sum(cclk for _, cclk in dearest)
        if rest:
            table.add_row(f"  {others_row(len(owners) - len(dearest))}", "", view.ms(rest), view.share(rest))
    table.add_section()
    cclk = view.profile.cost.elapsed_cclk
    table.add_row(view.all, "", view.ms(cclk), view.share(cclk), style="bold")
    yield table

"""A run whose every name is made to do harm in a page, and the elements that a page has."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser

from bfsim.trace import REST, LineCost, RunRecord, RunWarning, StallReason, WarningKind
from tests.report.records import access, buffer, core_frame, cost, frame, kernel, run_of, traffic

EVIL = "<script>pwned=1</script><img src=x onerror=pwned=1>'\"&{{7*7}}"


class Elements(HTMLParser):
    """Counts the elements of a page, and keeps its words."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: list[str] = []
        self.addresses: list[str] = []
        self.words = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in {"src", "href", "srcset", "data"}]

    def handle_data(self, data: str) -> None:
        self.words += data


def evil_run() -> RunRecord:
    """A run in which everything that has a name has an evil one."""
    run = run_of(
        [
            replace(
                frame(0, core_frame("A", 0, cost(EVIL, 5, {StallReason.SEMAPHORE: 3}), cost(REST, 1))),
                results={EVIL: 3},
                remarks=(EVIL,),
            )
        ],
        missed=(3,),
    )
    names = dict.fromkeys(("recording", "firmware", "board", "ldf", "compiler", "bfsim_version"), EVIL)
    return replace(
        run,
        identity=replace(run.identity, **names),
        firmware_place=EVIL,
        ldf_place=EVIL,
        geometry=EVIL,
        device_notes={"SPI": (EVIL,)},
        assumptions=(RunWarning(kind=WarningKind.GEOMETRY, text=EVIL),),
        reference=replace(run.reference, name=EVIL, about=EVIL),
        kernels=(kernel(EVIL, EVIL, LineCost(line=10, executions=1, issue_cclk=1, stall_cclk={}), text=(EVIL,), file=EVIL),),
        buffers=(buffer(EVIL, EVIL),),
        accesses=(access(EVIL, EVIL, EVIL, 3, 4),),
        traffic=(replace(traffic(EVIL, EVIL, 5), buffer=EVIL),),
        interrupts={EVIL: 2},
    )  # fmt: skip

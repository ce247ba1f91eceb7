"""The system: synchronisation, interrupts, caches."""

from bfsim.blackfin.instructions.form import Beside, Form

CACHE = ("PREFETCH", "FLUSHINV", "FLUSH", "IFLUSH")

FORMS = (
    Form("nothing", "0000 0000 0000 0000", "NOP", beside=Beside.EITHER),
    Form("nothing", "1100 -000 0000 0011 0001 1000 0000 0000", "MNOP", beside=Beside.DSP),
    Form("return_from_interrupt", "0000 0000 0001 0001", "RTI"),
    Form("return_from_exception", "0000 0000 0001 0010", "RTX"),
    Form("return_from_nmi", "0000 0000 0001 0011", "RTN"),
    Form("return_from_emulation", "0000 0000 0001 0100", "RTE"),
    Form("idle", "0000 0000 0010 0000", "IDLE"),
    Form("core_synchronise", "0000 0000 0010 0011", "CSYNC"),
    Form("system_synchronise", "0000 0000 0010 0100", "SSYNC"),
    Form("emulation_exception", "0000 0000 0010 0101", "EMUEXCPT"),
    Form("disable_interrupts", "0000 0000 0011 0ddd", "CLI {d:R}"),
    Form("enable_interrupts", "0000 0000 0100 0ddd", "STI {d:R}"),
    Form("raise_interrupt", "0000 0000 1001 nnnn", "RAISE {n:count}"),
    Form("exception", "0000 0000 1010 nnnn", "EXCPT {n:count}"),
    Form("test_and_set", "0000 0000 1011 0ppp", "TESTSET ({p:P})", only=lambda p: p not in {"SP", "FP"}),
    *(
        Form("cache", f"0000 0010 010{number:02b}ppp", f"{name}[{{p:P}}]")
        for number, name in enumerate(CACHE)
    ),
    *(
        Form("cache", f"0000 0010 011{number:02b}ppp", f"{name}[{{p:P}}++]", {"step": 32})
        for number, name in enumerate(CACHE)
    ),
)

"""The rooms of the house: who may import whom, from the bottom to the top."""

from __future__ import annotations


def _sets(table: dict[str, str]) -> dict[str, set[str]]:
    """Return a table with its words as sets."""
    return {room: set(words.split()) for room, words in table.items()}


MAY_IMPORT = _sets(
    {
        "errors": "",
        "process": "errors",
        "files": "errors",
        "clocks": "errors",
        "trace": "",
        "seen": "",
        "spans": "trace",
        "shipped": "",
        "fields": "errors",
        "chip": "errors clocks fields",
        "machine_code": "files",
        "blackfin": "errors files machine_code",
        "kernel": "errors files machine_code blackfin",
        "compiling": "errors files blackfin kernel",
        "linker": "errors files chip",
        "machine": "errors process clocks trace seen spans chip machine_code kernel linker",
        "api": "errors trace seen chip kernel compiling machine",
        "recording": "errors process files seen",
        "report": "errors files trace seen spans chip linker",  # the last two hold data: memories, a link
        "loading": "errors process files shipped fields chip kernel machine recording",
        "running": (
            "errors process files trace seen spans shipped fields chip kernel compiling linker machine recording loading"
        ),
        "mapping": "chip linker machine report loading running",
        "run_page": "errors files trace shipped machine recording report loading running mapping",
        "result": "errors trace spans report run_page",
        "explain": "errors trace kernel loading running",
        "assembly": "errors trace blackfin kernel compiling machine loading",
        "colouring": "errors seen machine recording loading running",
        "exporting": "errors files kernel loading",
        "verifying": "trace kernel compiling machine",
        "placing": "errors trace shipped chip linker machine recording report loading running",
        "run": (
            "errors process trace seen spans shipped chip kernel linker machine recording loading running result"
        ),
        "planning": "trace running run",
        "checking": "errors shipped report loading running run planning",
        "pytest_plugin": "errors seen machine report result run checking",
        "sweeping": (
            "errors process files trace shipped fields machine_code report loading running result run planning checking"
        ),
        "cli": (
            "errors process files trace seen spans shipped fields chip compiling recording report "
            "loading running mapping run_page explain assembly colouring exporting verifying "
            "placing run checking sweeping"
        ),
        "__main__": "process cli",
    }
)
"""Each room and what it may import of bfsim besides itself, from the bottom of the house to the top."""


MACHINE = _sets(
    {
        "firmware_lines": "",
        "timeline": "",
        "simulation": "timeline",
        "buffers": "",
        "program": "buffers peripherals core",  # the types of what a main loop gets, and of the devices
        "memories": "buffers",
        "pages": "",
        "named_kernels": "",
        "code": "program memories named_kernels",
        "stack": "memories",
        "bus": "timeline simulation memories pages",
        "calls": "memories pages bus",
        "detailed": "simulation memories bus",
        "cameras": "timeline simulation buffers memories bus",
        "peripherals": "firmware_lines simulation program memories bus",
        "dma": "firmware_lines simulation memories bus core",  # core: the type of what a ring waits for
        "retiming": "buffers memories bus calls cameras dma core",
        "core": ("firmware_lines timeline simulation buffers memories bus calls cameras peripherals dma"),
        "symbols": "firmware_lines buffers program code",
        "loader": "buffers program memories bus cameras symbols",
        "main_loop": "firmware_lines program core",
        "finished_frames": "calls main_loop",
        "listeners": "timeline simulation bus finished_frames",
        "main_loops": "firmware_lines simulation core main_loop listeners",
    }
)
"""Each block of the machine and what it may import of the others. The board wires them: it imports them all."""


CORE = _sets(
    {
        "interrupts": "",
        "waits": "",
        "clock": "",
        "progress": "interrupts waits clock",
        "stages": "clock progress",
        "messages": "waits progress",
        "synchronisation": "interrupts waits progress",
        "tasks": "waits progress synchronisation",
        "buffers": "progress",
        "pictures": "waits progress tasks buffers",
        "parts": "clock progress stages messages synchronisation tasks buffers pictures",
        "core": "interrupts waits tasks pictures parts",
        "wiring": "waits clock progress stages messages synchronisation tasks buffers pictures parts",
    }
)
"""Each part of `machine/core` and what it imports of the others, from the bottom to the top."""


BLACKFIN = _sets(
    {
        "elf": "",
        "instructions": "",
        "control_flow": "elf instructions",
        "timing": "elf instructions control_flow",
        "translation": "instructions control_flow timing",
        "execution": "elf instructions control_flow timing translation",
    }
)
"""Each part of the Blackfin and what it imports of the others, from the bottom to the top."""


KERNEL = _sets(
    {
        "keys": "",
        "operations": "",
        "rules": "",
        "types": "",
        "intrinsics": "operations types",
        "native": "keys",
        "profile": "operations rules",
        "ir": "intrinsics profile",
        "language": "keys types intrinsics",
        "c": "types intrinsics language",
        "calls": "types native language",
        "costs": "operations ir",
        "emitting": "types intrinsics ir language",
        "function_keys": "keys profile language",
        "estimate": "operations rules types intrinsics profile ir language costs emitting function_keys",
        "objects": "keys operations types profile ir language c calls costs",
        "host_code": "types intrinsics profile ir language calls costs emitting function_keys estimate",
        "decorator": "profile language calls costs estimate objects host_code",
        "build": "profile language costs objects host_code decorator",
    }
)
"""Each part of the kernel and what it imports of the others, from the bottom to the top."""


ESTIMATE = _sets(
    {
        "choices": "",
        "conditions": "",
        "loops": "",
        "arithmetic": "loops",
        "memory": "choices loops",
        "ranges": "arithmetic",
        "switches": "conditions ranges",
        "unoptimised": "arithmetic",
        "induction_variables": "loops ranges",
        "jump_threading": "choices conditions loops switches ranges induction_variables",
        "prediction": "loops ranges",
        "inlining": "arithmetic ranges prediction",
        "redundancies": "choices conditions loops prediction",
        "loop_copies": "conditions loops arithmetic memory jump_threading prediction inlining",
        "selection": (
            "choices conditions loops arithmetic memory ranges switches induction_variables jump_threading "
            "prediction redundancies"
        ),
        "registers": "arithmetic memory induction_variables selection",
        "rewrites": (
            "choices conditions loops arithmetic memory switches induction_variables jump_threading redundancies "
            "loop_copies"
        ),
        "layout": "conditions loops switches prediction selection registers",
        "scheduling": "selection registers",
        "optimised": "selection registers layout scheduling",
        "costing": "switches unoptimised jump_threading inlining loop_copies rewrites optimised",
        "estimated": "costing",
    }
)
"""Each part of `kernel/estimate` and what it imports of the others, from the bottom to the top."""


REPORT = _sets(
    {
        "wording": "",
        "jsonable": "",
        "budget": "",
        "tables": "budget",
        "what_ran": "wording budget",
        "run": "budget tables what_ran",
        "profile": "wording jsonable budget tables what_ran run",
        "columns": "budget profile",
        "results": "jsonable budget what_ran run",
        "diff": "wording jsonable budget tables profile results",
        "check": "wording jsonable budget tables run results diff",
        "sweep": "wording budget tables results check",
        "kernels": "wording jsonable tables",
        "boards": "tables",
        "ldf": "wording jsonable tables",
        "viewers": "budget run",
        "heat": "",
        "overlay": "wording",
        "colours": "jsonable tables overlay",
        "html": "wording budget what_ran run profile diff ldf overlay",
    }
)
"""Each part of the reports and what it imports of the others, from the bottom to the top."""


READ_VERSION = {"recording", "report", "running", "cli"}
"""These also read `bfsim.__version__`."""

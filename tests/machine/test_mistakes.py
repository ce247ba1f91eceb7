"""Mistakes in firmware: each ends the run with a message that names the line of the firmware."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bfsim.api import CameraSettings, Core, Frame
from bfsim.errors import BfsimError, ConfigError, FirmwareError, KernelError
from bfsim.files.save import writing
from tests.machine.kernels import copy, first, spin, total
from tests.machine.rig import Play, every_frame, run, see_all


def work_in_the_dark(core: Core, frame: Frame) -> Play:
    """Forget one `yield`, after which other work comes."""
    core.run(spin, 10)
    yield core.run(spin, 10)


def last_work_in_the_dark(core: Core, frame: Frame) -> Play:
    """Forget the last `yield` of a frame."""
    yield core.run(spin, 10)
    core.run(spin, 10)


def work_twice(core: Core, frame: Frame) -> Play:
    """Charge the same work twice."""
    work = core.run(spin, 10)
    yield work
    yield work


def an_array_of_its_own(core: Core, frame: Frame) -> Play:
    """Call a kernel with memory that no linker placed."""
    yield core.run(first, np.zeros(4, np.uint8))  # type: ignore[arg-type]


def the_array_of_a_row(core: Core, frame: Frame) -> Play:
    """Call a kernel as `kernel(row.array)` is called in a test."""
    yield core.run(first, frame.rows[0].array)  # type: ignore[arg-type]


def a_kernel_as_a_function(core: Core, frame: Frame) -> Play:
    """Forget the core: the call would cost no cycles."""
    core.publish(first=first(frame.rows[0].array))
    yield core.run(spin, 1)


def a_kernel_of_rows_as_a_function(core: Core, frame: Frame) -> Play:
    """Forget the core, and give what only a core takes."""
    yield first(frame.rows[0])


def a_list_of_rows(core: Core, frame: Frame) -> Play:
    """Call a kernel with many rows where it takes one."""
    yield core.run(first, list(frame.rows))  # type: ignore[arg-type]


def unknown_buffer(core: Core, frame: Frame) -> Play:
    """Mistype a buffer."""
    yield core.run(first, core.array("camara"))


def array_of_many_rows(core: Core, frame: Frame) -> Play:
    """Take a buffer of many rows for one row."""
    yield core.run(first, core.array("image"))


def one_argument_too_few(core: Core, frame: Frame) -> Play:
    """Forget an argument."""
    yield core.run(copy, frame.rows[0])


def an_argument_by_name(core: Core, frame: Frame) -> Play:
    """Call a kernel as a function of Python."""
    yield core.run(copy, frame.rows[0], out=core.rows("image")[0])  # type: ignore[call-arg]


def wrong_elements(core: Core, frame: Frame) -> Play:
    """Give bytes to a kernel that wants 32-bit integers."""
    yield core.run(total, frame.rows[0])


def a_number(core: Core, frame: Frame) -> Play:
    """Yield what is no work."""
    yield 42


def unknown_stage(core: Core, frame: Frame) -> Play:
    """Mistype a stage."""
    with core.stage("Wrok"):
        yield core.run(spin, 1)


def gone_line(core: Core, frame: Frame) -> Play:
    """Use a line of a ring that is not there yet."""
    ring = core.input_ring(frame.rows, "in_ring")
    yield core.run(first, ring[0])


def division(core: Core, frame: Frame) -> Play:
    """Make an ordinary mistake in Python."""
    yield core.run(spin, 1 // frame.index)


def no_method(core: Core, frame: Frame) -> Play:
    """Ask the core for what it has by another name."""
    yield core.run(first, core.arrray("in_ring"))  # type: ignore[attr-defined]


def what_is_no_exception(core: Core, frame: Frame) -> Play:
    """Raise what Python's own `except Exception` lets through, as outcomes of pytest and cancelled tasks are."""
    yield core.run(spin, 1)
    raise GeneratorExit("done")


def float_result(core: Core, frame: Frame) -> Play:
    """Publish what is no integer."""
    core.publish(share=0.5)
    yield core.run(spin, 1)


def number_without_end(core: Core, frame: Frame) -> Play:
    """Publish what no file of numbers has room for."""
    core.publish(share=1 << 63)
    yield core.run(spin, 1)


def result_of_two_words(core: Core, frame: Frame) -> Play:
    """Publish under what is no name."""
    core.publish(**{"red\npixels": 1})
    yield core.run(spin, 1)


def ring_of_a_name(core: Core, frame: Frame) -> Play:
    """Take the arguments of an output ring for those of an input ring."""
    core.input_ring("image", "in_ring")
    yield core.run(spin, 1)


def ring_the_other_way_round(core: Core, frame: Frame) -> Play:
    """Take the arguments of an input ring for those of an output ring."""
    core.output_ring(core.rows("image"), "out_ring")  # type: ignore[arg-type]
    yield core.run(spin, 1)


def ring_without_rows(core: Core, frame: Frame) -> Play:
    """Give it an empty list."""
    core.input_ring(frame.rows, [])
    yield core.run(spin, 1)


def settings_in_a_dict(core: Core, frame: Frame) -> Play:
    """Forget the class."""
    core.set_camera({"gain": 16})  # type: ignore[arg-type]
    yield core.run(spin, 1)


def gain_without_end(core: Core, frame: Frame) -> Play:
    """Give a register more than it holds."""
    core.set_camera(CameraSettings(exposure_lines=200, gain=256, red_gain=128, blue_gain=128))
    yield core.run(spin, 1)


def end_of_all(core: Core, frame: Frame) -> Play:
    """End Python, which would pass for success."""
    yield core.run(spin, 1)
    raise SystemExit(0)


def no_kernel(core: Core, frame: Frame) -> Play:
    """Forget the decorator."""
    yield core.run(division, frame)  # type: ignore[arg-type]


def sum_of_a_call(core: Core, frame: Frame) -> Play:
    """Use a call for its value."""
    yield core.run(spin, 10) + 1  # type: ignore[operator]


def condition_of_a_call(core: Core, frame: Frame) -> Play:
    """Ask for its truth, which would always hold."""
    if core.run(spin, 10):
        yield core.run(spin, 10)


def attribute_of_a_call(core: Core, frame: Frame) -> Play:
    """Take it for an int."""
    yield core.run(spin, 10).bit_length()  # type: ignore[attr-defined]


def published_call(core: Core, frame: Frame) -> Play:
    """Publish the call and not its value."""
    core.publish(spun=core.run(spin, 10))  # type: ignore[arg-type]
    yield core.run(spin, 10)


def call_as_a_wait(core: Core, frame: Frame) -> Play:
    """Write `yield from` where `yield` is meant."""
    yield from core.run(spin, 10)  # type: ignore[misc]


def wait_as_a_call(core: Core, frame: Frame) -> Play:
    """Write `yield` where `yield from` is meant."""
    lines = core.input_ring(frame.rows, "in_ring")
    yield lines.line()


def wait_for_a_row(core: Core, frame: Frame) -> Play:
    """Write neither."""
    lines = core.input_ring(frame.rows, "in_ring")
    yield core.run(first, lines.line())  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("body", "kind", "message", "line"),
    [
        (sum_of_a_call, FirmwareError, r"core\.run.* write `yield core\.run\(\.\.\.\)`, in parentheses", 2),
        (condition_of_a_call, FirmwareError, r"core\.run.* write `yield core\.run\(\.\.\.\)`, in parent", 2),
        (attribute_of_a_call, FirmwareError, r"core A: core\.run.* write `yield core.*AttributeError", 2),
        (published_call, FirmwareError, r"core\.run\(\.\.\.\) gives its value when it is yielded", 2),
        (call_as_a_wait, FirmwareError, r"write `yield core\.run\(\.\.\.\)`, not `yield from core\.run", 2),
        (wait_as_a_call, FirmwareError, r"must be written `yield from line\(\.\.\.\)`, not `yield line", 3),
        (wait_for_a_row, FirmwareError, r"first must get what a wait gives, `\(yield from line\(", 3),
        (no_kernel, FirmwareError, "core.run must get a function with @kernel before it, not division", 2),
        (
            work_in_the_dark,
            FirmwareError,
            r"core A: core\.run\(\.\.\.\) must be yielded, or its cycles are lost",
            3,
        ),
        (work_twice, FirmwareError, r"core A: firmware must yield each core\.run\(\.\.\.\) once", 4),
        (
            an_array_of_its_own,
            KernelError,
            "a row of a placed buffer, not an array: pass the row, not its",
            2,
        ),
        (the_array_of_a_row, KernelError, "source must be a row of a placed buffer, not an array: pass", 2),
        (a_kernel_as_a_function, FirmwareError, r"or it costs no cycles: write `yield core\.run\(first, ", 2),
        (
            a_kernel_of_rows_as_a_function,
            FirmwareError,
            "kernel first must be run by the core, or it costs",
            2,
        ),
        (a_list_of_rows, KernelError, r"source must be a row of a placed buffer, not \[<row of camera", 2),
        (a_number, FirmwareError, "or `yield from` a wait, not 42", 2),
        (one_argument_too_few, KernelError, r"copy must get source, out, not 1 argument \(", 2),
        (
            an_argument_by_name,
            FirmwareError,
            "TypeError: core.run.kernel, .... takes the kernel and its arguments in their order, without names",
            2,
        ),
        (wrong_elements, KernelError, "source must be one contiguous row of int32, not uint8", 2),
        (unknown_buffer, FirmwareError, "core A has no buffer 'camara'; it has camera, image, in_l2", 2),
        (array_of_many_rows, FirmwareError, r"buffer image has 8 rows; use core\.rows\('image'\)", 2),
        (unknown_stage, FirmwareError, "stage must be one of Work, More work, not 'Wrok'", 2),
        (gone_line, FirmwareError, "line 0 is not in ring in_ring, .* none of whose lines was taken yet", 3),
        (division, FirmwareError, "core A: firmware failed with ZeroDivisionError: .*division", 2),
        (
            no_method,
            FirmwareError,
            "AttributeError: 'Core' object has no attribute 'arrray'; near it are array",
            2,
        ),
        (end_of_all, FirmwareError, "core A: firmware failed with SystemExit: 0", 3),
        (what_is_no_exception, FirmwareError, "core A: firmware failed with GeneratorExit: done", 3),
        (
            ring_of_a_name,
            FirmwareError,
            r"core\.input_ring\(rows, ring\) must get the rows of a picture, ",
            2,
        ),
        (ring_the_other_way_round, FirmwareError, r"core\.output_ring\(ring, rows\) must get the rows of", 2),
        (ring_without_rows, FirmwareError, "a ring needs at least 2 rows, not none", 2),
        (settings_in_a_dict, FirmwareError, "must get a bfsim.api.CameraSettings, not {'gain': 16}", 2),
        (gain_without_end, FirmwareError, "gain must be 0 to 255, not 256", 2),
        (float_result, FirmwareError, "core A: the result share must be an integer, not 0.5; ", 2),
        (
            number_without_end,
            FirmwareError,
            "the result share must fit in 64 bits, not 9223372036854775808",
            2,
        ),
        (result_of_two_words, FirmwareError, r"a result must have a name such as .*, not 'red\\npixels'", 2),
    ],
)
def test_the_message_ends_with_the_line_of_the_mistake(
    body: Any, kind: type[BfsimError], message: str, line: int
) -> None:
    """What is wrong first, then file and line: of the innermost firmware, not of bfsim or a main loop around it."""
    with pytest.raises(kind, match=message) as caught:
        run(every_frame(body))
    assert str(caught.value).endswith(f" ({__file__}:{body.__code__.co_firstlineno + line})")


@pytest.mark.parametrize("is_a_generator", [False, True])
@pytest.mark.parametrize(("mistake", "message"), [(division, "ZeroDivisionError"), (first, "no cycles")])
def test_a_mistake_in_a_handler_is_told_with_its_line(
    mistake: Any, message: str, is_a_generator: bool
) -> None:
    """One that does all at once ended in a traceback."""

    def handler(core: Core) -> None:
        first(core.array("single_row").array) if mistake is first else 1 // 0

    def waiting_handler(core: Core) -> Play:
        yield core.run(spin, 1)
        handler(core)

    def body(core: Core, frame: Frame) -> Play:
        core.on_interrupt("TIMER0", waiting_handler if is_a_generator else handler)
        core.request_interrupt("TIMER0")
        yield core.run(spin, 10)

    with pytest.raises(FirmwareError, match=message) as caught:
        run(every_frame(body))
    assert str(caught.value).endswith(f" ({__file__}:{handler.__code__.co_firstlineno + 1})")


def test_the_last_work_of_a_frame_must_be_yielded_as_well() -> None:
    """Nothing comes after it in the frame, so it is found when the next one is asked for."""
    with pytest.raises(FirmwareError, match=r"core\.run\(\.\.\.\) must be yielded"):
        run(every_frame(last_work_in_the_dark))


def test_the_last_work_of_all_must_be_yielded_as_well() -> None:
    """Nothing comes after it at all."""

    def main(core: Core) -> Play:
        yield from see_all(core)
        core.run(spin, 10)

    with pytest.raises(FirmwareError, match=r"core\.run\(\.\.\.\) must be yielded"):
        run(main)


@pytest.mark.parametrize("what", [lambda row: row[:4], lambda row: row[0], list])
def test_a_row_is_not_taken_apart_by_a_main_loop(what: Callable[[Any], object]) -> None:
    """It was a TypeError, which does not say how a kernel gets a part of a row."""

    def look(core: Core, frame: Frame) -> Play:
        yield core.run(first, core.rows("single_row")[0])
        what(core.rows("single_row")[0])

    message = r"a row of single_row must be handed to kernels whole, or as a part of it, .*core.part\(.*\(.*test_mistakes.py:\d+\)$"
    with pytest.raises(FirmwareError, match=message):
        run(every_frame(look))


def test_a_row_is_not_written_by_a_main_loop() -> None:
    """It was a TypeError, which does not say what writes rows."""

    def look(core: Core, frame: Frame) -> Play:
        yield core.run(first, core.rows("single_row")[0])
        core.rows("single_row")[0][:] = core.rows("single_row")[0]  # type: ignore[index]

    message = r"a row of single_row must be written by a kernel, .*\(.*test_mistakes.py:\d+\)$"
    with pytest.raises(FirmwareError, match=message):
        run(every_frame(look))


def test_a_full_disk_is_no_mistake_of_the_firmware() -> None:
    """What is recorded is written while a main loop runs: the line that ran was told as if it had failed."""

    def look(core: Core, frame: Frame) -> Play:
        yield core.run(first, core.rows("single_row")[0])
        with writing(Path("run.work")):
            raise OSError(28, "No space left on device")

    with pytest.raises(ConfigError, match=r"^run\.work must be writable: No space left on device$"):
        run(every_frame(look))

"""What a run assumes or doubts: the geometry, the cameras, the clocks, and tables that may not fit into L1."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from bfsim.chip.spec import BoardSpec
from bfsim.kernel import Kernel
from bfsim.linker import LinkMap
from bfsim.machine.program import Calibration, Firmware
from bfsim.trace import RunWarning, WarningKind


def geometry_in_words(program: Firmware, calibration: Calibration) -> str:
    """Return the geometry that the firmware computes with, in words; "" for firmware that takes none."""
    if program.calibration is not None:
        for each in calibration.geometries:
            return f"{each} (of the recording)"
    return f"assumed: {program.assumed_geometry}" if program.assumed_geometry else ""


def assumed_geometry(program: Firmware, calibration: Calibration) -> Iterator[RunWarning]:
    """Yield a warning if the firmware has to assume where the cameras are, or their height or tilt."""
    if not program.assumed_geometry:
        return
    for each in calibration.geometries:
        stance = {"height": each.height_mm, "tilt": each.tilt_deg}
        unknown = " and ".join(name for name, value in stance.items() if value is None)
        if unknown:
            text = (
                f"the recording does not say the {unknown} of its cameras: assumed is that of {program.assumed_geometry}, so what "
                "is measured by it may be wrong; `bfsim record calibrate --height --tilt` or `bfsim record import --geometry` "
                "puts yours into a recording"
            )
            yield RunWarning(kind=WarningKind.GEOMETRY, text=text)
    if not calibration.geometries:
        text = (
            f"the recording does not say where its cameras are: {program.assumed_geometry} was assumed, so distances "
            "may be wrong; `bfsim record calibrate` or `bfsim record import --geometry` puts yours into a "
            "recording"
        )
        yield RunWarning(kind=WarningKind.GEOMETRY, text=text)


def doubted_cameras(doubts: Iterable[str]) -> Iterator[RunWarning]:
    """Yield a warning for each reason to doubt the positions of the cameras, found in their pictures."""
    yield from (RunWarning(kind=WarningKind.GEOMETRY, text=each) for each in doubts)


def assumed_clocks(spec: BoardSpec) -> Iterator[RunWarning]:
    """Yield a warning if the chip of a board cannot have the board's clocks."""
    if spec.pll is None:
        clocks = f"{float(spec.clocks.cclk_hz) / 1e6:.6g} and {float(spec.clocks.sclk_hz) / 1e6:.6g} MHz"
        text = f"no PLL setting makes the clocks of {spec.name}, {clocks}, of one crystal"
        yield RunWarning(kind=WarningKind.CLOCKS, text=text)


def assumed_tables(
    kernels: Mapping[str, Iterable[Kernel]], spec: BoardSpec, link_map: LinkMap
) -> Iterator[RunWarning]:
    """Yield a warning if files of C and assembler have more variables and tables than a core's L1 can hold.

    `kernels`: those of each core's main loop.
    """
    alike: dict[tuple[str, int], list[str]] = {}
    for core, named in kernels.items():
        codes = [each.object_code for each in named]
        files = {tuple(each.files): each for each in codes if each and each.data_bytes}.values()
        left = _l1_data_left(core, spec, link_map)
        if sum(each.data_bytes for each in files) > left:
            listed = ", ".join(f"{each.name} ({each.data_bytes:,} bytes)" for each in files)
            alike.setdefault((listed, left), []).append(core)
    for (listed, left), cores in alike.items():
        text = (
            f"the variables and tables of {listed} are assumed to be in L1, where the LDF leaves {left:,} bytes of data memory "
            f"of core {' and '.join(cores)}: waits for them in other memories are not counted; pass large arrays as buffers"
        )
        yield RunWarning(kind=WarningKind.TABLES, text=text)


def _l1_data_left(core: str, spec: BoardSpec, link_map: LinkMap) -> int:
    banks = [each for each in spec.chip.regions if each.owner == core and each.memory.startswith("L1_DATA")]
    used = (each.used_bytes for each in link_map.segments if any(bank.holds(each.start, 1) for bank in banks))
    return sum(each.nbytes for each in banks) - sum(used)

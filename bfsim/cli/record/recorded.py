"""The descriptions of a recording by `bfsim record info` and `calibrate`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rich.table import Table

if TYPE_CHECKING:
    from bfsim.recording.calibration_report import CalibrationReport, ViewError
    from bfsim.recording.info import CameraTiming, RecordingInfo


def info_table(info: RecordingInfo) -> Table:
    """Return the content of a recording as a table."""
    table = Table(title=str(info.path), show_header=False, title_justify="left")
    table.add_row("Images", f"{info.width}x{info.height} UYVY, left and right")
    table.add_row("Stereo frames", f"{info.frame_count} in {info.duration_ns / 1e9:.3f} s")
    table.add_row("Left camera", _timing_text(info.left))
    table.add_row("Right camera", _timing_text(info.right))
    least_ms, greatest_ms = (skew / 1e6 for skew in info.skew_ns)
    table.add_row("Right after left", f"{least_ms:.3f} to {greatest_ms:.3f} ms")
    table.add_row("Geometry", str(info.geometry or "unknown"))
    table.add_row("Rectification tables", _rectification_text(info.rectified_shares))
    table.add_row("Calibration", _calibration_text(info.calibration))
    table.add_row("Ground truth", _truth_text(info))
    table.add_row(
        "File", f"{info.size_bytes / 1e6:.1f} MB, compression {info.compression}, checksums verified"
    )
    table.add_row("Written by", info.library or "unknown")
    table.add_row("Description", info.description or "none")
    return table


def _timing_text(timing: CameraTiming) -> str:
    if timing.rate_hz is None or timing.shortest_interval_ns is None or timing.longest_interval_ns is None:
        return "one picture"
    shortest_ms, longest_ms = timing.shortest_interval_ns / 1e6, timing.longest_interval_ns / 1e6
    return f"{timing.rate_hz:.3f} per second, intervals {shortest_ms:.3f} to {longest_ms:.3f} ms"


def _rectification_text(shares: tuple[float, float] | None) -> str:
    if shares is None:
        return "none: taken as rectified"
    return f"left and right, {shares[0]:.1%} and {shares[1]:.1%} of the pixels have a source"


def _truth_text(info: RecordingInfo) -> str:
    if not info.truth_count:
        return "none"
    disparities = f", {info.disparity_count} with disparities" if info.disparity_count else ""
    return f"{info.truth_count} frames{disparities}"


def _calibration_text(report: CalibrationReport | None) -> str:
    if report is None:
        return "none"
    lines = [
        f"{views_text(report)}, {report.lens} lens, {report.reprojection_px:.3f} px RMS",
        *(view_text(view) for view in report.used),
        *(f"{view_text(view)}, left out: does not fit the others" for view in report.outliers),
        *(f"{each.name} skipped: {each.reason}" for each in report.skipped),
    ]
    return "\n".join(lines)


def views_text(report: CalibrationReport) -> str:
    """Return how many views a calibration used, and what it left out."""
    what = "chessboard pairs" if len(report.cameras) > 1 else "chessboard pictures"
    return f"{len(report.used)} {what}, {len(report.outliers)} left out, {len(report.skipped)} skipped"


def view_text(view: ViewError) -> str:
    """Return the pictures of a view and their errors."""
    errors = zip(view.names, view.errors_px, strict=True)
    return ", ".join(f"{name} {error_px:.2f} px" for name, error_px in errors)

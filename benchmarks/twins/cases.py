"""Every twin there is."""

from __future__ import annotations

from benchmarks.twins import (
    angles,
    bits,
    cameras,
    codes,
    controllers,
    digits,
    drawing,
    duties,
    exchanges,
    fills,
    filters,
    grids,
    heaps,
    integers,
    labels,
    lines,
    lookups,
    maps,
    mixture,
    neighbours,
    ordering,
    patches,
    pictures,
    pixels,
    protocols,
    regions,
    rows,
    samples,
    shapes,
    signals,
    sorted_rows,
    sorting,
    streams,
    tables,
    tallies,
    text,
    trackers,
    transforms,
    words,
)

SUBJECTS = (
    angles, bits, cameras, codes, controllers, digits, drawing, duties, exchanges, fills, filters,
    grids, heaps, integers, labels, lines, lookups, maps, mixture, neighbours, ordering, patches,
    pictures, pixels, protocols, regions, rows, samples, shapes, signals, sorted_rows, sorting, streams,
    tables, tallies, text, trackers, transforms, words,
)  # fmt: skip
CASES = tuple(case for subject in SUBJECTS for case in subject.CASES)

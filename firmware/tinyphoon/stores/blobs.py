"""The blob store: the record of a segment of a picture (T §2.3.5), as the C struct that it is in memory.

    typedef struct {
        unsigned long  iColours;                       // the colours that make one segment: S_c32 of T §5.2.4
        unsigned long  iPixels;                        // blob.pixcount
        unsigned long  iSumX, iSumY;                   // of the coordinates of all pixels: T Eq. 2.19, 2.20
        unsigned short iLeft, iRight, iTop, iBottom;   // blob.rec: the outermost columns and rows
        unsigned short iPosX, iPosY;                   // blob.pos: the middle of the rectangle
        unsigned short iCcX, iCcY;                     // blob.cc: the colour centre of mass
    } t_Blob;

`blob_data` is an array of them, `BLOB_WORDS` words of 32 bits each; two shorts share a word, the first one in
its low half. While a picture is segmented, record `label` belongs to the segment of that label; afterwards
the blobs are the first records. Coordinates are pixels from the top left one.
"""

from __future__ import annotations

from bfsim.api import Row, i32, kernel, u32

BLOB_WORDS = 8
COLOURS = 0
PIXELS = 1
SUM_X = 2
SUM_Y = 3
ACROSS = 4  # iLeft and iRight
DOWN = 5  # iTop and iBottom
POSITION = 6
CENTRE = 7

BORDER_PX = 1  # the opening leaves no colour in the outermost pixels of a picture


@kernel
def pair(low: i32, high: i32) -> u32:
    """Return two shorts in one word."""
    return u32(low | high << 16)


@kernel
def wider(span: u32, first: i32, last: i32) -> u32:
    """Return the pair of ends `span`, moved apart until it also holds `first` to `last`."""
    return pair(min(i32(span & 0xFFFF), first), max(i32(span >> 16), last))


@kernel
def middle(span: u32) -> i32:
    """Return the middle of a pair of ends, rounded down."""
    return i32(span & 0xFFFF) + i32(span >> 16) >> 1


@kernel
def extent_of(span: u32) -> i32:
    """Return the number of pixels from one end of a pair to the other."""
    return i32(span >> 16) - i32(span & 0xFFFF) + 1


@kernel
def is_cut_before(span: u32) -> i32:
    """Return 1 if a blob from end to end of `span` leaves the picture at the left or at the top, else 0."""
    return 1 if i32(span & 0xFFFF) <= BORDER_PX else 0


@kernel
def is_cut_behind(span: u32, pixels: i32) -> i32:
    """Return 1 if the blob leaves a picture of `pixels` at the right or at the bottom, else 0."""
    return 1 if i32(span >> 16) >= pixels - 1 - BORDER_PX else 0


@kernel
def is_cut(span: u32, pixels: i32) -> i32:
    """Return 1 if the blob leaves the picture at either end, else 0."""
    return is_cut_before(span) | is_cut_behind(span, pixels)


@kernel
def open_segment(blob_data: u32[:], label: i32, colours: u32, x: i32, y: i32) -> None:
    """Begin the record of a segment with its first pixel at (x, y); the record has no pixel yet."""
    at = label * BLOB_WORDS
    blob_data[at + COLOURS] = colours
    blob_data[at + PIXELS] = 0
    blob_data[at + SUM_X] = 0
    blob_data[at + SUM_Y] = 0
    blob_data[at + ACROSS] = pair(x, x)
    blob_data[at + DOWN] = pair(y, y)


@kernel
def add_run(blob_data: u32[:], label: i32, first: i32, last: i32, y: i32) -> None:
    """Add the pixels `first` to `last` of row `y` to a segment."""
    at = label * BLOB_WORDS
    pixels = last + 1 - first
    blob_data[at + PIXELS] = blob_data[at + PIXELS] + u32(pixels)
    blob_data[at + SUM_X] = blob_data[at + SUM_X] + u32((first + last) * pixels >> 1)
    blob_data[at + SUM_Y] = blob_data[at + SUM_Y] + u32(y * pixels)
    blob_data[at + ACROSS] = wider(blob_data[at + ACROSS], first, last)
    blob_data[at + DOWN] = wider(blob_data[at + DOWN], y, y)


@kernel
def add_segment(blob_data: u32[:], label: i32, other: i32) -> None:
    """Add the pixels of segment `other` to segment `label`."""
    at = label * BLOB_WORDS
    source = other * BLOB_WORDS
    for word in range(PIXELS, SUM_Y + 1):
        blob_data[at + word] = blob_data[at + word] + blob_data[source + word]
    for word in range(ACROSS, DOWN + 1):
        span = blob_data[source + word]
        blob_data[at + word] = wider(blob_data[at + word], i32(span & 0xFFFF), i32(span >> 16))


@kernel
def move_segment(blob_data: u32[:], label: i32, to: i32) -> None:
    """Move the record of segment `label` to number `to`."""
    at = to * BLOB_WORDS
    source = label * BLOB_WORDS
    for word in range(COLOURS, DOWN + 1):
        blob_data[at + word] = blob_data[source + word]


@kernel
def close_blob(blob_data: u32[:], blob: i32) -> None:
    """Complete the record of a blob with its position and its centre of mass.

    The centre is rounded to the nearest pixel, halves upwards; the sums stay for finer use.
    """
    at = blob * BLOB_WORDS
    blob_data[at + POSITION] = pair(middle(blob_data[at + ACROSS]), middle(blob_data[at + DOWN]))
    pixels = blob_data[at + PIXELS]
    x = (blob_data[at + SUM_X] + (pixels >> 1)) // pixels
    y = (blob_data[at + SUM_Y] + (pixels >> 1)) // pixels
    blob_data[at + CENTRE] = x | y << 16


def box_of(blob_data: Row, blob: int) -> tuple[range, range]:
    """Return the rows and the columns of a blob, for `core.at`: nothing on the chip reads them here."""
    down, across = (int(blob_data.array[blob * BLOB_WORDS + word]) for word in (DOWN, ACROSS))
    return range(down & 0xFFFF, (down >> 16) + 1), range(across & 0xFFFF, (across >> 16) + 1)

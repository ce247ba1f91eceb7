"""Layout of the state that the compiled weave works on: 64-bit words in one array, and what each of them means.

All times are ticks; all addresses are offsets into the arena, the one host array that holds every memory.
"""

from __future__ import annotations

from collections.abc import MutableSequence

from bfsim.kernel.calls import access_log as log

State = MutableSequence[int]
"""The array, an int64 one, as compiled code sees it."""
Memory = MutableSequence[int]
"""The arena, as 32-bit words."""

NEVER = 1 << 62
NONE = -1

# ---- The SDRAM controller and its banks. The words up to WORD_BITS never change during a run.
(
    SCLK, CL, RCD, RP, RAS, WR, TURN, REFRESH, REFRESH_INTERVAL, PAGE_BITS, BANK_BITS, WORD_BITS,
    COMMAND_FREE,   # when the next command may be given
    DATA_FREE,      # when the data bus is free
    LAST_WRITE,     # whether the last data were written
    NEXT_REFRESH,
    REFRESHES,
    PAGE_CLASS,     # of the last access: 0 hit, 1 miss, 2 conflict
    BEGAN,          # when the bus was free for the last access, or for the refresh before it
    REFRESH_WAIT,   # how much of the time before it was a refresh
    REFRESH_BEGAN, REFRESH_ENDS,  # the last refresh, from the request that it held up
) = range(22)  # fmt: skip
MAX_BANKS = 8
OPEN_PAGE = 22
ACTIVATED = OPEN_PAGE + MAX_BANKS
WRITTEN = ACTIVATED + MAX_BANKS
SDRAM_WORDS = WRITTEN + MAX_BANKS

# ---- What all masters share. The words up to LINE_BYTES never change.
BUS_AT = SDRAM_WORDS
(
    CCLK, SDRAM_END, L2_FIRST, L2_END, L1_FIRST, SUBBANK_BITS, L2_READ, L2_NEXT, L2_PORT_BITS, CORE_SYNC, STORE_DEPTH,
    DEB_PERIOD, MDMA_PERIOD, LINE_BYTES,
    BURST_WORDS,    # words that a DMA moves at once, from or to its FIFO
    L2_FREE,        # when the port of L2 is free
    LAST_CORE_AT_L2,  # the core that had that port last
    IMDMA_HAD_L2,   # whether the internal DMA had it last
    DEB_LEFT,       # transfers in the present direction that still have preference
    LAST_CORE,      # the core that had the SDRAM bus last: the other one comes first
    FREE_TRANSFERS, # how many transfers can still be posted
    DONE_AT,        # tick of the completion that `advance` returned with
    POSTED,         # transfers that were posted since
    PIECES,         # how many pieces the memories are in
    ALL_POSTED,     # transfers that were posted in all: the number of the next one
) = range(BUS_AT, BUS_AT + 25)  # fmt: skip
BUS_WORDS = 25

# The masters in the order of their rows. Cores have one for what they wait for and one for their store buffer.
(
    PPI0, PPI1, SPI, UART_RX, UART_TX,
    MDMA1_0, MDMA1_1, MDMA2_0, MDMA2_1, IMDMA_0, IMDMA_1,
    STORES_A, STORES_B, CORE_A, CORE_B,
) = range(15)  # fmt: skip
MASTERS = 15

# ---- A master: who can ask for the bus. Word n of all masters stands together, since all are looked at in every step.
(
    RANK,           # lower is served first
    READY,          # when its next request can be granted, NEVER if it has none
    USES,           # what that request needs: NOTHING, the SDRAM bus, or the port of L2
    WRITES,         # whether it writes
    TRANSFER,       # place of the transfer it works on, or NONE
    LAST_TRANSFER,  # place of the last one in its queue
    FREE_AT,        # when its last transfer ended
    FIFO,           # elements that wait in it before any is lost
    GAP_NUMERATOR, GAP_DENOMINATOR,  # cycles beyond one a word that a memory DMA takes to read, as a fraction
    GAP,            # of that fraction: what has added up
    IN_FIFO,        # elements that were read and not yet written
    PARTNER,        # the other stream of its controller, or NONE
    SERVED,         # elements since the partner had its turn
    ALL_LOST,       # elements of all transfers that found the FIFO full
) = range(0, 15 * MASTERS, MASTERS)  # fmt: skip
MASTER_WORDS = 15

NOTHING, SDRAM, L2 = range(3)  # what a request can need

# ---- A transfer of a DMA, at one of MAX_TRANSFERS places.
(
    IDENTITY,       # number of the transfer
    NEXT,           # place of the next transfer of the same master, or NONE
    AT,             # it begins at this tick or later,
    SETUP,          # and takes so many ticks to start
    WAKE,           # whom it wakes: AT_END, AT_ROWS
    MODE,
    ELEMENT_BITS,   # an element is 1 << so many bytes
    LEFT,           # elements still to move
    MOVED,          # elements moved, or lost
    LOST,           # elements that found the FIFO full
    FROM, FROM_X_COUNT, FROM_X_MODIFY, FROM_Y_MODIFY, FROM_X_LEFT,
    TO, TO_X_COUNT, TO_X_MODIFY, TO_Y_MODIFY, TO_X_LEFT,
    # The pace of a device, in parts of a tick: an element and a line take so many PARTS, PARTS make a tick.
    START, PARTS, ELEMENT, LINE, LINE_ELEMENTS,
    PLACE, LINE_BEGAN,  # where the next element is: in its line, and when that began, in parts from the start
    OF_MASTER,      # whose it is
    FROM_OWNER, TO_OWNER,  # the memory owners (below) that its sides begin in
    IS_MOVED,       # whether its bytes have been moved already, and only the time is left
) = range(31)  # fmt: skip
TRANSFER_WORDS = 31
MAX_TRANSFERS = 256
ENDS = 1 << 16
"""Transfers whose end is remembered: the latest so many."""

# A side of a transfer, from FROM or from TO on.
POSITION, X_COUNT, X_MODIFY, Y_MODIFY, X_LEFT = range(5)

# Modes of a transfer: which of its sides is in SDRAM; that none is, or that the internal DMA has one in L2; or that a device
# sets its pace.
READ, WRITE, BOTH, ON_CHIP, THROUGH_L2_PORT, PACED_IN, PACED_OUT = range(7)

AT_END, AT_ROWS = 1, 2  # what wakes somebody

# ---- A job: what one core accesses outside L1 in one kernel call.
(
    STATE,
    ENTRY, END,     # next entry of the core's log, and where the log ends
    BEGIN,          # tick at which the call began
    TOTAL,          # cycles of the call without these stalls
    STALLED,        # ticks that it was stalled
    ISSUED_AT,      # tick of the present access
    STORE_HEAD, STORES,  # store buffer: the oldest, and how many
    LINE_DONE,      # when the last line that was fetched is whole
    SPIN,           # ticks from the end of a TESTSET to the next one while the core spins on a lock, else 0
    PRESENT, SITE,  # the present access, as an entry of the log, and its site,
    IN_TURN,        # and whether it is a fetch of the code below
    FETCHES, FETCHED,  # how often code is fetched that no cache holds, and how often it has been
    NEXT_FETCH,     # the stamp of the next of these, behind that of all accesses if there is none
    ROUTINE, WORD,  # the site of the routine that is fetched next, and which of its words
) = range(19)  # fmt: skip
IDLE, STARTING, RUNNING, BUFFER_FULL, BUFFER_NOT_EMPTY = range(5)
STALL = 19
(
    L2_LATENCY, L2_PORT, PAGE_HIT, PAGE_MISS, PAGE_CONFLICT, REFRESHING, ARBITRATION, STORE_BUFFER, CACHE_FILL, CODE_FETCH,
) = range(10)  # fmt: skip
STALLS = 10
STORE_QUEUE = STALL + STALLS
MAX_STORES = 16
JOB_WORDS = STORE_QUEUE + MAX_STORES
CORES = 2

CORE_WORD_BYTES = 4  # what a load or a store moves, whatever its width
FETCH_BYTES = 8  # of an instruction fetch that no cache serves: one 64-bit word

# ---- A stretch: what a core does by itself between two calls of firmware that need Python, as a list of operations.
(
    OPERATION, OPERATIONS_END,  # the next one, and how many there are
    CLOCK,          # the core's own clock, in its cycles
    ACTS_AT,        # tick at which it goes on, NEVER while it waits for the bus or has no stretch
    AWAITED,        # what `advance` returns when the core can go on: a transfer, or its job; NONE
    COPIES,         # copies that it has posted in all; what follows is 0 when it begins
    TOUCHED,        # of the accounts below, how many were used
    ISSUED, INTERLOCKED,  # cycles of its kernels
) = range(9)  # fmt: skip
BEGUN_WORDS = TOUCHED
ON_BUS = 9  # what its kernels stalled, in the order above
ACCOUNTS = ON_BUS + STALLS  # cycles of others, such as rings
TOUCH, SETTING_UP, RING_EMPTY, RING_FULL = range(
    4
)  # the how-manieth account it was, from 1 on, and why it stalled
ACCOUNT_WORDS = 4
MAX_ACCOUNTS = 256
PLAY_WORDS = ACCOUNTS + MAX_ACCOUNTS * ACCOUNT_WORDS

# An operation: what it is, up to four numbers, and OF_CALL.
(
    RUN,            # a call that stays in L1: issue cycles, interlocks
    ACCESS,         # a call that does not: the same, the first of its accesses in the log, and the one behind its last
    CATCH_UP,       # let the bus come up to the core
    SET_UP,         # program a device: cycles, account
    COPY,           # post a copy: its plan, and where it begins to read and to write
    AWAIT,          # wait for a copy: how many were posted since, why that is a stall, account
    MOMENT,         # let somebody do at this moment what the bus cannot do: a number for them
    ABOUT,          # what follows is about another place of the picture: its number, for who tells it
) = range(8)  # fmt: skip
OF_CALL = 5  # which call an ACCESS is, or a RUN of one, of those that were prepared
OPERATION_WORDS = 6
MAX_OPERATIONS = 1 << 17

# ---- A tape: how much of its operations a core that runs ahead has noted (`tape`).
(
    NOTED,          # operations
    MARKED,         # how many of them the mark that was set last is behind
    NOTED_COPIES,   # copies, in all
    MOST,           # operations that it has room for, before the core must meet the others
    IS_FULL,        # whether the core must meet the others before it notes more
    TAKES_CALLS,    # whether calls are noted without Python
    IS_TOLD,        # whether it is kept what each operation took (below), so that no two calls are noted as one
) = range(7)  # fmt: skip
TAPE_WORDS = 7

# ---- What each operation took, by its number: where the core's clock was behind it, and more.
UNTIL = 0
COPIED = 1  # of a COPY and an AWAIT: the number of the transfer
POSTED_AT = 2  # of a COPY: the tick from which that may begin
CALL_STALLS = 1  # of a call: its stalls on the bus, in the order above
TOOK_WORDS = CALL_STALLS + STALLS
PLAN_WORDS = TRANSFER_WORDS
MAX_PLANS = 1 << 17

# ---- Who owns memory: each buffer, and nobody what is left of SDRAM, of L2 and of all else.
NO_BUFFER_IN_SDRAM, NO_BUFFER_IN_L2, NO_BUFFER = range(3)
MAX_OWNERS = 4096

# ---- Traffic: by owner of the memory, master, and what.
READ_BYTES, WRITTEN_BYTES, HITS, MISSES, CONFLICTS, BUSY = range(6)
TRAFFIC_WORDS = 6
MAX_SUBBANKS = 64

# ---- What accesses stalled the cores: by site, one of the lines of one kernel call (`kernel.call_paths`), and what.
NO_SITE = 0
"""Of an access that no kernel makes."""
MAX_SITES = 1 << 18
# Behind the stalls by reason: how many lines were filled; the piece of memory that was accessed last, to find it again.
FILLS, PIECE = STALLS, STALLS + 1
# Of a site that is the code of a routine: where it lies, how many FETCH_BYTES long it is, and the site of the one that is fetched behind it.
CODE, CODE_WORDS, NEXT_ROUTINE = STALLS + 2, STALLS + 3, STALLS + 4
SITE_WORDS = STALLS + 5

# ---- Where each part begins in the one array; the SDRAM controller and the bus begin it.
MASTERS_AT = BUS_AT + BUS_WORDS
JOBS_AT = MASTERS_AT + MASTERS * MASTER_WORDS
TRAFFIC_AT = JOBS_AT + CORES * JOB_WORDS
SUBBANKS_AT = TRAFFIC_AT + MAX_OWNERS * MASTERS * TRAFFIC_WORDS
TRANSFERS_AT = SUBBANKS_AT + MAX_SUBBANKS
FREE_PLACES_AT = TRANSFERS_AT + MAX_TRANSFERS * TRANSFER_WORDS
POSTS_AT = FREE_PLACES_AT + MAX_TRANSFERS  # master and place of each transfer that was posted
ENDS_AT = POSTS_AT + 2 * MAX_TRANSFERS
PIECES_AT = ENDS_AT + ENDS  # where each piece of memory begins, in order, and who owns it
MAX_PIECES = 2 * MAX_OWNERS
SITES_AT = PIECES_AT + 2 * MAX_PIECES
LOGS_AT = SITES_AT + CORES * MAX_SITES * SITE_WORDS
LOG_ENTRIES = 1 << 23
"""Accesses outside L1 that one kernel call may make; the host has memory for those that are made only."""
ACCESS_TRACE_WORDS = log.LOG + log.ENTRY_WORDS * LOG_ENTRIES
PLAYS_AT = LOGS_AT + CORES * ACCESS_TRACE_WORDS
OPERATIONS_AT = PLAYS_AT + CORES * PLAY_WORDS
COPIES_AT = (
    OPERATIONS_AT + CORES * MAX_OPERATIONS * OPERATION_WORDS
)  # number and place of the latest copies of each core
PLANS_AT = COPIES_AT + CORES * 2 * ENDS
TAPES_AT = PLANS_AT + MAX_PLANS * PLAN_WORDS
TOOK_AT = TAPES_AT + CORES * TAPE_WORDS
STATE_WORDS = TOOK_AT + CORES * MAX_OPERATIONS * TOOK_WORDS

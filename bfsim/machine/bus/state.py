"""Layout of the state that the compiled weave works on: 64-bit words in one array, and the meaning of each.

All times are ticks. All addresses are offsets into the arena, the one host array that holds every memory.
"""

from __future__ import annotations

from collections.abc import MutableSequence

from bfsim.kernel.calls import access_log as log

State = MutableSequence[int]
"""The int64 array as compiled code sees it."""
Memory = MutableSequence[int]
"""The arena, as 32-bit words."""

NEVER = 1 << 62
NONE = -1

# ---- The SDRAM controller and its banks. The words up to WORD_BITS never change during a run.
(
    SCLK, CL, RCD, RP, RAS, WR, TURN, REFRESH, REFRESH_INTERVAL, PAGE_BITS, BANK_BITS, WORD_BITS,
    COMMAND_FREE,   # when the next command may be issued
    DATA_FREE,      # when the data bus is free
    LAST_WRITE,     # whether the last data were written
    NEXT_REFRESH,
    REFRESHES,
    PAGE_CLASS,     # of the last access: 0 hit, 1 miss, 2 conflict
    BEGAN,          # when the bus was free for the last access, or for the refresh before it
    REFRESH_WAIT,   # how long a refresh delayed it
    REFRESH_BEGAN, REFRESH_ENDS,  # the last refresh, from the request that it delayed
) = range(22)  # fmt: skip
MAX_BANKS = 8
OPEN_PAGE = 22
ACTIVATED = OPEN_PAGE + MAX_BANKS
WRITTEN = ACTIVATED + MAX_BANKS
SDRAM_WORDS = WRITTEN + MAX_BANKS

# ---- Words that all masters share. Those up to LINE_BYTES never change.
BUS_AT = SDRAM_WORDS
(
    CCLK, SDRAM_END, L2_FIRST, L2_END, L1_FIRST, SUBBANK_BITS, L2_READ, L2_NEXT, L2_PORT_BITS, CORE_SYNC, STORE_DEPTH,
    DEB_PERIOD, MDMA_PERIOD, LINE_BYTES,
    BURST_WORDS,    # words that a DMA moves at once, from or to its FIFO
    L2_FREE,        # when the port of L2 is free
    LAST_CORE_AT_L2,  # the core that had that port last
    IMDMA_HAD_L2,   # whether the internal DMA had it last
    DEB_LEFT,       # transfers in the current direction that still have preference
    LAST_CORE,      # the core that had the SDRAM bus last: the other one goes first
    FREE_TRANSFERS, # how many transfers can still be posted
    DONE_AT,        # tick of the completion that `advance` returned with
    POSTED,         # transfers posted since then
    PIECES,         # how many pieces the memories are divided into
    ALL_POSTED,     # transfers posted in all: the number of the next one
) = range(BUS_AT, BUS_AT + 25)  # fmt: skip
BUS_WORDS = 25

# The masters in the order of their rows. Cores have one for accesses that they wait for, and one for their store buffer.
(
    PPI0, PPI1, SPI, UART_RX, UART_TX,
    MDMA1_0, MDMA1_1, MDMA2_0, MDMA2_1, IMDMA_0, IMDMA_1,
    STORES_A, STORES_B, CORE_A, CORE_B,
) = range(15)  # fmt: skip
MASTERS = 15

# ---- A master can request the bus. Word n of all masters stands together, because every step looks at all masters.
(
    RANK,           # lower is served first
    READY,          # when its next request can be granted, NEVER if it has none
    USES,           # what that request needs: NOTHING, the SDRAM bus or the port of L2
    WRITES,         # whether it writes
    TRANSFER,       # place of the transfer it works on, or NONE
    LAST_TRANSFER,  # place of the last one in its queue
    FREE_AT,        # when its last transfer ended
    FIFO,           # elements that its FIFO holds before any is lost
    GAP_NUMERATOR, GAP_DENOMINATOR,  # cycles per word beyond one that a memory DMA takes to read, as a fraction
    GAP,            # sum of that fraction so far
    IN_FIFO,        # elements read but not yet written
    PARTNER,        # the other stream of its controller, or NONE
    SERVED,         # elements since the partner's turn
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
    WAKE,           # when it wakes a waiter: AT_END, AT_ROWS
    MODE,
    ELEMENT_BITS,   # an element has 1 << ELEMENT_BITS bytes
    LEFT,           # elements still to move
    MOVED,          # elements moved, or lost
    LOST,           # elements that found the FIFO full
    FROM, FROM_X_COUNT, FROM_X_MODIFY, FROM_Y_MODIFY, FROM_X_LEFT,
    TO, TO_X_COUNT, TO_X_MODIFY, TO_Y_MODIFY, TO_X_LEFT,
    # The pace of a device: ELEMENT and LINE are the times of an element and a line in parts of a tick, PARTS to a tick.
    START, PARTS, ELEMENT, LINE, LINE_ELEMENTS,
    PLACE, LINE_BEGAN,  # the next element's position in its line, and when that line began, in parts from the start
    OF_MASTER,      # its master
    FROM_OWNER, TO_OWNER,  # the memory owners (below) where its sides begin
    IS_MOVED,       # whether its bytes have already been moved, so only the time is left
) = range(31)  # fmt: skip
TRANSFER_WORDS = 31
MAX_TRANSFERS = 256
ENDS = 1 << 16
"""How many of the latest transfers' ends are remembered."""

# A side of a transfer, from FROM or from TO on.
POSITION, X_COUNT, X_MODIFY, Y_MODIFY, X_LEFT = range(5)

# Modes of a transfer: the sides in SDRAM; none there, or one of the internal DMA's in L2; or a device sets the pace.
READ, WRITE, BOTH, ON_CHIP, THROUGH_L2_PORT, PACED_IN, PACED_OUT = range(7)

AT_END, AT_ROWS = 1, 2  # when a transfer wakes a waiter

# ---- A job: the accesses of one core outside L1 in one kernel call.
(
    STATE,
    ENTRY, END,     # next entry of the core's log, and where the log ends
    BEGIN,          # tick at which the call began
    TOTAL,          # cycles of the call without these stalls
    STALLED,        # ticks that it has stalled
    ISSUED_AT,      # tick of the current access
    STORE_HEAD, STORES,  # store buffer: the oldest store, and how many there are
    LINE_DONE,      # when the last fetched line is complete
    SPIN,           # ticks from the end of a TESTSET to the next one while the core spins on a lock, else 0
    PRESENT, SITE,  # the current access, as an entry of the log, and its site,
    IN_TURN,        # and whether it is a fetch of the code below
    FETCHES, FETCHED,  # number of fetches of code that no cache holds, in all and so far
    NEXT_FETCH,     # the stamp of the next one, later than all accesses if there is none
    ROUTINE, WORD,  # the site of the routine that is fetched next, and the number of its next word
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

CORE_WORD_BYTES = 4  # bytes moved by a load or a store, whatever its width
FETCH_BYTES = 8  # bytes of an instruction fetch that no cache serves: one 64-bit word

# ---- A stretch: a list of operations that a core does by itself, between two meetings with other devices.
(
    OPERATION, OPERATIONS_END,  # the next one, and where they end
    CLOCK,          # the core's own clock, in its cycles
    ACTS_AT,        # tick at which it goes on, NEVER while it waits for the bus or has no stretch
    AWAITED,        # what `advance` returns when the core can go on: a transfer or its job; otherwise NONE
    COPIES,         # copies that it has posted in all; the words after this are 0 at the beginning
    TOUCHED,        # how many of the accounts below were used
    ISSUED, INTERLOCKED,  # cycles of its kernels
) = range(9)  # fmt: skip
BEGUN_WORDS = TOUCHED
ON_BUS = 9  # stalls of its kernels, in the order above
ACCOUNTS = ON_BUS + STALLS  # cycles of other owners, such as rings
TOUCH, SETTING_UP, RING_EMPTY, RING_FULL = range(
    4
)  # the account's place in order of first use, from 1 on, and its stalls by reason
ACCOUNT_WORDS = 4
MAX_ACCOUNTS = 256
PLAY_WORDS = ACCOUNTS + MAX_ACCOUNTS * ACCOUNT_WORDS

# An operation: what it is, up to four numbers, and OF_CALL.
(
    RUN,            # a call that stays in L1: issue cycles, interlocks
    ACCESS,         # a call that does not: the same, the first of its accesses in the log, and the one after its last
    CATCH_UP,       # let the bus catch up with the core
    SET_UP,         # program a device: cycles, account
    COPY,           # post a copy: its plan, and where it begins to read and to write
    AWAIT,          # wait for a copy: its number counted back from the latest, 1; the reason of the stall; account
    MOMENT,         # stop for something that the bus cannot do: a number that says what
    ABOUT,          # what follows is about another place of the picture: its number, for the timeline
) = range(8)  # fmt: skip
OF_CALL = 5  # number of the prepared call of an ACCESS, or of a RUN of one call
OPERATION_WORDS = 6
MAX_OPERATIONS = 1 << 17

# ---- A tape: the operations that a core that runs ahead has noted (`tape`).
(
    NOTED,          # operations
    MARKED,         # operations before the latest mark
    NOTED_COPIES,   # copies, in all
    MOST,           # operations after which the core must meet the other devices
    IS_FULL,        # whether the core must meet the other devices before it notes more
    TAKES_CALLS,    # whether calls are noted without Python
    IS_TOLD,        # whether the time of each operation is kept (below), so that calls are never merged
) = range(7)  # fmt: skip
TAPE_WORDS = 7

# ---- What each operation took, by its number: the core's clock after it, and more.
UNTIL = 0
COPIED = 1  # for a COPY or an AWAIT: the number of the transfer
POSTED_AT = 2  # for a COPY: the tick from which the transfer may begin
CALL_STALLS = 1  # for a call: its stalls on the bus, in the order above
TOOK_WORDS = CALL_STALLS + STALLS
PLAN_WORDS = TRANSFER_WORDS
MAX_PLANS = 1 << 17

# ---- Owners of memory: each buffer, and no buffer for the rest of SDRAM, of L2 and of everything else.
NO_BUFFER_IN_SDRAM, NO_BUFFER_IN_L2, NO_BUFFER = range(3)
MAX_OWNERS = 4096

# ---- Traffic, by owner of the memory, master and counter.
READ_BYTES, WRITTEN_BYTES, HITS, MISSES, CONFLICTS, BUSY = range(6)
TRAFFIC_WORDS = 6
MAX_SUBBANKS = 64

# ---- Stalls by accesses, by reason and site: one of the lines of one kernel call (`kernel.call_paths`).
NO_SITE = 0
"""The site of an access that no kernel makes."""
MAX_SITES = 1 << 18
# After the stalls by reason: how many lines were filled, and the piece of memory accessed last, which is tried first.
FILLS, PIECE = STALLS, STALLS + 1
# For a site that is a routine's code: where it lies, its length in units of FETCH_BYTES, and the site of the next fetched routine.
CODE, CODE_WORDS, NEXT_ROUTINE = STALLS + 2, STALLS + 3, STALLS + 4
SITE_WORDS = STALLS + 5

# ---- Where each part begins in the array. The SDRAM controller and the bus come first.
MASTERS_AT = BUS_AT + BUS_WORDS
JOBS_AT = MASTERS_AT + MASTERS * MASTER_WORDS
TRAFFIC_AT = JOBS_AT + CORES * JOB_WORDS
SUBBANKS_AT = TRAFFIC_AT + MAX_OWNERS * MASTERS * TRAFFIC_WORDS
TRANSFERS_AT = SUBBANKS_AT + MAX_SUBBANKS
FREE_PLACES_AT = TRANSFERS_AT + MAX_TRANSFERS * TRANSFER_WORDS
POSTS_AT = FREE_PLACES_AT + MAX_TRANSFERS  # master and place of each posted transfer
ENDS_AT = POSTS_AT + 2 * MAX_TRANSFERS
PIECES_AT = ENDS_AT + ENDS  # where each piece of memory begins, in order, and its owner
MAX_PIECES = 2 * MAX_OWNERS
SITES_AT = PIECES_AT + 2 * MAX_PIECES
LOGS_AT = SITES_AT + CORES * MAX_SITES * SITE_WORDS
LOG_ENTRIES = 1 << 23
"""Accesses outside L1 that one kernel call may make. The host uses memory only for those that are made."""
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

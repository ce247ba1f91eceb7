"""What each of the two multipliers may do in one instruction."""

RESTS, ADDS, EXTRACTS, MOVES, MULTIPLIES = "rests", "adds", "extracts", "moves", "multiplies"
"""Nothing; change its accumulator; that, and write it to a register; only write it; write a product."""

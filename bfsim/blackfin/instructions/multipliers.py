"""What each of the two multipliers may do in one instruction."""

RESTS, ADDS, EXTRACTS, MOVES, MULTIPLIES = "rests", "adds", "extracts", "moves", "multiplies"
"""Does nothing; changes its accumulator; also writes it to a register; only writes it; writes a product."""

"""The parts of `benchmarks/instruction_set.py`."""

"""Inputs of every kind, made wrong by chance and with their structure in mind. `benchmarks/fuzz.py` gives them to bfsim."""

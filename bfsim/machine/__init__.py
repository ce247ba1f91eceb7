"""The simulated machine: a folder per block of the chip's diagram, wired by `board`. SimPy is used only here."""

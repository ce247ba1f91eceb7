"""The simulated machine: a folder per block of the chip's diagram; `board` wires them. Only here is SimPy used."""

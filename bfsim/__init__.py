"""bfsim: what a frame costs on a dual-core Blackfin ADSP-BF561, from firmware written in Python."""

__version__ = "0.1.0"

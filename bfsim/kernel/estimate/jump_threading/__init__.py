"""Jump threading: ways that lead past a test of which the answer is known there."""

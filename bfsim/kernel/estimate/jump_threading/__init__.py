"""Jump threading: paths that lead past a test whose answer is known there."""

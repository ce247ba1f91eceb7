"""Induction variables: what a loop steps, and what it computes from them."""

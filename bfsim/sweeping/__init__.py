"""Sweeps: many runs with options from one TOML file, each done once."""

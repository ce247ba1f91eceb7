"""Compiled Python: functions that look at every access or every word, and how their code is made and kept."""

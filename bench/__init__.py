"""Benchmarks of the contact laws: `python bench/run.py --help`."""

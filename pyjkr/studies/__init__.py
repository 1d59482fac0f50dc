"""The figures of the two papers, and sweeps of a user's own: one module per study.

A study says which points it has, evaluates one of them, and turns the table of all rows into checks and figures:
`Settings`, `points`, `evaluate`, `checks`, `figures`. `pyjkr.sweep` does the rest.
"""

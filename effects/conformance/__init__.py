"""Captures of real chips, redrawn: what each capture's program drew, as data, and how many pixels agree.

``suites/`` has one module per suite of nxdk_pgraph_tests. ``case`` defines a case, ``scenes`` holds the
shared parts of the suites' programs, and ``redraw`` runs a case and compares it with its capture.
docs/silicon.md has the results.
"""

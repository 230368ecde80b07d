"""Captures of real chips, redrawn: what each one's program drew, as data, and how many pixels agree.

``suites/`` has one module per suite of nxdk_pgraph_tests; ``case`` says what a case is, ``scenes`` holds what
the suites' programs share, ``redraw`` runs a case and compares it with its capture. docs/silicon.md has the
results.
"""

"""One module per suite. A module has ``SUITE`` (the captures' folder), ``names()`` (every case that the
suite's program draws) and ``case(name, inputs)`` (a Case, or None for a name that is not the suite's).
"""

"""One module per suite. A module has ``SUITE``, the captures' folder, and ``CASES``, every case that the
suite's program draws: by its name, in order, the function that builds it, from nothing or from ``inputs``.
"""

"""One module per suite. A module has ``SUITE``, the captures' folder, and ``CASES``, the suite's cases in
order.

``CASES`` maps a case's name to the function that builds it, without arguments or from ``inputs``.
"""

"""What tests of studies share."""

# Studies that take longer than about half a second.
SLOW = {f"P{n}" for n in (2, 3, 4, 7, 8, 11, 12, 13, 14, 19, 22, 23, 24, 27, 29, 31, 32, 34, 36, 38, 40)}

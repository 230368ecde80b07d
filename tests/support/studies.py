"""What tests of studies share."""

# Studies that take longer than about half a second.
SLOW = {
    "P4", "P7", "P8", "P11", "P12", "P13", "P14", "P19", "P22", "P23", "P24", "P31", "P32", "P36", "P38", "P40",
}  # fmt: skip

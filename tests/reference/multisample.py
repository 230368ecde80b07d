"""Several samples in a pixel (docs/numbers.md, section 19): where they are, and what reading them gives."""

# Offsets from a pixel's middle in 1/16 pixel, y up. Of 4 and 8 Assumed: no two of a number in one row or
# column; of 2 Measured: the upper left corner and the middle (Swath_width, Antialiasing_tests captures).
POSITIONS = {
    2: ((-8, 8), (0, 0)),
    4: ((-6, -2), (-2, 6), (2, -6), (6, 2)),
    8: ((-7, -1), (-5, 5), (-3, -5), (-1, 3), (1, -3), (3, 7), (5, 1), (7, -7)),
}


def seen_from(x, y, position):
    """Device coordinates (1/16 pixel, y down) of a vertex as a sample sees it: the sample takes the place of
    the pixel's middle. Assumed: everything of a fragment is the sample's own.
    """
    across, up = position
    return x - across, y + up


def read(words):
    """What is read of a component with these samples. Assumed: their mean, to nearest, a half up."""
    return (2 * sum(words) + len(words)) // (2 * len(words))

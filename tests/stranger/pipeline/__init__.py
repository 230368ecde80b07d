"""The stranger's own pipeline, which has nothing to do with ours."""

import os

import numpy as np


def gradient(width, height):
    """A picture, uint8 [height, width, 3]; the variable STRANGER_BUG breaks it, as a change of code would."""
    rows, columns = np.mgrid[:height, :width]
    picture = np.stack(
        [columns * 255 // (width - 1), rows * 255 // (height - 1), (rows + columns) % 256], axis=2
    )
    picture = picture.astype(np.uint8)
    if os.environ.get("STRANGER_BUG"):
        picture[-1, -1] ^= 1
    return picture

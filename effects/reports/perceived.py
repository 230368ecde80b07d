"""How different two pictures look: FLIP, by NVIDIA's library.

Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild: FLIP, a difference evaluator
for alternating images. High Performance Graphics 2020.
"""

import numpy as np

try:
    import flip_evaluator
except ImportError:  # the extra "metrics" is not installed
    flip_evaluator = None


def flip(picture, other):
    """The mean of FLIP over two pictures, 0 (equal) to 1: as their pixels look when one flips between them,
    at 67 pixels a degree, which is a screen 70 cm away. None if the library is not installed.

    picture  uint8 [h, w, 3 or 4], top row first
    other    the same; pixels with an alpha of 0 are not compared
    """
    if flip_evaluator is None:
        return None
    first = picture[..., :3]
    second = np.where(other[..., 3:] == 0, first, other[..., :3]) if other.shape[2] == 4 else other
    if np.array_equal(first, second):
        return 0.0
    scaled = (np.ascontiguousarray(one, np.float32) / np.float32(255.0) for one in (second, first))
    _, mean, _ = flip_evaluator.evaluate(*scaled, "LDR", True, False, True)
    return float(mean)

"""Input mappings of register combiners as lines, in any numbers: what packing and columns take them from."""

from fixedpipe.raster import codes as C


def mapping_lines(one, half, expanded):
    """{mapping: (whether it reads a negative number as 0, factor, addend)} in units in which these stand for
    one, for one half, and for what EXPAND_NORMAL subtracts.

    Source: NV_register_combiners table 4; Inferred: the halves (docs/numbers.md, section 8).
    """
    return {
        C.MAPPING_UNSIGNED_IDENTITY: (True, 1, 0),
        C.MAPPING_UNSIGNED_INVERT: (True, -1, one),
        C.MAPPING_EXPAND_NORMAL: (True, 2, -expanded),
        C.MAPPING_EXPAND_NEGATE: (True, -2, expanded),
        C.MAPPING_HALF_BIAS_NORMAL: (True, 1, -half),
        C.MAPPING_HALF_BIAS_NEGATE: (True, -1, half),
        C.MAPPING_SIGNED_IDENTITY: (False, 1, 0),
        C.MAPPING_SIGNED_NEGATE: (False, -1, 0),
    }

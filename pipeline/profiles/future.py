"""The board that Kautz and Seidel ask for (2000, section 5.1): a GeForce 3 with what it lacks."""

from dataclasses import replace

from fixedpipe.pipeline.enums import CombinerFunction
from fixedpipe.pipeline.profiles.geforce_3 import GEFORCE_3

_ASKED = "Source: Kautz, Seidel 2000, section 5.1 (asked for)"

FUTURE = replace(
    GEFORCE_3,
    name="Future board",
    description="what the papers ask for: wide combiners, evaluation before filtering, lookups",
    combiner_functions=frozenset(CombinerFunction),
    combiner_lookup=True,
    evaluate_before_filtering=True,
    spherical_interpolation=True,
    combiner_bits=16,
    combiner_range=256.0,
    evidence={
        **GEFORCE_3.evidence,
        "combiner_functions": _ASKED,
        "combiner_lookup": _ASKED,
        "evaluate_before_filtering": _ASKED,
        "spherical_interpolation": _ASKED,
        "combiner_bits": f"{_ASKED}; the width is Assumed: with_precision changes it",
        "combiner_range": "Assumed: -256 to 256, wide enough for what Ward's model divides",
    },
)

"""The board that Kautz and Seidel ask for (2000, section 5.1): a GeForce 3 with what it lacks."""

from fixedpipe.pipeline.enums import CombinerFunction
from fixedpipe.pipeline.profiles.geforce_3 import GEFORCE_3
from fixedpipe.pipeline.profiles.known import known

_ASKED = "Source: Kautz, Seidel 2000, section 5.1 (asked for)"

FUTURE = GEFORCE_3.descendant(
    name="Future board",
    description="what the papers ask for: wide combiners, evaluation before filtering, lookups",
    inherited="Assumed: as on the GeForce 3",
    combiner_functions=known(frozenset(CombinerFunction), _ASKED),
    combiner_lookup=known(True, _ASKED),
    evaluate_before_filtering=known(True, _ASKED),
    spherical_interpolation=known(True, _ASKED),
    combiner_bits=known(16, f"{_ASKED}; the width is Assumed: with_precision changes it"),
    combiner_range=known(256.0, "Assumed: -256 to 256, wide enough for what Ward's model divides"),
)

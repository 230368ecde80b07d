"""What tests of machines' passes share: a small field, its paths, and the light that passes leave."""

import numpy as np

from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scattering import dependent_tests, height_field, light_transport
from fixedpipe.effects.scattering.dependent_tests import RESULT, Accumulation, Setup
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.pipeline import execute, execute_ideal

TEXELS, DIRECTIONS = 16, 40
LIGHT = normalize(np.array([-0.7, -0.4, 1.0]))
VIEW = normalize(np.array([0.2, 0.1, 1.0]))
EXPOSURE = 0.4


def domes(specular=0.0):
    """Two by two domes of a warm albedo."""
    heights = height_field.domes(TEXELS, TEXELS, 2).heights
    return height_field.height_field(heights, (0.8, 0.6, 0.4), specular=specular, exponent=8.0)


def setup_of(field, profile, bits=8):
    """Two panels side by side in the window's lower left corner."""
    columns, rows = field.columns, field.rows
    work, total = Panel(0, 0, columns, rows), Panel(columns, 0, columns, rows)
    return Setup(field, precompute(field, spiral(DIRECTIONS)), profile, work, total, bits)


def shown(setup, commands, color_bits=8):
    """What commands leave as RESULT: RGB float64, bottom row first."""
    field, profile = setup.field, setup.profile
    drawn = (*commands, dependent_tests.textured("the result", setup.work, RESULT))
    if profile.arithmetic.exact:
        color = execute_ideal(drawn, 2 * field.columns, field.rows).color
    else:
        result = execute(drawn, profile, 2 * field.columns, field.rows, color_bits=color_bits)
        color = result.framebuffer.color / (2.0**color_bits - 1.0)
    return color[::-1, : field.columns, :3]


def error_of(
    way, profile, lookups, paths=20, *,
    accumulation=Accumulation.ACCUMULATION_BUFFER, specular=0.0, bits=8, color_bits=8,
):  # fmt: skip
    """RMS of what a machine's passes leave - the same paths in float64."""
    field = domes(specular)
    setup = setup_of(field, profile, bits)
    numbers = light_transport.sequences(DIRECTIONS, lookups, paths)
    drawn = dependent_tests.paths_drawn(
        way, setup, numbers, LIGHT, view=VIEW, accumulation=accumulation, exposure=EXPOSURE
    )
    expected = light_transport.scattered(field, setup.visibility, numbers, LIGHT, VIEW)
    return root_mean_square(shown(setup, drawn, color_bits) - EXPOSURE * expected)

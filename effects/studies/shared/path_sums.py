"""Sums of paths by machines' passes, for studies of scattered light (P14, P31)."""

import numpy as np

from fixedpipe.effects.geometry.vectors import normalize
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scattering import (
    dependent_tests,
    height_field,
    host_lookup_passes,
    light_transport,
    offset_texture_passes,
    pixel_texture_passes,
    texture_shader_passes,
)
from fixedpipe.effects.scattering.dependent_tests import RESULT, Setup
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.execution.machine import execute

# The machines on which the paths are drawn: the paper's first.
MACHINES = ("OCTANE", "GEFORCE_256", "GEFORCE_3", "NV2A", "G400")
TEXELS = 32
LIGHT = tuple(normalize(np.array([-0.78, 0.31, 1.0])).tolist())
# So that no path's light exceeds 1.
EXPOSURE = 0.75


def domes():
    """Domes of a grey albedo of 0.8."""
    return height_field.domes(TEXELS, TEXELS, 2, height=0.8)


def setup_of(profile, field, directions, bits=8):
    """A Setup on a window of two panels side by side, along ``directions`` of a spiral."""
    work, total = Panel(0, 0, TEXELS, TEXELS), Panel(TEXELS, 0, TEXELS, TEXELS)
    return Setup(field, precompute(field, spiral(directions)), profile, work, total, bits)


def way_of(profile):
    """How a machine draws paths, by its features."""
    operations = profile.texture_shaders.texture_shader_operations
    if profile.pixels.pixel_texture:
        return pixel_texture_passes.WAY
    if Operation.DEPENDENT_AR_TEXTURE_2D in operations:
        return texture_shader_passes.WAY
    return offset_texture_passes.WAY if Operation.OFFSET_TEXTURE_2D in operations else host_lookup_passes.WAY


def sums(setup, paths, accumulation, color_bits=8):
    """(the passes' result, the same paths in float64), float64 [rows, columns, 3] each, over EXPOSURE.

    ``paths``: int [paths, K].
    """
    way = way_of(setup.profile)
    drawn = (
        *dependent_tests.paths_drawn(way, setup, paths, LIGHT, accumulation=accumulation, exposure=EXPOSURE),
        dependent_tests.textured("the result", setup.work, RESULT),
    )
    framebuffer = execute(drawn, setup.profile, 2 * TEXELS, TEXELS, color_bits=color_bits).framebuffer
    found = framebuffer.color[::-1, :TEXELS, :3] / (2.0**color_bits - 1.0)
    expected = light_transport.scattered(setup.field, setup.visibility, paths, LIGHT)
    return found / EXPOSURE, expected

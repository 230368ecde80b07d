"""How machines draw dependent tests in figures, and which machines do: what documents 000 and 002 share."""

from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scattering import (
    host_lookup_passes,
    offset_texture_passes,
    pixel_texture_passes,
    texture_shader_passes,
)
from fixedpipe.effects.scattering.dependent_tests import Setup

# How machines draw dependent tests, and which do: the paper's board first.
WAYS = {
    "color matrix and pixel textures": pixel_texture_passes.WAY,
    "register combiners, lookups by the host": host_lookup_passes.WAY,
    "texture shaders": texture_shader_passes.WAY,
    "offset textures, bumps lit at vertices": offset_texture_passes.WAY,
}
MACHINES = {
    "color matrix and pixel textures": ("OCTANE",),
    "register combiners, lookups by the host": ("GEFORCE_256",),
    "texture shaders": ("GEFORCE_3", "NV2A"),
    "offset textures, bumps lit at vertices": ("G400",),
}


def largest_power(edge, most):
    """The largest power of two up to ``edge`` and ``most``, four at least."""
    return min(most, 1 << max(2, edge.bit_length() - 1))


def setup_of(profile, field, visibility, bits=8):
    """A Setup in the window's lower left corner."""
    columns, rows = field.columns, field.rows
    work, total = Panel(0, 0, columns, rows), Panel(columns, 0, columns, rows)
    return Setup(field, visibility, profile, work, total, bits)

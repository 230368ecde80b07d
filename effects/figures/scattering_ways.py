"""How machines draw dependent tests in figures, and which machines do: what documents 000 and 002 share."""

import numpy as np

from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering import (
    host_lookup_passes,
    offset_texture_passes,
    pixel_texture_passes,
    texture_shader_passes,
)
from fixedpipe.effects.scattering.dependent_tests import Setup
from fixedpipe.effects.scattering.visibility_textures import coordinates, looked_up_size
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.textures.images import texture_2d

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


def seen_picture(name, setup, number):
    """The command that loads S_i as a picture: s in red and t in green, black where a texel sees none."""
    field, seen = setup.field, setup.visibility.seen[number]
    codes = coordinates(seen, 8) / 255.0
    # The texture that is looked up is larger than the field: shown are coordinates of the field.
    whole = np.array([looked_up_size(field.columns) / field.columns, looked_up_size(field.rows) / field.rows])
    shown = np.zeros((*seen.shape, 3))
    shown[..., :2] = np.where((seen >= 0)[..., None], codes * whole, 0.0)
    image = texture_2d(factor_texels(np.minimum(shown, 1.0), setup.profile))
    return TexImage(label=f"load S_{number} as a picture", texture=name, image=image)

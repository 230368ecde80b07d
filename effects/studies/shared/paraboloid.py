"""A bump whose slopes grow evenly from its middle, lit from above: Eq. 1's highlight in one picture."""

import warnings

import numpy as np

from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.views import Light, Panel, orthographic_view
from fixedpipe.effects.passes.draws import NEAREST
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, brdfs, imaging_subset, material_textures
from fixedpipe.effects.studies.shared.strips import drawn

SIZE = 128
_PANEL = Panel(0, 0, SIZE, SIZE)
_VIEW = orthographic_view(_PANEL)
_ABOVE = Light((0.0, 0.0, 1.0))
_HALF = np.array([0.0, 0.0, 1.0])


def material(alpha, slope):
    """The bump with alpha_x = alpha_y = ``alpha``, as many texels as pixels; ``slope``: at its edges."""
    s, t = height_fields.texel_centers(SIZE, SIZE)
    return material_textures.from_slopes(slope * (2.0 * s - 1.0), slope * (2.0 * t - 1.0), alpha, alpha)


def true(bump, alpha):
    """Eq. 1 in float64, and both dot products: float64 [SIZE, SIZE] each, bottom row first."""
    value = brdfs.anisotropic_blinn_phong(_HALF, bump.tangents, bump.binormals, alpha, alpha)
    return value, bump.tangents[..., 2], bump.binormals[..., 2]


def by_imaging_subset(bump, profile, **arguments):
    """K08's picture, float64 [SIZE, SIZE]; arguments of ``imaging_subset.specular_passes``."""
    prepared = imaging_subset.prepare(surfaces.plane(), bump, _VIEW, profile, triangles_per_polygon=2)
    passes = imaging_subset.specular_passes(prepared, bump, _ABOVE, **arguments)
    return drawn((_PANEL.clear((0.0, 0.0, 0.0)), *passes), profile, SIZE, SIZE)[..., 0]


def by_register_combiners(bump, profile):
    """K07's picture, float64 [SIZE, SIZE]."""
    with warnings.catch_warnings():
        # Alphas that are stored as larger ones are what is measured.
        warnings.simplefilter("ignore", material_textures.StoredAlpha)
        loading, names = material_textures.load(bump, "bump", profile)
    passes = anisotropic_blinn_phong.specular_pass(
        surfaces.plane(), names, _VIEW, _ABOVE, profile, first=True, sampler=NEAREST
    )
    return drawn((_PANEL.clear((0.0, 0.0, 0.0)), *loading, *passes), profile, SIZE, SIZE)[..., 0]

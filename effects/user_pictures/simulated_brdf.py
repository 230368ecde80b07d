"""The BRDF of a user's height field: simulated, written as files for other programs, and shown on a ball.

An NPZ file holds

    samples       float64 [n, n, n, n, 3]: f_r, RGB per steradian, over z of the light's direction, its angle
                  around z, and those of the view's
    z, angle      float64 [n]: the samples' places; angles in radians from the field's first axis (s) to its
                  second (t)
    coefficients  float64 [16, 16, 3]: of products of the real spherical harmonics of four bands, of the light
                  and of the view (``effects/scattering/harmonics.py``)
    description   a text about the simulation

A MERL file is isotropic (``effects/scattering/merl.py``): the mean over rotations of the field about z.
"""

import io
import math

import numpy as np

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, orthographic_view
from fixedpipe.effects.passes.draws import FIRST_PASS, draw
from fixedpipe.effects.passes.encoding import colors_of, factor_texels
from fixedpipe.effects.scattering import dense_brdf, harmonics, height_field, merl
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.visibility import precompute
from fixedpipe.effects.user_pictures import maps

# How a form's files are named.
ENDINGS = {"merl": (".binary",), "npz": (".npz",)}


def field_of(heights, texels=32, relief=0.25, albedo=0.8):
    """The scattering HeightField of heights that ``maps.height_field`` takes, repeated without seams.

    texels  along each edge
    relief  of the highest point over the lowest, in edges of the field
    albedo  a number or RGB, 0 to 1

    Raises ValueError for heights that are none, and as ``height_field.height_field``.
    """
    if texels < 2:
        raise ValueError(f"The field has {texels} texels along an edge; give 2 or more.")
    fitted = maps.height_field(heights).fitted(texels, texels, float(relief), repeated=True)
    return height_field.height_field(fitted, albedo)


def simulated(field, *, directions=100, bounces=2, grid=16, folder=None, executor=None, progress=None):
    """The DenseBRDF of a scattering HeightField: as ``dense_brdf.simulated``, of so many directions."""
    seen = precompute(field, spiral(directions))
    return dense_brdf.simulated(
        field, seen, grid, bounces, folder=folder, executor=executor, progress=progress
    )


def by_harmonics(field, *, directions=100, bounces=2, samples=512):
    """The HarmonicBRDF of a scattering HeightField from so many random samples."""
    seen = precompute(field, spiral(directions))
    return harmonics.fitted(*harmonics.sampled(field, seen, samples, bounces))


def npz(dense, harmonic, description):
    """The bytes of an NPZ file."""
    stream, n = io.BytesIO(), dense.count
    np.savez(
        stream,
        samples=dense.samples,
        z=(np.arange(n) + 0.5) / n,
        angle=2.0 * math.pi * (np.arange(n) + 0.5) / n,
        coefficients=harmonic.coefficients,
        description=np.array(description),
    )
    return stream.getvalue()


def merl_file(dense):
    """The bytes of a MERL file of the mean over rotations."""
    return merl.data(merl.table(dense.isotropic()))


def ball(dense, profile, size, light):
    """Commands that draw a ball with the BRDF: f_r(l, v) times pi and the light's cosine at its vertices, the
    field's first axis to the east.

    light  direction to it: x to the right, y up, z towards the viewer
    """
    panel = Panel(0, 0, size, size)
    view = orthographic_view(panel, 1.1)
    surface = surfaces.sphere(128, 64)
    towards = surface.to_local(unit_vector(light, "The light's direction"))
    views = surface.to_local(np.array(view.eye))
    both = (towards[:, 2] > 1e-3) & (views[:, 2] > 1e-3)
    radiance = np.zeros(towards.shape)
    found = dense.at(normalize(towards[both]), normalize(views[both]))
    radiance[both] = math.pi * found * towards[both, 2:]
    colors = colors_of(factor_texels(np.clip(radiance, 0.0, 1.0), profile))
    return (
        panel.clear(BACKGROUND),
        draw("f_r(l, v) at the vertices", surface.mesh(colors=colors), view, None, depth_test=FIRST_PASS),
    )

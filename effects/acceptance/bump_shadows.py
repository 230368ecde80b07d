"""Shadows of bumps against rays: how many texels that face a light an algorithm lights as rays do.

An algorithm is a function of a light, a unit vector [3] above the horizon. It says which texels are lit: bool
[rows, columns]. Texels that face away from the light do not count, because their cosine is zero.
"""

import math
from collections.abc import Callable, Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import cosine, dot, sine
from fixedpipe.effects.geometry.views import Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, LATER_PASS, MARKED, NEAREST, draw
from fixedpipe.effects.scattering import (
    directions,
    ellipse_passes,
    ellipses,
    horizon_maps,
    visibility,
    visibility_shadows,
)
from fixedpipe.pipeline.execution.machine import execute

LitTexels: TypeAlias = Callable[[NDArray[np.float64]], NDArray[np.bool_]]

# Degrees above the horizon and round it, none along an azimuth of a horizon map.
ELEVATIONS = (15.0, 30.0, 45.0, 60.0)
AZIMUTHS = tuple(11.0 + 45.0 * k for k in range(8))


def lights(elevations=ELEVATIONS, azimuths=AZIMUTHS):
    """Unit vectors towards lights at every elevation and azimuth, in degrees: float64 [n, 3]."""
    out = []
    for elevation in elevations:
        for azimuth in azimuths:
            up, around = math.radians(elevation), math.radians(azimuth)
            level = float(cosine(up))
            out.append((level * float(cosine(around)), level * float(sine(around)), float(sine(up))))
    return np.array(out)


def ways(field, count):
    """The ways of the host for a HeightField, with ``count`` directions over the whole sphere: a dict of them
    by name. Horizons have a byte for an azimuth.
    """
    seen = visibility.precompute(field, directions.spiral(count))
    fitted = ellipses.of_visibility(seen)
    sines = np.floor(255.0 * horizon_maps.horizon_map(field).sines + 0.5) / 255.0
    triangles = directions.triangulated(seen.directions)
    return {
        "nearest direction": lambda light: visibility_shadows.nearest_free(seen, light),
        "three directions": lambda light: visibility_shadows.free_share(seen, light, triangles) > 0.5,
        "ellipses": lambda light: fitted.test(light[0], light[1]) >= 0.0,
        "horizons": lambda light: horizon_maps.lit(sines, light),
    }


def _marked(field, profile, passes, depths=True):
    """Where a machine marks a square of one pixel for each texel: bool [rows, columns].

    passes  (surface, view) -> the commands that mark it
    depths  whether its depths are drawn before them
    """
    (panel,) = row_of_panels(1, field.rows)
    view, square = orthographic_view(panel), surfaces.plane()
    black, white = (square.mesh(colors=np.full((4, 3), c)) for c in (0.0, 1.0))
    commands = (
        panel.clear((0.0, 0.0, 0.0)),
        *((draw("depths", black, view, None, depth_test=FIRST_PASS),) if depths else ()),
        *passes(square, view),
        draw("black", black, view, None, depth_test=LATER_PASS),
        draw("show the marks", white, view, None, depth_test=LATER_PASS, stencil_test=MARKED),
    )
    framebuffer = execute(commands, profile, field.columns, field.rows).framebuffer
    return framebuffer.color[::-1, :, 0] > 2 ** (framebuffer.color_bits - 1)


def ways_of_combiners(field, count, profile):
    """G15 and G17 on a machine with register combiners: a dict of ways by name. ``field``: a square one."""
    forms = ellipses.rooted(ellipses.of_visibility(visibility.precompute(field, directions.spiral(count))))
    horizons = horizon_maps.horizon_map(field)

    def elliptic(light):
        def passes(square, view):
            lamp = Light(tuple(map(float, light)))
            mark = ellipse_passes.marking_pass(square, forms, view, lamp, profile, sampler=NEAREST)
            return *ellipse_passes.load(forms, profile), ellipse_passes.clear_marks(view), mark

        return _marked(field, profile, passes)

    def horizontal(light):
        def passes(square, view):
            mark = horizon_maps.marking_pass(square, horizons, view, light, sampler=NEAREST)
            return *horizon_maps.load(horizons, profile), ellipse_passes.clear_marks(view), mark

        return _marked(field, profile, passes)

    return {"ellipses": elliptic, "horizons": horizontal}


def ways_of_the_imaging_subset(field, count, profile):
    """G16 on a machine with the imaging subset: a dict of one way. ``field``: a square one."""
    forms = ellipses.rooted(ellipses.of_visibility(visibility.precompute(field, directions.spiral(count))))

    def elliptic(light):
        def passes(square, view):
            lamp = Light(tuple(map(float, light)))
            return ellipse_passes.imaging_marking_passes(square, forms, view, lamp, profile, sampler=NEAREST)

        return _marked(field, profile, passes, depths=False)

    return {"ellipses": elliptic}


def agreement(field, told: Mapping[str, LitTexels], towards=None):
    """For every way, by its name, the share of the texels facing a light that it lights as rays do.

    field    a HeightField
    towards  unit vectors [n, 3]; None: ``lights()``
    """
    right, asked = dict.fromkeys(told, 0), 0
    for light in lights() if towards is None else towards:
        faces = dot(field.normals, light) > 0.0
        free = visibility.free_view(field, light)
        for name, way in told.items():
            right[name] += int((way(light) == free)[faces].sum())
        asked += int(faces.sum())
    return {name: count / asked for name, count in right.items()}

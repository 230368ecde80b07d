"""The brushed sphere of F004-4 and K04: how finely it is cut, and how it is brushed.

``leaning_seen`` and COMPARED: what checks compare of the spheres of F004-4 to F004-6.
"""

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.figures import parameters as word

# The parameters of ``material_textures.brushed`` and of the sphere; alphas are each figure's own.
BRUSHED_SPHERE = {
    "slices": word.SLICES(50),
    "stacks": word.STACKS(26),
    "map_columns": word.TEXELS(512, "Columns of the material's textures: texels around the axis."),
    "map_rows": word.TEXELS(256, "Rows of the material's textures: texels from pole to pole."),
    "spread": word.SPREAD(8.0),
    "depth": word.STROKE_DEPTH(0.25),
    "k_s": word.K_S((0.5, 1.0)),
}

# How far from the middle, in degrees of the sphere, pixels are compared with the reference. There flat
# triangles of 7 degrees, up to 0.004 below the sphere, shift the material by at most as much.
COMPARED = 45.0


def leaning_seen(values, size, flat):
    """The pixels of the sphere of F004-5 and F004-6 (``scenes.spheres.leaning_sphere``) that are compared:
    Seen.

    ``values``: the figure's own. ``flat``: whether each triangle is.
    """
    facets = (values["slices"], values["stacks"]) if flat else None
    turns = ("x", -values.get("tilt", 0.0)), ("z", values["lean"])
    return seen_places.sphere(size, values["radius"], turns, COMPARED, values["repeats"], facets)

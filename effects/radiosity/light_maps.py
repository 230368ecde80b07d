"""A radiosity solution as textures: a light map for each rectangle, drawn in one pass, and read by rays.

A light map's texel is an element; their centres coincide. Elements below a thing receive no light. They take
their neighbours' values, so that a filter draws no dark seams along the thing's foot.

Source: Heidrich 2001, section 1.4.
"""

import numpy as np

from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType
from fixedpipe.pipeline.textures.images import texture_2d

_ABOVE = 1.0e-6


def _filled(values, known):
    """Values [rows, columns, 3], the unknown ones the mean of known neighbours, from the edge inwards."""
    while not known.all() and known.any():
        total, count = np.zeros_like(values), np.zeros(known.shape)
        for axis in (0, 1):
            for step in (1, -1):
                beside, there = np.roll(values, step, axis), np.roll(known, step, axis)
                edge = [slice(None), slice(None)]
                edge[axis] = 0 if step == 1 else -1
                there[tuple(edge)] = False
                total = total + np.where(there[..., None], beside, 0.0)
                count = count + there
        reached = ~known & (count > 0.0)
        values = np.where(reached[..., None], total / np.maximum(count, 1.0)[..., None], values)
        known = known | reached
    return values


def light_maps(rectangles, radiosity, things=(), exposure=1.0):
    """Light maps by rectangles' names, float64 [rows, columns, 3].

    radiosity  a ``Solution``'s; ``things`` as its solver takes them
    exposure   the factor of all values, positive
    """
    if not 0.0 < exposure < np.inf:
        raise ValueError(f"The exposure is {exposure!r}; give a positive number.")
    out = {}
    for rectangle in rectangles:
        above = rectangle.centers() + _ABOVE * rectangle.normal
        known = np.ones(above.shape[:2], bool)
        for thing in things:
            known &= ~thing.holds(above)
        out[rectangle.name] = exposure * _filled(radiosity[rectangle.name], known)
    return out


def load(maps, profile, title="light map"):
    """Commands that load light maps as textures; numbers above one are clamped, except on the ideal."""
    return tuple(
        TexImage(
            label=f"load {title} of the {name}",
            texture=f"{title}, {name}",
            image=texture_2d(factor_texels(values, profile)),
        )
        for name, values in maps.items()
    )


_CORNERS = np.array(((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)))


def mesh(rectangle, columns=1):
    """A rectangle as quadrilaterals, ``columns`` squared, their texture coordinates over the light map."""
    j, i = np.divmod(np.arange(columns * columns), columns)
    corner = np.stack([i, j], axis=-1)[:, None]
    s, t = np.moveaxis((corner + _CORNERS) / columns, -1, 0)
    places = rectangle.corner + s[..., None] * rectangle.across + t[..., None] * rectangle.up
    return Mesh(
        places.reshape(-1, 3),
        PrimitiveType.QUADS,
        texture_coordinates=(np.stack([s, t], axis=-1).reshape(-1, 2),),
    )


def passes(rectangles, view, sampler=EDGE, title="light map", **settings):
    """A draw for each rectangle: its light map replaces what comes in. ``settings``: of ``draws.draw``."""
    settings = {"depth_test": FIRST_PASS, **settings}
    return tuple(
        draw(
            f"{title} of the {rectangle.name}",
            mesh(rectangle),
            view,
            None,
            (unit(f"{title}, {rectangle.name}", sampler, environment=REPLACE),),
            **settings,
        )
        for rectangle in rectangles
    )


def nearest(rectangles, origins, toward):
    """What rays meet: the number of a rectangle, int64 [n] (-1: none), and where on it, s and t, float64 [n].

    origins, toward  float64 [n, 3]; a rectangle is seen from its front
    """
    number = np.full(len(toward), -1)
    distance, s, t = np.full(len(toward), np.inf), np.zeros(len(toward)), np.zeros(len(toward))
    for k, rectangle in enumerate(rectangles):
        facing = dot(toward, rectangle.normal)
        meets = facing < 0.0
        along = dot(rectangle.corner - origins, rectangle.normal) / np.where(meets, facing, 1.0)
        place = origins + along[:, None] * toward - rectangle.corner
        at_s = dot(place, rectangle.across) / dot(rectangle.across, rectangle.across)
        at_t = dot(place, rectangle.up) / dot(rectangle.up, rectangle.up)
        inside = (np.minimum(at_s, at_t) >= 0.0) & (np.maximum(at_s, at_t) <= 1.0)
        nearer = meets & (along > 0.0) & (along < distance) & inside
        number = np.where(nearer, k, number)
        distance, s, t = (
            np.where(nearer, new, old) for new, old in ((along, distance), (at_s, s), (at_t, t))
        )
    return number, s, t


def look_up(values, s, t):
    """A light map [rows, columns, 3] at places [n] in [0, 1], bilinear, its edge beyond: float64 [n, 3]."""
    rows, columns = values.shape[:2]
    corner = []
    for place, count in ((s, columns), (t, rows)):
        at = np.clip(place * count - 0.5, 0.0, count - 1.0)
        low = np.minimum(np.floor(at).astype(np.int64), max(count - 2, 0))
        corner.append((low, np.minimum(low + 1, count - 1), (at - low)[:, None]))
    (i, i1, u), (j, j1, v) = corner
    lower = values[j, i] + u * (values[j, i1] - values[j, i])
    upper = values[j1, i] + u * (values[j1, i1] - values[j1, i])
    return lower + v * (upper - lower)


def seen(rectangles, maps, origin, toward):
    """The room's light from directions [..., 3] at a point, by its light maps: RGB float64 [..., 3].

    Directions through a gap see black.
    """
    flat = np.asarray(toward, np.float64).reshape(-1, 3)
    number, s, t = nearest(rectangles, np.broadcast_to(np.asarray(origin, np.float64), flat.shape), flat)
    colors = np.zeros(flat.shape)
    for k, rectangle in enumerate(rectangles):
        of = number == k
        colors[of] = look_up(maps[rectangle.name], s[of], t[of])
    return colors.reshape(np.shape(toward))

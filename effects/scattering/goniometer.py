"""G23 and G24: the BRDF of a height field, measured by a virtual goniometer.

A sample f_r(l, v) is the mean radiance seen from v with light from l, over the irradiance of the mean plane.
It combines two independent arrays:

    lights   the light that every texel sends back, one array for each l, with shadows and scattering
    shares   every texel's part of the picture from v, one array for each v

So a grid of n lights and m views costs n + m computations, and a sum over texels for each pair. That holds
for a diffuse field. Highlights depend on both directions, and are added pair by pair.

Pictures give the shares by counting: rays from v cast one period of the field (G23). Or texture space gives
them (G24): a texel has V(p, v) (n_p.v)+ / n_p.z, the area that it turns towards v. V says whether the texel
is masked, by rays or by any other shadow test, since masking is the same test.

Radiances are in units of the light that a white surface facing the lamp sends back. So f_r is the mean over
pi and the irradiance, per steradian; a flat field has albedo / pi.

Source: Heidrich, Daubert, Kautz, Seidel 2000, section 6; pass sequences A-G23 and A-G24. Inferred: highlights
are scattered once; further scattering is diffuse.
"""

import math

import numpy as np

from fixedpipe.effects.geometry.vectors import cosine, dot, normalize, sine
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering.light_transport import bump, gathered
from fixedpipe.effects.scattering.visibility import FREE, check_same_texels, precompute
from fixedpipe.effects.technique import Technique
from fixedpipe.raster.kernel import kernel

TECHNIQUES = (
    Technique("G23", "a BRDF by a virtual goniometer: mean radiance in pictures of a height field", "6"),
    Technique("G24", "a virtual goniometer in texture space: masking by the test for shadows", "6"),
)

# Assumed: farther than any picture's rays go that shows more than one texel of each period.
MOST_PERIODS = 2**14
# A ray that meets no triangle of the field: only one that does not come down.
NOTHING = -1


@kernel("void(float64[:, ::1], float64[:, ::1], float64[:, ::1], int32[::1])")
def _first_hits(heights, origins, along, out):
    """The texels that rays from above meet first; x, y and their steps in texels, z in heights."""
    rows, columns = heights.shape
    for ray in range(len(origins)):
        x0, y0, z0 = origins[ray, 0], origins[ray, 1], origins[ray, 2]
        dx, dy, dz = along[ray, 0], along[ray, 1], along[ray, 2]
        out[ray] = NOTHING
        if dz >= 0.0:
            continue
        x, y, t, before, t_before = x0, y0, 0.0, 0.0, 0.0
        infinity = np.inf
        # The lines between triangles that the ray meets: whole x, whole y, whole x - y.
        next_x = np.floor(x0) + 1.0 if dx > 0.0 else np.ceil(x0) - 1.0
        next_y = np.floor(y0) + 1.0 if dy > 0.0 else np.ceil(y0) - 1.0
        d0, dd = x0 - y0, dx - dy
        next_d = np.floor(d0) + 1.0 if dd > 0.0 else np.ceil(d0) - 1.0
        first = True
        while True:
            i, j = int(np.floor(x)), int(np.floor(y))
            u, v = x - i, y - j
            c0, c1 = i % columns, (i + 1) % columns
            r0, r1 = j % rows, (j + 1) % rows
            low, high = heights[r0, c0], heights[r1, c1]
            if u >= v:
                side = heights[r0, c1]
                field = (low + u * (side - low)) + v * (high - side)
            else:
                side = heights[r1, c0]
                field = (low + v * (side - low)) + u * (high - side)
            above = (z0 + t * dz) - field
            last = dx == 0.0 and dy == 0.0
            if above <= 0.0 or last:
                if not first and above < 0.0:
                    at = t_before + before / (before - above) * (t - t_before)
                    x, y = x0 + at * dx, y0 + at * dy
                i, j = int(np.floor(x + 0.5)) % columns, int(np.floor(y + 0.5)) % rows
                out[ray] = j * columns + i
                break
            before, t_before, first = above, t, False
            t_x = (next_x - x0) / dx if dx != 0.0 else infinity
            t_y = (next_y - y0) / dy if dy != 0.0 else infinity
            t_d = (next_d - d0) / dd if dd != 0.0 else infinity
            t = min(t_x, min(t_y, t_d))
            x, y = x0 + t * dx, y0 + t * dy
            if t == t_x:
                next_x += 1.0 if dx > 0.0 else -1.0
            if t == t_y:
                next_y += 1.0 if dy > 0.0 else -1.0
            if t == t_d:
                next_d += 1.0 if dd > 0.0 else -1.0


@kernel("void(float64[:, ::1], float64[:, :, ::1], float64[:, :, ::1])")
def _means(shares, lights, out):
    """The sum over texels of shares [views, texels] times lights [lights, texels, 3], in order."""
    for i in range(len(lights)):
        for j in range(len(shares)):
            red, green, blue = 0.0, 0.0, 0.0
            for p in range(shares.shape[1]):
                share = shares[j, p]
                if share != 0.0:
                    red += share * lights[i, p, 0]
                    green += share * lights[i, p, 1]
                    blue += share * lights[i, p, 2]
            out[i, j, 0], out[i, j, 1], out[i, j, 2] = red, green, blue


def upper(directions, what="The directions"):
    """Directions of the upper hemisphere as float64 [n, 3] of length one.

    Raises ValueError as ``directions.checked``, and for one that is not above the horizon.
    """
    found = sphere.checked(directions)
    if not (found[:, 2] > 0.0).all():
        worst = found[int(np.argmin(found[:, 2]))]
        raise ValueError(
            f"{what} hold {tuple(worst.tolist())}, which is not above the horizon; leave it out."
        )
    return found


def first_texels(field, origins, along):
    """The texels that rays from above a HeightField meet first: int32 [n], row * columns + column, NOTHING
    for a ray that does not descend. The field goes on for ever.

    origins  float64 [n, 3], s and t in periods, z in heights: not below the field
    along    float64 [n, 3]: the rays' directions, of any length

    Raises ValueError for other shapes, NaN or infinity, and for rays that may cross more than MOST_PERIODS
    before they have come down to the field's lowest point.
    """
    origins, along = np.asarray(origins, np.float64), np.asarray(along, np.float64)
    if origins.ndim != 2 or origins.shape[1] != 3 or along.shape not in ((3,), origins.shape):
        raise ValueError(f"The rays have shapes {origins.shape} and {along.shape}; give [n, 3] and as many.")
    if not (np.isfinite(origins).all() and np.isfinite(along).all()):
        raise ValueError("The rays hold NaN or infinity; give finite points and directions.")
    down = along[..., 2] < 0.0
    falling = np.where(down, -along[..., 2], 1.0)
    fall = np.maximum(origins[:, 2] - float(field.heights.min()), 0.0)
    periods = (np.abs(along[..., 0]) + np.abs(along[..., 1])) / falling * fall
    # Where a ray begins counts too: far away its coordinates have no digits left.
    farthest = np.maximum(
        np.abs(origins[:, :2]).max(axis=1, initial=0.0) / 1024.0, np.where(down, periods, 0.0)
    )
    if not (farthest <= MOST_PERIODS).all():
        raise ValueError(
            f"A ray crosses {float(farthest.max()):g} periods of the field before it has come down, and "
            f"{MOST_PERIODS} are the most; give steeper ones, and points nearer to the field."
        )
    scale = np.array([float(field.columns), float(field.rows), 1.0])
    place = np.ascontiguousarray(origins * scale)
    place[:, :2] -= 0.5
    out = np.empty(len(place), np.int32)
    step = np.broadcast_to(along, place.shape) * scale
    _first_hits(field.heights, place, np.ascontiguousarray(step), out)
    return out


def check_size(size):
    """A picture's pixels along an edge. Raises ValueError where they are no whole number from 1 on."""
    if not size >= 1 or int(size) != size:
        raise ValueError(f"The picture has {size!r} pixels along an edge; give a whole number from 1 on.")
    return int(size)


def picture(field, view, size):
    """The texels in an orthographic picture of one period from ``view`` [3]: int32 [size, size], bottom row
    first.

    A pixel is a point of the mean plane, so the picture is registered to the field's texture coordinates.

    Raises ValueError for a view that is not above the horizon, or hardly (``first_texels``), and for a size
    below one.
    """
    size = check_size(size)
    (view,) = upper(np.asarray(view, np.float64)[None], "The views")
    place = (np.arange(size) + 0.5) / size
    s, t = (axis.ravel() for axis in np.meshgrid(place, place))
    mean, highest = float(field.heights.mean()), float(field.heights.max())
    # From the mean plane back towards the viewer, until above everything.
    back = (highest - mean) / view[2]
    origins = np.stack([s + back * view[0], t + back * view[1], np.full(s.shape, highest)], axis=-1)
    return first_texels(field, origins, -view).reshape(size, size)


def shares_in_pictures(field, views, size=None):
    """G23: each texel's part of pictures of one period from views [m, 3]: float64 [m, rows, columns].

    A view's parts sum to one.

    size  pixels along an edge; None: four for each texel along the longer edge
    """
    size = 4 * max(field.rows, field.columns) if size is None else check_size(size)
    texels = field.rows * field.columns
    counts = [np.bincount(picture(field, view, size).ravel(), minlength=texels) for view in upper(views)]
    return np.stack(counts).reshape(len(counts), field.rows, field.columns) / float(size * size)


def shares_in_texture_space(field, views, visible=None):
    """G24: the same in texture space, by V(p, v) (n_p.v)+ / n_p.z.

    visible  bool or float [m, rows, columns]: where texels are not masked. None: by rays, or by a picture if
             the view is so near the horizon that every texel's centre is masked

    Raises ValueError for masks of another shape, and for one that masks every texel.
    """
    views = upper(views)
    shape = (len(views), field.rows, field.columns)
    by_rays = visible is None
    visible = precompute(field, views).seen == FREE if visible is None else np.asarray(visible)
    if visible.shape != shape:
        raise ValueError(f"The masks have shape {visible.shape}; give {shape}: one for each view.")
    turned = np.stack([np.maximum(dot(field.normals, view), 0.0) for view in views])
    area = visible * turned / field.normals[..., 2]
    total = np.zeros(len(views))
    for texel in area.reshape(len(views), -1).T:
        total += texel
    empty = np.flatnonzero(total <= 0.0)
    if len(empty) and by_rays:
        area[empty], total[empty] = shares_in_pictures(field, views[empty]), 1.0
    elif len(empty):
        worst = views[empty[0]]
        raise ValueError(f"Nothing of the field is seen from {tuple(worst.tolist())}; leave that view out.")
    return area / total[:, None, None]


def _cosines(field, towards, lit):
    """(n_p.l)+ where the light is not shadowed: float64 [n, rows, columns]."""
    lit = precompute(field, towards).seen == FREE if lit is None else np.asarray(lit)
    return np.stack([np.maximum(dot(field.normals, light), 0.0) for light in towards]) * lit


def irradiance(field, towards, lit=None):
    """The irradiance of the mean plane by lights of one from ``towards`` [n, 3], as the texels receive it:
    float64 [n], the mean of V (n_p.l)+ / n_p.z.

    This equals the light's cosine, except that a texel is lit or dark as a whole. Divided by it, f_r
    conserves energy, and is the same for l and v in either order. The cosine itself where no texel's centre
    is lit.
    """
    towards = upper(towards, "The lights")
    area = (_cosines(field, towards, lit) / field.normals[..., 2]).reshape(len(towards), -1)
    total = np.zeros(len(towards))
    for texel in area.T:
        total += texel
    return np.where(total > 0.0, total / area.shape[1], towards[:, 2])


def lights(field, visibility, towards, bounces=2, lit=None):
    """The diffuse light that a HeightField's texels send back of lights from ``towards`` [n, 3]: float64 [n,
    rows, columns, 3].

    bounces  reflections beyond the first, each gathered from all directions of the Visibility; 0: only direct
             light with its shadows
    lit      bool or float [n, rows, columns]: where each light is not shadowed; None: by rays

    Raises ValueError for lights that are not above the horizon, fewer bounces than none, and another field's
    Visibility.
    """
    check_same_texels(field, visibility)
    if bounces < 0:
        raise ValueError(f"There are {bounces!r} bounces; give a whole number from 0 on.")
    cosines = _cosines(field, upper(towards, "The lights"), lit)
    # All lights at once: what is gathered has three components for each.
    rows, columns = field.heights.shape
    albedo = np.tile(field.albedo, (1, 1, len(cosines)))
    sent = albedo * np.repeat(np.moveaxis(cosines, 0, -1), 3, axis=-1)
    total = sent
    for _ in range(bounces):
        sent = albedo * gathered(field, visibility, sent)
        total = total + sent
    return np.ascontiguousarray(np.moveaxis(total.reshape(rows, columns, len(cosines), 3), 2, 0))


def means(shares, sent):
    """The mean radiance in every picture: float64 [n, m, 3] of lights [n, rows, columns, 3] and shares [m,
    rows, columns].

    Raises ValueError if they do not have the same texels.
    """
    if sent.shape[1:] != (*shares.shape[1:], 3):
        raise ValueError(
            f"The light has shape {sent.shape} and the shares {shares.shape}; give [n, rows, columns, 3] and "
            "[m, rows, columns] of one field."
        )
    out = np.empty((len(sent), len(shares), 3))
    flat = np.ascontiguousarray(shares.reshape(len(shares), -1))
    _means(flat, np.ascontiguousarray(sent.reshape(len(sent), -1, 3)), out)
    return out


def pair_means(shares, sent):
    """The same for the n-th light with the n-th share alone: float64 [n, 3]."""
    total = np.zeros((len(sent), 3))
    weights = shares.reshape(len(shares), -1)
    parts = sent.reshape(len(sent), -1, 3)
    for texel in range(weights.shape[1]):
        total += weights[:, texel, None] * parts[:, texel]
    return total


def highlights(field, towards, views, shares):
    """The light that a field's highlights add to ``means``: float64 [n, m, 3]; 0 for a diffuse field."""
    out = np.zeros((len(towards), len(views), 3))
    if not field.specular:
        return out
    glossy = field.with_albedo(0.0)
    for i, light in enumerate(towards):
        free = precompute(field, light[None]).seen[0] == FREE
        for j, view in enumerate(views):
            shine = bump(glossy, light, view) * (free * shares[j])[..., None]
            out[i, j] = shine.reshape(-1, 3).sum(axis=0)
    return out


def brdf(field, visibility, towards, views, bounces=2, shares=None):
    """f_r(l, v) of a HeightField for all pairs: float64 [n, m, 3], RGB per steradian.

    towards, views  unit vectors [n, 3] and [m, 3], above the horizon
    bounces         as for ``lights``
    shares          of the views, by any of the ways; None: in texture space, masked by rays

    Raises ValueError for directions that are none or not above the horizon.
    """
    towards, views = upper(towards, "The lights"), upper(views, "The views")
    shares = shares_in_texture_space(field, views) if shares is None else shares
    radiance = means(shares, lights(field, visibility, towards, bounces))
    radiance += highlights(field, towards, views, shares)
    return radiance / (math.pi * irradiance(field, towards))[:, None, None]


def grid(count):
    """``count`` x ``count`` directions over the upper hemisphere, and the solid angle that each stands for:
    float64 [count * count, 3] and float64 [count * count], which sum to 2 pi.

    Equal steps of z, from the horizon's to the zenith's, and of the angle around it, each in its middle.
    """
    if not count >= 1 or int(count) != count:
        raise ValueError(f"A grid has {count} directions along its edges; give a whole number, 1 or more.")
    z = (np.repeat(np.arange(count), count) + 0.5) / count
    angle = 2.0 * math.pi * (np.tile(np.arange(count), count) + 0.5) / count
    around = np.sqrt(1.0 - z * z)
    found = normalize(np.stack([around * cosine(angle), around * sine(angle), z], axis=-1))
    return found, np.full(len(found), 2.0 * math.pi / len(found))


def albedos(samples, views, solid_angles):
    """The share of light from every l that is sent back into the views: float64 [n, 3], the sum of f_r cosine
    solid angle.
    """
    total = np.zeros((len(samples), 3))
    for j in range(len(views)):
        total += samples[:, j] * (views[j, 2] * solid_angles[j])
    return total

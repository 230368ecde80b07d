"""Pictures of document 004's materials in float64, pixel by pixel: Eq. 1 of the paper and (n.l)+ from a
material's fields.

Nothing here is shared with what draws: where a pixel lies on the sphere or the square, the local frames, the
filter and the shading are its own. ``least_share`` says how much of each field's effect a picture shows: none
if the field is missing or lies elsewhere.

Source: Kautz, Seidel 2000, sections 3 and 4, Eq. 1 (E004.1 of the catalogue: the gate).
"""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.seen_places import filtered, looked_up, unit
from fixedpipe.effects.geometry.views import panel_of

# The viewer is far away in front of the picture.
_EYE = np.array([0.0, 0.0, 1.0])


def fields(material):
    """What a material's three textures hold, by names: float64 [rows, columns, 3 or 4]."""
    return {
        "normals": material.normals,
        "tangents": np.concatenate(
            [material.tangents / material.alpha_x[..., None], material.k_s[..., None]], axis=-1
        ),
        "binormals": material.binormals / material.alpha_y[..., None],
    }


def shaded(textures, seen, light, gated=True, squared_first=False, eye=_EYE):
    """(n.l)+ and Eq. 1 at the pixels: float64 [n] each, the second times the gate min(1, 4 (n.l)+).

    textures       as ``fields`` gives them
    light          towards it
    gated          whether there is a gate
    squared_first  products are squared, and cut off, at the texels, and filtered then
    eye            towards it: a vector, or one for each pixel, [n, 3]
    """
    toward = unit(np.array(light, np.float64))
    lamp, half = ((seen.frames @ v[..., None])[..., 0] for v in (toward, unit(toward + unit(eye))))

    def at(name, vectors, change):
        field = textures[name][..., :3]
        if not squared_first:
            return change((looked_up(field, seen) * vectors).sum(axis=-1))
        return filtered(lambda j, i: change((field[j, i] * vectors).sum(axis=-1)), *field.shape[:2], seen)

    lit = at("normals", lamp, lambda d: np.maximum(d, 0.0))
    gate = at("normals", lamp, lambda d: np.clip(4.0 * d, 0.0, 1.0)) if gated else 1.0
    squares = sum(at(name, half, lambda d: np.minimum(d * d, 1.0)) for name in ("tangents", "binormals"))
    k_s = looked_up(textures["tangents"][..., 3], seen)
    return lit, gate * k_s * np.maximum(1.0 - squares, 0.0)


def picture(textures, seen, values, *, color=1.0, gated=True, squared_first=False, eye=_EYE):
    """The displayed colours of ``shaded`` with a figure's own ``values``: float64 [n, 3].

    ``color``: of the surface, by which diffuse and ambient light are multiplied, [n, 3]. ``eye``: as for
    ``shaded``.
    """
    lit, specular = shaded(textures, seen, values["light"], gated, squared_first, eye)
    diffuse, ambient, strength = (np.array(values[name]) for name in ("diffuse", "ambient", "specular"))
    out = (lit[:, None] * diffuse + ambient) * color + specular[:, None] * strength
    return np.clip(out, 0.0, 1.0)


def pictures(textures, seen, values, **how):
    """``picture``, then for each field the same with the field's mean in its place: float64 [1 + fields, n,
    3].
    """
    out = [picture(textures, seen, values, **how)]
    for name, field in textures.items():
        mean = np.broadcast_to(field.mean(axis=(0, 1)), field.shape)
        out.append(picture({**textures, name: mean}, seen, values, **how))
    return np.stack(out)


def least_share(shown, whole, *without):
    """The least share, of several fields, of (whole - without) in (shown - without): 1 if the field is there,
    0 if it is missing or lies elsewhere. All [n, 3].
    """
    shares = (((shown - one) * (whole - one)).sum() / ((whole - one) ** 2).sum() for one in without)
    return float(min(shares))


def checks(data, figure, renderer, where, found):
    """The Checks of a figure's ``data`` on its displayed pixels: their largest RMS distance from the true
    ones, and the ``least_share`` of any field.

    where  which pixels of a panel are compared, bool [size, size], bottom row first
    found  of each panel that is compared, by its number, its ``pictures``
    """
    for on in Answer:
        window = renderer.window(on, figure, figure.size)
        pairs = [(np.clip(panel_of(window, k)[where], 0.0, 1.0), of) for k, of in found.items()]
        distance = max(root_mean_square(shown - of[0]) for shown, of in pairs)
        share = min(least_share(shown, *of) for shown, of in pairs)
        yield data.check("RMS distance from Eq. 1 in float64, pixel by pixel", distance, on)
        yield data.check(
            "of what single texels of a material texture change, the least share that is seen", share, on
        )

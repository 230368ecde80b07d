"""K22: Eq. 1 by plain multitexturing, without its signed products and with them."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import DARK, Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.vectors import cosine, cross, normalize, sine
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import evaluate_then_interpolate, material_textures, plain_multitexturing
from fixedpipe.pipeline.commands import DrawPixels
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.state import PassState, RasterPosition

DATA = figure_data(__file__, "K22")

MAP_SIZE = 256


def parquet(tiles, angles, alpha_x, alpha_y, k_s, joint):
    """A flat square of ``tiles`` x ``tiles``, each brushed at one of ``angles``, multiples of 45 degrees.

    The angle's number grows by one from tile to tile and by two from row to row. From stroke to stroke, k_s
    varies between the two values of ``k_s``; on the tiles' edges it is ``joint``.
    """
    j, i = np.mgrid[0:MAP_SIZE, 0:MAP_SIZE]
    edge = MAP_SIZE // tiles
    angle = np.array(angles)[(i // edge + 2 * (j // edge)) % len(angles)]
    strokes = height_fields.value_noise(MAP_SIZE, MAP_SIZE, 16, MAP_SIZE, 1)
    strokes = np.floor(strokes * 256.0 + 0.5) / 256.0
    # Along the strokes and across them, in texels.
    along = {0: (i, j), 45: (i + j, j - i), 90: (j, i), 135: (i - j, i + j)}
    brushed = np.select(
        [angle == a for a in along],
        [strokes[v % MAP_SIZE, u % MAP_SIZE] for u, v in along.values()],
    )
    gloss = k_s[0] + (k_s[1] - k_s[0]) * (0.5 + 0.5 * brushed)
    at_edge = (i % edge < 1) | (i % edge >= edge - 1) | (j % edge < 1) | (j % edge >= edge - 1)
    tangents = np.stack([cosine(np.radians(angle)), sine(np.radians(angle)), 0.0 * gloss], axis=-1)
    normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), tangents.shape)
    return material_textures.Material(
        normals, tangents, cross(normals, tangents), alpha_x, alpha_y, np.where(at_edge, joint, gloss)
    )


def halfway(x, y, light):
    """Halfway vectors on the square z = 0 under a point light, seen from above: float64 [..., 3]."""
    to_light = normalize(np.array(light) - np.stack([x, y, 0.0 * x], axis=-1))
    return normalize(to_light + np.array([0.0, 0.0, 1.0])), to_light


def scene(
    profile, size, *, light, extent, subdivisions, diffuse, ambient, specular, background, **of_parquet
):
    """K22: left a software renderer's picture, middle the unsigned passes, right those with halves."""
    panels = row_of_panels(3, size)
    material = parquet(**of_parquet)
    x, y = pixel_grid(size, extent)
    s, t = 0.5 * (x + 1.0), 0.5 * (y + 1.0)
    half, to_light = halfway(extent * x, extent * y, light)
    gloss = evaluate_then_interpolate.at_texels(
        lambda row, column: material.k_s[row, column], *(MAP_SIZE,) * 2, s, t
    )
    lit = to_light[..., 2:] * np.array(diffuse) + np.array(ambient)
    highlight = evaluate_then_interpolate.specular(material, half, s, t)[..., None] * np.array(specular)
    covered = (np.maximum(np.abs(x), np.abs(y)) < 1.0)[..., None]
    picture = np.where(covered, gloss[..., None] * lit + highlight, np.array(background))
    image = factor_texels(np.clip(picture, 0.0, 1.0), profile)

    surface = surfaces.plane(subdivisions, subdivisions, extent, extent)
    toward = Light(light, point=True)
    loading, names = plain_multitexturing.load(material, "parquet", profile)
    out = [panel.clear(background) for panel in panels]
    out += [
        DrawPixels(
            label="show the software renderer's image",
            image=PixelImage(image, "RGB"),
            state=PassState(scissor=panels[0].scissor),
            position=RasterPosition(position=(panels[0].x, panels[0].y, 0.0, 1.0), window=True),
        ),
        *loading,
    ]
    for panel, passes in zip(
        panels[1:], (plain_multitexturing.unsigned_passes, plain_multitexturing.signed_passes), strict=True
    ):
        view = orthographic_view(panel)
        out += passes(surface, names, view, toward, profile, specular=specular)
        out += plain_multitexturing.diffuse_pass(
            surface, names, view, toward, profile, color=diffuse, ambient=ambient
        )
    return tuple(out)


# Eq. 1 alone, on a square of one material.
_PLAIN = {**DARK, "specular": (1.0, 1.0, 1.0), "k_s": (1.0, 1.0), "joint": 1.0}


def _in_float(values, seen, signed):
    """A panel's pixels by Eq. 1 in float64, then those of wrong panels: float64 [n, 3] each.

    These have k_s, m_xx or m_yy flat, k_s upside down, or the signed products of the other kind of panel.
    Where there are any, ``signed``, each of four products is missing, too: m_xy and h_x h_y have two signs.
    """
    material = parquet(*(values[name] for name in ("tiles", "angles", "alpha_x", "alpha_y", "k_s", "joint")))
    pairs = (material.tangents, values["alpha_x"]), (material.binormals, values["alpha_y"])
    fields = [material.k_s]
    for i, j in ((0, 0), (1, 1), (0, 1)):
        fields.append(sum(v[..., i] * v[..., j] / (alpha * alpha) for v, alpha in pairs))
    k_s, *m = (seen_places.looked_up(field, seen) for field in fields)
    places = values["extent"] * np.stack([2.0 * seen.s - 1.0, 2.0 * seen.t - 1.0, 0.0 * seen.s], axis=-1)
    toward = seen_places.unit(np.array(values["light"]) - places)
    h = seen_places.unit(toward + np.array([0.0, 0.0, 1.0]))
    diffuse, ambient, specular = (np.array(values[name]) for name in ("diffuse", "ambient", "specular"))
    products, cross = h[:, 0] * h[:, 1], 2.0 * m[2] * h[:, 0] * h[:, 1]

    def picture(k_s, xx, yy, cross):
        rest = np.maximum(1.0 - xx * h[:, 0] ** 2 - yy * h[:, 1] ** 2 - cross, 0.0)
        light = toward[:, 2:] * diffuse + ambient + rest[:, None] * specular
        return np.clip(k_s[:, None] * light, 0.0, 1.0)

    given = k_s, m[0], m[1], signed * cross
    out = [picture(*given), picture(*given[:3], cross - given[3])]
    out += (picture(*given[:k], 0.0 * k_s + fields[k].mean(), *given[k + 1 :]) for k in range(3))
    out.append(picture(seen_places.looked_up(fields[0][::-1], seen), *given[1:]))
    if signed:
        for one in (m[2] > 0.0, m[2] < 0.0):
            out += (
                picture(*given[:3], np.where(one & other, 0.0, cross))
                for other in (products > 0.0, products < 0.0)
            )
    return out


def _displayed_checks(figure, renderer):
    """The displayed panels beside those with a flat texture, and with other signed products."""
    seen = seen_places.square(figure.size, figure.values["extent"])
    found = [_in_float(figure.values, seen, signed) for signed in (True, False, True)]
    for on in Answer:
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        shares = [least_share(panel_of(window, k)[seen.where], *of) for k, of in enumerate(found)]
        yield DATA.check(
            "of what a texture and the signed products change, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """The light that is lost without the signed products, and that their halves bring it back."""
    yield from _displayed_checks(figure, renderer)
    size = 128
    x, y = pixel_grid(size, figure.values["extent"])
    inside = np.maximum(np.abs(x), np.abs(y)) < 0.98
    extent, light = figure.values["extent"], figure.values["light"]
    half, _ = halfway(extent * x, extent * y, light)
    # The product that the unsigned passes lose is 2 m_xy h_x h_y; for strokes at 45 degrees m_xy > 0.
    product = half[..., 0] * half[..., 1]
    positive, negative = inside & (product > 0.0), inside & (product < 0.0)

    bounds = {
        Answer.IDEAL: (
            0.0034,
            0.0034,
            "vertex colours are quadratic in h and interpolated over 1/16 of the square; measured at the "
            "first correct picture, with at most a third of slack",
        ),
        Answer.MACHINE: (
            0.0102,
            0.0118,
            "bytes of products that are scaled by four; measured at the first correct picture, with at most "
            "a third of slack",
        ),
    }
    for on, (unsigned_bound, signed_bound, reason) in bounds.items():
        pictures = {}
        for angle in (0, 45, 90, 135):
            image = renderer.window(on, figure, size, **_PLAIN, angles=(angle,))[..., 0]
            pictures[angle] = [np.clip(image[:, k * size : (k + 1) * size], 0.0, 1.0) for k in range(3)]
        on_axes = np.stack([(pictures[a][1] - pictures[a][0])[inside] for a in (0, 90)])
        whole = np.stack([(pictures[a][2] - pictures[a][0])[inside] for a in pictures])
        (true, without, _), (other_true, other_without, _) = pictures[45], pictures[135]
        lost = without - true
        for name, error, bound in (
            ("RMS of the unsigned passes - Eq. 1, strokes along the axes", on_axes, unsigned_bound),
            ("RMS of the signed passes - Eq. 1", whole, signed_bound),
        ):
            yield Check(name, root_mean_square(error), at_most=bound, on=on, reason=reason)
        yield DATA.check(
            "RMS of the unsigned passes - Eq. 1, strokes along a diagonal", root_mean_square(lost[inside]), on
        )
        yield DATA.check(
            "what is lost, mean over the quadrants along the strokes", float(lost[positive].mean()), on
        )
        yield DATA.check(
            "what is lost, mean over the quadrants across the strokes", float(lost[negative].mean()), on
        )
        yield DATA.check(
            "unsigned passes, one diagonal - the other, largest",
            float(np.abs(without - other_without)[inside].max()),
            on,
        )
        yield DATA.check(
            "Eq. 1, RMS of one diagonal - the other", root_mean_square((true - other_true)[inside]), on
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "tiles": word.of(word.Whole(1, 32, power=True), 4, "Tiles along an edge of the square."),
        "angles": word.of(
            word.Several(word.Choice({str(a): a for a in (0, 45, 90, 135)}), 1, 4),
            (0, 45, 90, 135),
            "The directions in which tiles are brushed, one after the other.",
            "degrees",
        ),
        "alpha_x": word.ALPHA_X(
            0.5, "The highlight's width along the tangents: the smaller, the narrower.", low=0.5
        ),
        "alpha_y": word.ALPHA_Y(
            1.0, "The highlight's width along the binormals: the smaller, the narrower.", low=0.5
        ),
        "k_s": word.K_S((0.55, 1.0)),
        "joint": word.SHARE(0.1, "The strength of the highlights between the tiles.", word.FULL),
        "light": word.POSITION(
            (-0.23, 0.23, 0.6), "Where the light is: the square reaches from -1 to 1 in x and y, at z = 0."
        ),
        "extent": word.EXTENT(0.92),
        "subdivisions": word.COUNT(
            16, "Parts of the square along an edge, at whose corners vectors are computed."
        ),
        "diffuse": word.DIFFUSE((0.16, 0.19, 0.22)),
        "ambient": word.AMBIENT((0.03, 0.035, 0.04)),
        "specular": word.SPECULAR((0.82, 0.80, 0.74)),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("texture environments", scene, ("MULTITEXTURE", "G400")),),
    acceptance=checks,
)

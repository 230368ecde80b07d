"""F000-9: a studded box, which is six squares with a bump map, without and with the studs' shadows."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import bump_shadows, seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.vertex_vectors import light_vectors
from fixedpipe.effects.geometry.views import BACKGROUND, Light, panel_of, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import FIRST_PASS, REPEATED, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import factor_texels, vector_texels
from fixedpipe.effects.scattering import directions as sphere
from fixedpipe.effects.scattering import ellipse_passes, ellipses, height_field, visibility
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import TextureFilter, WrapMode
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.state import Sampler
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F000-9")

_EYE = (3.1, 2.55, 4.3)
# The sides that are seen: how the square that faces the viewer is turned to each.
_SIDES = {"front": ("y", 0.0), "right side": ("y", 90.0), "lid": ("x", -90.0)}
_BLACK = (0.0, 0.0, 0.0)
# Of a stud, in its cell's edge.
_RADIUS = 0.36
# Flat ground between a side's edge and its studs' cells, in a cell's edge. The field of heights repeats, and
# a side has no studs beyond its edge. Inferred: the figure's light, 25 degrees above a side, throws a stud's
# shadow 0.62 of a cell from the stud's centre, so a margin of 0.12 keeps it on the side.
_MARGIN = 0.2


def _studs(texels, studs):
    """Of each texel: its place in its stud's cell, -0.5 to 0.5 in both directions, and the stud's number from
    1, 0 where no stud is: three [texels, texels].
    """
    s, t = (c * (studs + 2.0 * _MARGIN) - _MARGIN for c in height_fields.texel_centers(texels, texels))
    column, row = (np.clip(np.floor(c), 0.0, studs - 1.0) for c in (s, t))
    x, y = s - column - 0.5, t - row - 0.5
    return x, y, np.where(x * x + y * y < _RADIUS * _RADIUS, 1.0 + column + studs * row, 0.0)


@lru_cache(4)
def _relief(texels, studs, height, directions, smoothing, own, scale):
    """The height field of a side, and its ellipses as forms that may be filtered."""
    if own is None:
        x, y, _ = _studs(texels, studs)
        square, cells = x * x + y * y, studs + 2.0 * _MARGIN
        heights = height * np.sqrt(np.maximum(_RADIUS * _RADIUS - square, 0.0)) / cells
        heights = height_fields.smooth(heights, texels // 128)
        # How much of a texel the stud covers, as if its rim were straight there.
        cover = np.clip((_RADIUS - np.sqrt(square)) * texels / cells + 0.5, 0.0, 1.0)[..., None]
    else:
        heights = own.fitted(texels, texels, scale, repeated=True)
        cover = ((heights - heights.min()) / (np.ptp(heights) or 1.0))[..., None]
    s, t = height_fields.texel_centers(texels, texels)
    grain = 1.0 + 0.14 * height_fields.turbulence(s, t, 16, 3, 4)[..., None]
    leather, brass = np.array((0.84, 0.44, 0.29)), np.array((0.96, 0.76, 0.40))
    field = height_field.height_field(
        heights, np.clip((leather * (1.0 - cover) + brass * cover) * grain, 0, 1)
    )
    seen = visibility.precompute(field, sphere.spiral(directions))
    # Twice as many texels take four filters for one, to be filtered as far.
    often = smoothing * max(1, (texels // 128) ** 2)
    return field, ellipses.smoothed(ellipses.rooted(ellipses.of_visibility(seen)), often)


def relief_of(size, p):
    """The field and its forms for panels of ``size`` pixels."""
    texels = p["texels"] or min(256, max(16, 1 << (size // 4).bit_length()))
    shape = p["studs"], p["height"], p["directions"], p["smoothing"], p["height_field"], p["height_scale"]
    return _relief(texels, *shape)


def sides():
    """(name, surface) of the box's sides that are seen."""
    for name, (axis, angle) in _SIDES.items():
        turned = surfaces.plane().rotated(rotation(axis, angle))
        yield name, turned.moved(*turned.normals[0])


def _view(panel):
    return perspective_view(panel, _EYE, (0.0, -0.11, 0.0), 33.0, 2.0)


def _with_combiners(name, side, forms, field, view, light, profile, **settings):
    return ellipse_passes.combiner_passes(side, forms, view, light, profile, normal_map="normals", **settings)


def _with_the_imaging_subset(name, side, forms, field, view, light, profile, **settings):
    return ellipse_passes.imaging_passes(
        side, forms, field.normals, view, light, profile, name=f"ellipses of the {name}", **settings
    )


def _for_combiners(forms, field, profile):
    normals = texture_2d(vector_texels(field.normals, profile))
    return (
        *ellipse_passes.load(forms, profile),
        TexImage(label="load n", texture="normals", image=normals),
    )


def _scene(load, passes):
    def scene(profile, size, **p):
        field, forms = relief_of(size, p)
        colors = texture_2d(factor_texels(field.albedo, profile))
        out = [
            *load(forms, field, profile),
            TexImage(label="load the colours", texture="colours", image=colors),
        ]
        for panel, shadows in zip(row_of_panels(2, size), (False, True), strict=True):
            out.append(panel.clear(p["background"]))
            for name, side in sides():
                out += passes(
                    name, side, forms, field, _view(panel), Light(p["light"]), profile,
                    color=p["color"], ambient=p["ambient"], color_map="colours", shadows=shadows,
                )  # fmt: skip
        return tuple(out)

    return scene


combiner_scene = _scene(_for_combiners, _with_combiners)
imaging_scene = _scene(lambda forms, field, profile: (), _with_the_imaging_subset)


def by_rays(size, p, panel, shadows=True):
    """Commands that draw the box with light computed at texels in float64, its shadows cast by rays."""
    field, _ = relief_of(size, p)
    out = [panel.clear(p["background"])]
    for name, side in sides():
        vector = light_vectors(side, Light(p["light"]))[0]
        free = (
            visibility.free_view(field, vector)
            if shadows and vector[2] > 0.0
            else np.ones(field.heights.shape)
        )
        lit = np.maximum(dot(field.normals, vector), 0.0) * free
        values = field.albedo * (np.array(p["ambient"]) + lit[..., None] * np.array(p["color"]))
        units = (unit(name, REPEATED, environment=REPLACE),)
        out += (
            TexImage(label=f"load the {name}", texture=name, image=texture_2d(values)),
            draw(f"the {name}", side.mesh(), _view(panel), None, units, depth_test=FIRST_PASS),
        )
    return tuple(out)


def _told(size, p):
    """Eq. 4's left side at the pixels of the right panel, -1 to 1, by the forms filtered in float64: what a
    texture's filter does at the place of each pixel, done to forms that are textures of floats.
    """
    _, forms = relief_of(size, p)
    (panel,) = row_of_panels(1, size)
    pictures = []
    for form in forms:
        out = [panel.clear(_BLACK)]
        for name, side in sides():
            x, y, _ = light_vectors(side, Light(p["light"]))[0]
            product = (form[..., 0] * x + form[..., 1] * y) + form[..., 2]
            units = (unit(name, REPEATED, environment=REPLACE),)
            # What lies outside saturates on the machines; here halves keep a sign.
            image = texture_2d(np.repeat(0.5 + 0.125 * np.clip(product, -4.0, 4.0)[..., None], 3, axis=-1))
            out += (
                TexImage(label=f"load the {name}", texture=name, image=image),
                draw(f"the {name}", side.mesh(), _view(panel), None, units, depth_test=FIRST_PASS),
            )
        found = execute_ideal(tuple(out), size, size).color[::-1, :, 0]
        pictures.append(8.0 * (found - 0.5))
    return np.clip((1.0 - pictures[0] * pictures[0]) - pictures[1] * pictures[1], -1.0, 1.0)


def reference(size, **p):
    """Both panels in float64, shadows by rays: RGBA, top row first."""
    panels = row_of_panels(2, size)
    drawn = (*by_rays(size, p, panels[0], shadows=False), *by_rays(size, p, panels[1]))
    out = np.ones((size, 2 * size, 4))
    out[..., :3] = np.clip(execute_ideal(drawn, 2 * size, size).color[..., :3], 0.0, 1.0)
    return out


# ---------------------------------------------------------------------------------------------- checks


def _lights():
    """Fifty lights from the figure's 25 degrees above a side to 65: float64 [50, 3]."""
    return bump_shadows.lights((25.0, 35.0, 45.0, 55.0, 65.0), tuple(11.0 + 36.0 * k for k in range(10)))


def _agreement(field, forms):
    """For each light the share of all texels that are light or dark as rays have them."""
    for light in _lights():
        faces = dot(field.normals, light) > 0.0
        lit = ellipses.tested(*forms, *light[:2]) >= 0.0
        yield float(((lit & faces) == (visibility.free_view(field, light) & faces)).mean())


# The nearest texel, of squares that repeat.
_TEXELS = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST, WrapMode.REPEAT, WrapMode.REPEAT)
# What a component counts at most, and pixels without which nothing is said of a stud.
_NUMBERS, _FEWEST = 255.0, 20


def _places(size, p):
    """What each pixel of a panel shows, by the texel at its centre: n.l, whether rays find the light free,
    the side's number, -1 beside the box, the stud's, 0 of the ground, and whether it is flat ground along the
    side's upper edge: five [size, size].
    """
    field, _ = relief_of(size, p)
    (panel,) = row_of_panels(1, size)
    studs = p["studs"]
    _, y, stud = _studs(field.columns, studs)
    # The margin at the top is the row of cells' continuation.
    upper = studs * studs + 1
    stud[(y > 0.5) & (np.arange(field.rows) > field.rows // 2)[:, None]] = upper
    out = [panel.clear(_BLACK)]
    for k, (name, side) in enumerate(sides(), 1):
        vector = light_vectors(side, Light(p["light"]))[0]
        free = visibility.free_view(field, vector).astype(np.float64)
        code = (k * (upper + 1) + stud) / _NUMBERS
        values = np.stack([0.5 + 0.5 * dot(field.normals, vector), free, code], axis=-1)
        units = (unit(name, _TEXELS, environment=REPLACE),)
        out += (
            TexImage(label=f"load the {name}", texture=name, image=texture_2d(values)),
            draw(f"the {name}", side.mesh(), _view(panel), None, units, depth_test=FIRST_PASS),
        )
    found = execute_ideal(tuple(out), size, size).color[::-1, :, :3]
    side, stud = np.divmod(np.floor(_NUMBERS * found[..., 2] + 0.5), upper + 1)
    edge = stud == upper
    return 2.0 * found[..., 0] - 1.0, found[..., 1] > 0.5, side - 1.0, np.where(edge, 0.0, stud), edge


def _displayed(left, right, places, on):
    """What must be seen, in the panels that are displayed: red, [size, size] each."""
    facing, free, side, stud, edge = places
    sides_seen = [side == k for k in np.unique(side[side >= 0.0])]
    ratios = []
    for here in sides_seen:
        for number in np.unique(stud[here & (stud > 0.0)]):
            of = here & (stud == number)
            away, toward = of & (facing < 0.0), of & (facing > 0.5)
            if min(away.sum(), toward.sum()) >= _FEWEST:
                ratios.append(float(left[away].mean() / left[toward].mean()))
    yield DATA.check("left: studs of which a dark and a lit side are seen", len(ratios), on)
    yield DATA.check("left: a stud's dark side over its lit one, the largest", max(ratios), on)
    # Ground whose normal the studs' smoothed rims do not turn, of the front and the right side: on the lid
    # the light is too high for a shadow beyond a rim.
    ground = [here & (stud == 0.0) for here in sides_seen[:2]]
    level = [here & (np.abs(facing - np.median(facing[here])) < 0.01) for here in ground]
    level = [here for here in level if (here & ~free).sum() >= _FEWEST]
    hidden = [here & ~free for here in level]
    yield DATA.check(
        "left: ground that rays leave in shadow over ground that they do not, the least of the sides",
        min(
            float(left[of].mean() / left[here & free].mean()) for of, here in zip(hidden, level, strict=True)
        ),
        on,
    )
    yield DATA.check(
        "right: ground that rays leave in shadow over the same on the left, the largest of the sides",
        max(float(right[of].mean() / left[of].mean()) for of in hidden),
        on,
    )
    yield DATA.check(
        "right: ground along the upper edges of the sides that is as bright as on the left within 2/255",
        float((np.abs(right - left) <= 2.0 / 255.0)[(side >= 0.0) & edge].mean()),
        on,
    )
    lit = (side >= 0.0) & (facing > 0.0) & free
    yield DATA.check(
        "right: of what rays leave lit, what is as bright as on the left within 2/255",
        float((np.abs(right - left) <= 2.0 / 255.0)[lit].mean()),
        on,
    )


def checks(figure, renderer):
    """The mask against rays, the machine against the ellipses in float, and where shadows lie."""
    values, size = figure.values, 256
    field, forms = relief_of(size, {**values, "texels": 128})
    shares = list(_agreement(field, forms))
    for what, share, bound in (("mean of", np.mean(shares), 0.93), ("worst of", min(shares), 0.88)):
        yield DATA.check(
            "texels that ellipses leave light or dark as rays do, {what} 50 lights",
            float(share),
            Answer.IDEAL,
            at_least=bound,
            what=what,
        )
    white = {"color": (1.0, 1.0, 1.0), "ambient": _BLACK, "background": _BLACK, "texels": 128}
    p = {**values, **white}
    panel, other = row_of_panels(2, size)
    drawn = (*by_rays(size, p, panel, shadows=False), *by_rays(size, p, other))
    picture = renderer.execute_ideal(drawn, 2 * size, size).color[::-1, :, :3]
    facing, free = (panel_of(picture, k).max(axis=-1) for k in range(2))
    clear = facing > 0.1
    rays = panel_of(figure.reference_picture()[::-1], 0)[..., :3]
    box = (rays != np.array(values["background"])).any(axis=-1)
    for on, share in seen_places.shares_alike(figure, renderer, {0: (box, rays[box])}):
        yield DATA.check(
            "pixels that show what a ray finds there within 8/255, the least of the panels", share, on
        )
    told = _told(size, p)
    places = _places(figure.size, values)
    for on in Answer:
        displayed = renderer.window(on, figure, figure.size)[..., 0]
        yield from _displayed(*(panel_of(displayed, k) for k in range(2)), places, on)
        plain, shadowed = (
            panel_of(renderer.window(on, figure, size, **white), k).max(axis=-1) for k in (0, 1)
        )
        lit = shadowed > 0.5 * plain
        sure = clear & (np.abs(told) > (0.15 if on is Answer.MACHINE else 1e-3))
        yield DATA.check(
            "pixels that are lit where the ellipses in float say so, away from their edges",
            float((lit == (told > 0.0))[sure].mean()),
            on,
        )
        yield DATA.check(
            "pixels of the box in shadow where rays are",
            float((lit == (free > 0.5 * facing))[clear].mean()),
            on,
        )
        yield DATA.check(
            "of the pixels that rays leave in shadow, those that are",
            float((~lit & (free <= 0.5 * facing))[clear].sum() / (free <= 0.5 * facing)[clear].sum()),
            on,
        )
        yield DATA.check(
            "share of the panel's pixels that shadows make brighter by more than 2/255",
            float((shadowed > plain + 2.0 / 255.0).mean()),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "texels": word.FITTED_TEXELS(None, "The edge of the bump map and of the ellipses' textures."),
        "studs": word.of(word.Whole(1, 8), 3, "Studs along an edge of a side."),
        "height": word.NUMBER(0.65, "How high the studs are, of half balls.", low=0.05, high=2.0),
        "directions": word.of(
            word.Whole(8, 1000), 400, "Directions over the whole sphere along which rays are cast."
        ),
        "smoothing": word.of(
            word.Whole(0, 8),
            3,
            "How often the ellipses' forms are filtered before they are stored, at 128 texels.",
        ),
        "light": word.LIGHT((0.47, 0.775, 0.4226)),
        "color": word.DIFFUSE((1.0, 0.96, 0.88)),
        "ambient": word.AMBIENT((0.14, 0.15, 0.19)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the studs"),
        "height_scale": own_maps.HEIGHT_SCALE(0.06),
    },
    methods=(
        Method("register combiners", combiner_scene, ("GEFORCE_256", "GEFORCE_3", "NV2A")),
        Method("imaging subset", imaging_scene, ("OCTANE", "OPENGL_1_2_IMAGING")),
    ),
    acceptance=checks,
    reference=reference,
)

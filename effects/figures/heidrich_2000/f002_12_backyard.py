"""F002-12: a backyard in which everything except the floor and the bin has bumps, with their shadows and
scattered light.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import repeat

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.ray_caster import RayCaster, primary_rays
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import backyard
from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import Panel, View, row_of_panels
from fixedpipe.effects.passes.draws import ADD, FIRST_PASS, LATER_PASS, MODULATE, REPEATED, unit
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.scattering.turning_sun import for_each
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.pipeline.commands import Clear, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter
from fixedpipe.pipeline.profiles import GEFORCE_256, IDEAL
from fixedpipe.pipeline.state import PassState, Sampler, VertexState
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F002-12")

ASPECT = (8, 5)
# Degrees from the picture's lower to its upper edge; samples along a pixel's edge of the software renderer.
_FIELD, _SAMPLES = 37.0, 3
_FILTERED = Sampler(
    TextureFilter.LINEAR_MIPMAP_LINEAR, TextureFilter.LINEAR, REPEATED.wrap_s, REPEATED.wrap_t
)


def camera(panel):
    """The figure's camera, without a far plane: shadow volumes reach to infinity."""
    matrix = perspective(_FIELD, panel.width / panel.height, 0.5, 40.0)
    view = View(panel, look_at(backyard.EYE, backyard.CENTER), matrix, backyard.EYE, False)
    return shadow_volumes.infinite_view(view)


def detail_of(size):
    """(texels along a field's edge, metres of a cell) for a picture ``size`` pixels high."""
    return (32, 1.6) if size < 100 else (256, 0.25)


def _sky_behind(panel):
    """The sky on the whole panel, from the horizon up."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    low, high = (np.array(c) for c in (backyard.HORIZON, backyard.ZENITH))
    colors = np.stack([low, low, 0.5 * (low + high), 0.5 * (low + high)])
    state = PassState(
        vertex=VertexState(viewport=panel.viewport),
    )
    return Draw(label="the sky", mesh=Mesh(corners, PrimitiveType.QUADS, colors=colors), state=state)


def _image(values, profile):
    """A texture of what a field sends back, [edge, edge, 3]; a machine's are of what is not brighter than
    one.
    """
    exact = profile.arithmetic.exact
    return texture_2d(factor_texels(values if exact else np.minimum(values, 1.0), profile), mipmaps=True)


@lru_cache(maxsize=64)
def _sky_image(exact, field, edge, frame, directions, bounces):
    """The texture of the sky's light, which no sun changes; all machines have the same bytes."""
    values = backyard.by_sky(field, edge, frame, directions, bounces)
    return _image(values, IDEAL if exact else GEFORCE_256)


def _kind(part):
    """The height field and the frame of a flat part: parts with the same have the same textures."""
    return part.field, backyard.frame_of(part.surface)


def _name(kind, what):
    return f"{kind[0]} {kind[1]} {what}"


def _textures(kinds, edge, light, profile, paths):
    """The commands that load the flat parts' textures: of the sun, and of the sky."""

    def images(kind):
        field, frame = kind
        return {
            "sun": _image(backyard.radiance(field, edge, frame, light, *paths)[0], profile),
            "sky": _sky_image(profile.arithmetic.exact, field, edge, frame, *paths),
        }

    return [
        TexImage(label=f"load what {kind[0]} send back of the {what}", texture=_name(kind, what), image=image)
        for kind, pair in zip(kinds, for_each(images, kinds), strict=True)
        for what, image in pair.items()
    ]


@dataclass(frozen=True)
class _Still:
    """What no light changes.

    kinds      ``_kind`` of the flat parts, each once
    under_sky  a Draw for each part
    under_sun  a Draw for each part; of the smooth ones, whose colours the light changes, without colours
    """

    kinds: tuple[tuple, ...]
    under_sky: tuple[Draw, ...]
    under_sun: tuple[Draw, ...]


@lru_cache(maxsize=8)
def _still(size):
    """The _Still of a picture ``size`` pixels high."""
    (panel,) = row_of_panels(1, size, ASPECT)
    view, cell = camera(panel), detail_of(size)[1]
    under_sky, under_sun, kinds = [], [], {}
    for part, share in zip(backyard.parts(cell), backyard.sky_lights(cell), strict=True):
        smooth = share if part.field else share * np.array(part.color) * backyard.sky(part.surface.normals)
        for first, what, draws in ((True, "sky", under_sky), (False, "sun", under_sun)):
            units = ()
            if part.field:
                kinds[kind := _kind(part)] = None
                units = (unit(_name(kind, what), _FILTERED, environment=MODULATE),)
            state = PassState(
                vertex=view.vertex,
                texture_units=units,
                depth_test=FIRST_PASS if first else LATER_PASS,
                blending=None if first else ADD,
                stencil_test=None if first else shadow_volumes.NOT_SHADOWED,
            )
            mesh = part.surface.mesh(colors=smooth if first else np.ones(share.shape))
            draws.append(Draw(label=f"{part.name} under the {what}", mesh=mesh, state=state))
    return _Still(tuple(kinds), tuple(under_sky), tuple(under_sun))


def _in_sun(part, draw, sun):
    """A part's Draw under a sun."""
    if part.field:
        return draw
    facing = np.maximum(dot(part.surface.normals, np.array(sun)), 0.0)[:, None]
    colors = facing * np.array(part.color) * np.array(backyard.SUN)
    return replace(draw, mesh=part.surface.mesh(colors=colors))


def scene(profile, size, *, light, directions, bounces):
    """The sky's light on everything; the stencil buffer counts the objects' shadows; then the sun's light."""
    (panel,) = row_of_panels(1, size, ASPECT)
    (edge, cell), still = detail_of(size), _still(size)
    sun = tuple(float(c) for c in unit_vector(light, "The light's direction"))
    loads = _textures(still.kinds, edge, sun, profile, (directions, bounces))
    in_sun = map(_in_sun, backyard.parts(cell), still.under_sun, repeat(sun))
    volumes = shadow_volumes.shadow_volumes(backyard.throwing(), (*sun, 0.0))
    counts = shadow_volumes.z_fail_counts(volumes, camera(panel), shadow_volumes.counting_operations(profile))
    return (
        panel.clear(backyard.HORIZON),
        _sky_behind(panel),
        *loads,
        *still.under_sky,
        Clear(label="stencil to zero", stencil=0, scissor=panel.scissor),
        *counts,
        *in_sun,
    )


def by_rays(size, *, light, directions, bounces):
    """The same in software as the paper drew it: rays, nine a pixel, and float64 all the way."""
    (panel,) = row_of_panels(1, size, ASPECT)
    sun = unit_vector(light, "The light's direction")
    edge, cell = detail_of(size)
    everything = backyard.parts(cell)
    lights = [
        backyard.radiance(
            part.field, edge, backyard.frame_of(part.surface), tuple(sun.tolist()), directions, bounces
        )
        if part.field
        else None
        for part in everything
    ]
    shares = backyard.sky_lights(cell)
    fine = replace(camera(panel), panel=Panel(0, 0, _SAMPLES * panel.width, _SAMPLES * panel.height))
    fine = replace(fine, projection=perspective(_FIELD, panel.width / panel.height, 0.5, 40.0))
    out = np.ones((panel.height, panel.width, 4))
    height = np.repeat((np.arange(fine.panel.height) + 0.5) / fine.panel.height, fine.panel.width)[:, None]
    low, high = np.array(backyard.HORIZON), np.array(backyard.ZENITH)
    behind = low + height * 0.5 * (high - low)
    colors, found = backyard.seen_by_rays(everything, *primary_rays(fine), sun, lights, shares)
    colors = np.minimum(np.where(found[:, None], colors, behind), 1.0)
    out[..., :3] = colors.reshape(panel.height, _SAMPLES, panel.width, _SAMPLES, 3).mean(axis=(1, 3))
    return out[::-1]


# Pixels without which nothing is said of a part, and shares of a slab's edge that are not its joints.
_FEWEST, _SLAB = 2000, 0.45


def _places(size, light):
    """What the picture's pixels show, by a ray each: the parts, a tuple; the part's number, -1 of none,
    [h, w]; its texture coordinates, [h, w, 2]; and whether things leave the sun free, [h, w].
    """
    (panel,) = row_of_panels(1, size, ASPECT)
    parts = backyard.parts(detail_of(size)[1])
    triangles = [part.surface.triangles for part in parts]
    corners, coordinates = (
        np.concatenate([values[t] for values, t in zip(every, triangles, strict=True)])
        for every in (
            [part.surface.positions for part in parts],
            [part.surface.texture_coordinates for part in parts],
        )
    )
    caster = RayCaster(corners, np.repeat(np.arange(len(parts)), [len(t) for t in triangles]))
    view = replace(camera(panel), projection=perspective(_FIELD, panel.width / panel.height, 0.5, 40.0))
    origins, along = primary_rays(view)
    hits = caster.nearest(origins, along)
    shape = panel.height, panel.width
    number = np.where(hits.triangle >= 0, caster.objects[hits.triangle], -1).reshape(shape)
    place = (coordinates[hits.triangle] * hits.barycentrics[..., None]).sum(axis=1).reshape(*shape, 2)
    points = origins + hits.distance[:, None] * along
    free = backyard.in_sun(points, caster.normals[hits.triangle], light).reshape(shape)
    return parts, number, place, free


def _displayed(figure, renderer):
    """What must be seen, sentence after sentence, in the picture that is displayed."""
    size, light = figure.size, unit_vector(figure.values["light"], "The light's direction")
    parts, number, place, free = _places(size, light)
    edge, _ = detail_of(size)
    column, row = np.moveaxis(np.floor(place * edge).astype(np.int64) % edge, -1, 0)

    def of(values):
        """A field's values at the pixels."""
        return values[row, column]

    def called(*names):
        return np.isin(number, [k for k, part in enumerate(parts) if part.name in names])

    heights = backyard.field_of("bricks", edge).heights
    joint, wall = of(heights < 0.25 * heights.max()), called("house, front") & free
    slab = called("floor") & (np.abs(place % 1.0 - 0.5).max(axis=-1) < _SLAB)
    can = called("bin") & free
    beside = can[:, 1:] & can[:, :-1]
    for on in Answer:
        bright = np.clip(renderer.window(on, figure, size), 0.0, 1.0).mean(axis=-1)
        yield DATA.check(
            "the wall's joints over its bricks",
            float(bright[wall & joint].mean() / bright[wall & ~joint].mean()),
            on,
        )
        yield DATA.check("the wall's joints, mean", float(bright[wall & joint].mean()), on)
        for field, what in (("planks", "boards"), ("gravel", "gravel")):
            ratios = []
            for k, part in enumerate(parts):
                here = (number == k) & free
                if part.field != field or here.sum() < _FEWEST:
                    continue
                frame = np.array(backyard.frame_of(part.surface))
                facing = dot(backyard.field_of(field, edge).normals, frame @ light)
                low, high = np.quantile(facing, (0.25, 0.75))
                toward, away = here & of(facing > high), here & of(facing < low)
                ratios.append(float(bright[toward].mean() / bright[away].mean()))
            yield DATA.check(
                "{what}: the quarter that faces the sun most over the one that does least",
                min(ratios),
                on,
                what=what,
            )
        lit = bright[slab & free]
        yield DATA.check(
            "paving in the sun, without joints: what is darker than its median by a quarter",
            float((lit < 0.75 * np.median(lit)).mean()),
            on,
        )
        yield DATA.check(
            "bin: median step from pixel to pixel",
            float(np.median(np.abs(np.diff(bright, axis=1))[beside])),
            on,
        )
        yield DATA.check(
            "paving from which things hide the sun, over the rest",
            float(bright[slab & ~free].mean() / lit.mean()),
            on,
        )


def checks(figure, renderer):
    """What must be seen, scattered light's share, and the passes against the software renderer."""
    yield from _displayed(figure, renderer)
    size = 128
    rays = by_rays(size, **figure.values)[::-1, :, :3]
    for on in Answer:
        with_it = renderer.window(on, figure, size)
        without = renderer.window(on, figure, size, bounces=0)
        yield DATA.check(
            "mean with scattering over the mean without, less one",
            float(with_it.mean() / without.mean() - 1.0),
            on,
        )
        yield DATA.check("the same, its upper bound", float(with_it.mean() / without.mean() - 1.0), on)
        apart = np.abs(np.clip(with_it, 0.0, 1.0) - rays).max(axis=-1)
        yield DATA.check("median difference from the software renderer", float(np.median(apart)), on)
        yield DATA.check(
            "share of pixels more than 0.25 from the software renderer", float((apart > 0.25).mean()), on
        )


FIGURE = Figure(
    **DATA.words,
    size=400,
    aspect=ASPECT,
    parameters={
        "light": word.LIGHT((0.62, 0.72, 0.42)),
        "directions": word.of(word.Whole(4, 1000), 100, "Along how many directions light is gathered."),
        "bounces": word.of(word.Whole(0, 8), 3, "How often light is scattered on its way."),
    },
    methods=(Method("textures of scattered light", scene, ("GEFORCE_256", "OPENGL_1_2")),),
    acceptance=checks,
    reference=by_rays,
)

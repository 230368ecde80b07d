"""F000-7: an engine block from a volume, without and with alpha-coded shadows."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import volume_caster
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import IMAGING_MACHINES_8, Figure, Method
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, perspective_view, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import lamp_around
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.volumes.engine_block import HALF_EXTENTS, engine_block
from fixedpipe.effects.volumes.slices import Volume
from fixedpipe.effects.volumes.volume_rendering import LEAST, Picture, Shading, combiners, imaging

DATA = figure_data(__file__, "F000-7")


@lru_cache(maxsize=4)
def engine(rows):
    """The engine block as a Volume."""
    return Volume("engine block", engine_block(rows), HALF_EXTENTS)


def _picture(panel, size, slices, rows, shading, shadows):
    """The Picture on one panel; smaller panels have a smaller volume, fewer slices and a smaller map."""
    volume = engine(min(rows, max(8, map_edge(size, 0.5))))
    edge = map_edge(size, 1)
    if edge > size:
        raise ValueError(
            f"The smallest shadow map has {edge} x {edge} texels, which panels of {size} pixels do not hold; "
            f"give panels of {edge} pixels or more."
        )
    return Picture(
        volume,
        perspective_view(panel, (4.3, 3.3, 4.6), (0.0, -0.02, 0.0), 14.6, 1.3),
        lamp_around(volume, (-1.5, 3.1, 4.1), (0.0, 0.0, 0.0), infinite=True),
        min(slices, size),
        Shading(mask=shading is SceneShading.MASK),
        Panel(panel.x, panel.y, edge, edge) if shadows else None,
        background=BACKGROUND,
    )


def make_scene(method):
    """The scene drawn by one of ``volume_rendering``'s functions."""

    def scene(profile, size, *, slices, rows, shading, shadows):
        """F000-7: the engine block in a panel for each of ``shadows``, without or with them."""
        out = []
        for panel, shadowed in zip(row_of_panels(2, size), shadows, strict=True):
            picture = _picture(panel, size, slices, rows, shading, shadowed)
            out += method(picture, profile, load=not out)
        return tuple(out)

    return scene


# n.l of surfaces that light grazes: either answer is understood, for ambient light is all that is seen there.
_GRAZING = 0.05
_SIZE, _SMALL, _IDEAL_SIZE = 256, 128, 64


def _understood(picture, surface, mask, differs):
    """Which pixels' masks are explained although they differ from the rays' answer: bool [n].

    A mask is explained if some ray gives its answer from a point where the passes may have put the pixel's
    point. That is half a step of slices nearer or farther, or a texel of the map aside. It is also explained
    if the only blocker lies within the bias.
    """
    volume, lamp = picture.volume, picture.lamp
    points, wanted = surface.points[differs], mask[differs]
    half = np.array(volume.half_extents)
    voxel = 2.0 * half[0] / volume.density.shape[2]
    texel = 2.0 * lamp.half_width / picture.map_panel.width
    # No view's slices are farther apart.
    step = 2.0 * float(np.sqrt(dot(half, half))) / picture.slices
    # A blocker so far from the surface throws a shadow, and one nearer throws none: the bias, by a step of
    # depths and half a step of the light's slices less or more.
    depth = (lamp.far - lamp.near) * picture.coding.step
    least, most = (picture.coding.bias + s for s in (-1.0, 1.0))
    aways = [max(least * depth - 0.5 * step, 0.5 * voxel), most * depth + 0.5 * step]
    along = normalize(points - np.array(picture.view.eye))
    side, up = (np.array(lamp.modelview[k][:3]) for k in (0, 1))
    out = np.abs(dot(surface.normals[differs], picture.light)) < _GRAZING
    for moved in (-0.5, 0.0, 0.5):
        for x, y in np.ndindex(3, 3):
            at = points + moved * step * along + texel * ((x - 1.0) * side + (y - 1.0) * up)
            dark, shadowed = (volume_caster.occluded(volume, at, picture.light, a / voxel) for a in aways)
            out |= np.where(wanted, ~shadowed, dark)
    return out


def _phong(picture, surface, lit):
    """Phong's model of the surface that rays found: float64 [h, w, 3], at most one."""
    s = picture.shading
    color, (fill, light, half) = (
        np.array(s.color),
        (
            np.maximum(dot(surface.normals, v), 0.0)[..., None]
            for v in (picture.eye, picture.light, picture.half)
        ),
    )
    lamp = s.diffuse * color * light + s.specular * half**s.exponent
    return np.minimum(color * (s.ambient + s.fill * fill) + np.where(lit[..., None], lamp, 0.0), 1.0)


def _truth(figure, size):
    """The second panel's Picture, its surface by rays, and where the lamp lights it."""
    p = figure.values
    picture = _picture(row_of_panels(2, size)[1], size, p["slices"], p["rows"], SceneShading.LIT, True)
    surface = volume_caster.visible(picture.volume, picture.view)
    return picture, surface, volume_caster.lit(picture.volume, surface, picture.light, LEAST)


def _compared(figure, renderer, on, size):
    """Of a machine's, or the ideal's, mask and of rays: the fraction of the surface's pixels that agree, the
    fraction that neither do nor are understood, and where both are lit or both dark; with what rays found:
    where the surface is, and its colours with shadows, without, and without the lamp.
    """
    picture, surface, lit = _truth(figure, size)
    image = renderer.window(on, figure, size, shading=SceneShading.MASK)
    # Black on the background's colour.
    drawn = (image[:, size:] != image[0, 0]).any(axis=-1)
    mask, both = image[:, size:, 0] > 0.5, surface.seen & drawn
    differs = both & (mask != lit)
    other = differs.sum() - _understood(picture, surface, mask, differs).sum()
    pixels = max(int(both.sum()), 1)
    missing = (surface.seen != drawn).sum() / pixels
    shares = (float(share) for share in (1.0 - differs.sum() / pixels, other / pixels, missing))
    facing = dot(surface.normals, np.array(picture.light)) > 0.0
    colors = [_phong(picture, surface, light) for light in (lit, facing, np.zeros_like(lit))]
    return (*shares, both & ~differs, surface.seen & drawn, colors)


def _light_checks(figure, renderer, agreed, both, colors):
    """The light of both displayed panels, and the shadows that only the second has."""
    window = np.clip(renderer.machine_window(figure, _SIZE), 0.0, 1.0)
    bare, shadowed = window[:, :_SIZE], window[:, _SIZE:]
    with_shadows, without, unlit = colors
    yield DATA.check(
        "median of |machine - Phong's model of the rays' surface|",
        float(np.median(np.abs(shadowed - with_shadows)[agreed])),
        Answer.MACHINE,
    )
    shares = []
    for panel, of in ((bare, without), (shadowed, with_shadows)):
        flat = np.broadcast_to(of[both].mean(axis=0), of[both].shape)
        shares.append(least_share(panel[both], of[both], flat, unlit[both]))
    yield DATA.check(
        "of what the lamp and the surface's shape change, the least share that is seen",
        min(shares),
        Answer.MACHINE,
    )
    changed = both & (np.abs(with_shadows - without).max(axis=-1) > 0.05)
    one, other = with_shadows[changed], without[changed]
    yield DATA.check(
        "of what shadows change, the lesser share that is as in its panel",
        min(least_share(shadowed[changed], one, other), least_share(bare[changed], other, one)),
        Answer.MACHINE,
    )


def checks(figure, renderer):
    """Masks and light against rays cast at the same densities; which pixels shadows change."""
    _, ideal_other, ideal_missing, *_ = _compared(figure, renderer, Answer.IDEAL, _IDEAL_SIZE)
    agreeing, other, missing, *of_light = _compared(figure, renderer, Answer.MACHINE, _SIZE)
    # Both on the same panel: beside each other they differ where rounding takes another slice.
    size, swapped = _SMALL, {"shadows": (True, False)}
    plain, shadowed = (renderer.machine_window(figure, size, **how)[:, :size] for how in ({}, swapped))
    lit = renderer.machine_window(figure, size, shading=SceneShading.MASK, **swapped)[:, :size, 0] > 0.5
    darker = (shadowed < plain - 0.05).any(axis=-1).sum() / (plain != plain[0, 0]).any(axis=-1).sum()
    rays = "fraction of the iso-surface's pixels"
    return (
        DATA.check(
            "{rays} that differ from rays and are not understood", ideal_other, Answer.IDEAL, rays=rays
        ),
        DATA.check("pixels where either alone has a surface, {rays}", ideal_missing, Answer.IDEAL, rays=rays),
        DATA.check("{rays} that are lit or dark as rays say", agreeing, Answer.MACHINE, rays=rays),
        DATA.check("{rays} that differ from rays and are not understood", other, Answer.MACHINE, rays=rays),
        DATA.check("pixels where either alone has a surface, {rays}", missing, Answer.MACHINE, rays=rays),
        *_light_checks(figure, renderer, *of_light),
        DATA.check(
            "how much brighter shadows make any pixel",
            float((shadowed - plain).max()),
            Answer.MACHINE,
            at_most=1.0 / 255.0,
        ),
        DATA.check(
            "largest difference of pixels that are not in shadow",
            float(np.abs(shadowed - plain)[lit].max(initial=0.0)),
            Answer.MACHINE,
            at_most=1.0 / 255.0,
        ),
        DATA.check("{rays} that shadows darken", float(darker), Answer.MACHINE, rays=rays),
    )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "slices": word.of(
            word.Whole(2, 512), 256, "Slices through the volume, as many as the panel has pixels at most."
        ),
        "rows": word.of(
            word.Whole(8, 128, power=True),
            128,
            "Voxels of the volume along its longest edge, about half the panel's pixels at most.",
        ),
        "shading": word.SHADING(SceneShading.LIT),
        "shadows": word.of(
            word.Several((word.Flag(),) * 2),
            (False, True),
            "Whether the engine throws shadows, in either panel.",
        ),
    },
    methods=(
        # The InfiniteReality can draw it as the Octane does, but with twelve bits it makes 1.5 million
        # fragments a second (Measured), and this figure has 69 million.
        Method("imaging subset", make_scene(imaging), IMAGING_MACHINES_8),
        Method("register combiners", make_scene(combiners), ("GEFORCE_3",)),
    ),
    acceptance=checks,
)

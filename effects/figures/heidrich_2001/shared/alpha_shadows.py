"""Parts of the figures of alpha-coded shadow maps, H36 to H38.

They are the still life under a lamp, the boards' ways to compare, and checks against rays.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import agreement, ray_caster, shadow_reference
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Panel
from fixedpipe.effects.scenes.objects_and_lamps import Lamp, detail_of
from fixedpipe.effects.scenes.still_life import still_life, still_life_view
from fixedpipe.effects.shadows import alpha_coded_shadows as alpha
from fixedpipe.effects.shadows.lit_scene import SceneShading, lit_pass, map_edge, unlit_pass

# Position, target, near, far, field of view of a Lamp. From the left and so high that no shadow leaves the
# picture; as narrow as encloses the scene itself, not its bounding box, whose upper corners are empty: 8 bits
# of depth are to be made the most of. Measured: 33.81 degrees and 7.263 to 11.389 hold what throws shadows.
LAMP = ((-5.0, 8.6, 0.6), (-0.6, 0.3, -0.2), 7.2, 11.45, 34.0)
# Of maps: texels along an edge, over a panel's pixels.
RATIO = 2.0
# The figures' parameters: 8 bits of alpha, a bias of two of its steps.
PARAMETERS = {
    "lamp": word.of(
        word.Several(
            (
                word.POSITION_KIND,
                word.POSITION_KIND,
                word.Number(0.01, 1000.0),
                word.Number(0.01, 1000.0),
                word.Number(1.0, 150.0),
            )
        ),
        LAMP,
        "The lamp: its place, what it looks at, its near and its far plane, its field of view in degrees.",
    ),
    "ratio": word.RATIO(RATIO),
    "bits": word.of(word.Whole(4, 12), 8, "Bits of the depths in alpha.", "bits"),
    "bias": word.NUMBER(2.0, "How far depths are moved away.", "steps of alpha", low=0.0, high=255.0),
    "background": word.BACKDROP(BACKGROUND),
    "shading": word.SHADING(SceneShading.LIT),
}


@dataclass(frozen=True)
class Board:
    """A way to compare depths: one of ``alpha_coded_shadows``' functions, and the extra arguments of it and
    of ``store_map``.

    free        further steps of difference that pass its test; the map's bias is smaller by as many
    ideal_more  steps by which the ideal's bias is less than the machine's in the mean. If both depths are
                rounded, half a step more of difference passes
    """

    way: object
    free: float = 0.0
    ideal_more: float = 0.5
    stored: dict = field(default_factory=dict)
    compared: dict = field(default_factory=dict)


COMBINERS = Board(alpha.with_combiners)
# On the ideal its test lets half a step pass, not one.
ENVIRONMENTS = Board(alpha.with_environments, free=1.0, ideal_more=1.0)
# On the ideal half a step is scaled to one half.
ONE_UNIT = Board(alpha.with_one_unit, ideal_more=0.0)
ONE_UNIT_OF_TWELVE_BITS = Board(alpha.with_one_unit, ideal_more=0.0, compared={"alpha_bits": 12})
ONE_UNIT_ADDED = Board(
    alpha.with_one_unit, ideal_more=0.0, stored={"subtract": False}, compared={"subtract": False}
)


@lru_cache(8)
def lit_scene_of(size, lamp):
    """The still life as a panel of ``size`` pixels deserves it, and its lamp."""
    return still_life(detail_of(size)), Lamp(*lamp)


def stored(panel, profile, board, coding, *, lamp, ratio, shading, name=alpha.MAP):
    """P0 in a panel."""
    scene, light = lit_scene_of(panel.width, lamp)
    edge = map_edge(panel.width, ratio)
    settings = {"name": name, "shading": shading, **board.stored}
    return alpha.store_map(scene, light, panel, edge, profile, coding, **settings)


def compared(panel, profile, board, coding, *, lamp, background, shading, name=alpha.MAP):
    """A frame's passes after the map's."""
    scene, light = lit_scene_of(panel.width, lamp)
    settings = {"name": name, "shading": shading, "background": background, **board.compared}
    return board.way(scene, still_life_view(panel), light, profile, coding, **settings)


def without_shadows(panel, *, lamp, background, shading):
    """The same light where no shadow is thrown."""
    scene, light = lit_scene_of(panel.width, lamp)
    view = still_life_view(panel)
    return (
        alpha.clear_window(view, background),
        *unlit_pass(scene, view, shading),
        *lit_pass(scene, view, light, shading),
    )


def by_rays(size, lamp, background, shading):
    """The reference of a figure's picture: a Shot of the still life under its lamp."""
    scene, light = lit_scene_of(size, lamp)
    return shadow_reference.Shot(
        scene, still_life_view(Panel(0, 0, size, size)), (light,), background, shading
    )


@lru_cache(4)
def truth(size, lamp):
    """What rays say of a panel."""
    scene, light = lit_scene_of(size, lamp)
    return agreement.truth_of(scene, still_life_view(Panel(0, 0, size, size)), light)


@lru_cache(4)
def faces_the_lamp(size, lamp):
    """Pixels whose surface the lamp could light: bool [size, size]. Elsewhere (n.l)+ is zero, and whether a
    shadow lies there as well shows in no picture.
    """
    known = truth(size, lamp)
    points = known.shown.points
    directions, _ = ray_caster.to_light(points.reshape(-1, 3), known.lamp)
    return dot(known.shown.normals, normalize(directions).reshape(points.shape)) > 0.0


def agreements(figure, masks, size, column, bits, bias):
    """``Agreement`` with rays of one column of a picture of masks, of all pixels and of those that face the
    lamp. ``bias``: in all, in steps of ``bits`` bits.
    """
    lamp, ratio = figure.values["lamp"], figure.values["ratio"]
    picture = masks[:, column * size : (column + 1) * size]
    known, mask = truth(size, lamp), agreement.lit_mask(picture)
    # The bias and a step that roundings take hide what is nearer to the surface behind it.
    contact = (bias + 1.0) * (known.lamp.far - known.lamp.near) / (2.0**bits - 1.0)
    settings = {"map_edge": map_edge(size, ratio), "contact": contact}
    facing = faces_the_lamp(size, lamp)
    return (
        agreement.compare(mask, known, **settings),
        agreement.compare(mask, known, where=facing, **settings),
    )


def agreement_checks(figure, renderer, board, size, column, *, least, least_facing, other):
    """Checks that a column's shadows are those of rays: at ``least`` and ``least_facing`` of the pixels, with
    at most ``other`` unexplained ones. The ideal, with the same bias in the mean, must agree better.
    """
    parameters = figure.values_of(renderer.method)
    bits, bias = parameters["bits"], parameters["bias"]
    ideal_bias = bias + board.ideal_more
    masks = renderer.machine_window(figure, size, shading=SceneShading.MASK)
    whole, facing = agreements(figure, masks, size, column, bits, bias)
    masks = renderer.ideal_window(figure, size, shading=SceneShading.MASK, bias=ideal_bias)
    ideal, _ = agreements(figure, masks, size, column, bits, ideal_bias)
    return (
        Check(
            "pixels whose shadow is the rays'",
            whole.agreeing,
            at_least=least,
            on=Answer.MACHINE,
            reason="what differs lies within a texel and a half of a shadow's edge, most of it where a "
            "round thing turns away from the lamp; measured at the first correct picture",
        ),
        Check(
            "the same of what faces the lamp, where a shadow can be seen",
            facing.agreeing,
            at_least=least_facing,
            on=Answer.MACHINE,
            reason="the catalogue's bound for the engine block with 8 bits and a bias of two steps",
        ),
        Check(
            "differing pixels that nothing explains",
            whole.other,
            at_most=other,
            on=Answer.MACHINE,
            reason="acne that the bias leaves where the light "
            "comes in flat; measured at the first correct picture",
        ),
        Check(
            "pixels that differ from the rays: the ideal's over the machine's",
            (1.0 - ideal.agreeing) / (1.0 - whole.agreeing),
            at_most=1.01,
            on=Answer.IDEAL,
            reason="the same bias in the mean, and no rounding to steps: a bias of two steps leaves little "
            "of what that costs, and twelve bits nothing",
        ),
        Check(
            "differing pixels that nothing explains",
            ideal.other,
            at_most=other,
            on=Answer.IDEAL,
            reason="the algorithm's own: a texel's depth is its centre's",
        ),
    )


def brightness_checks(figure, renderer, size, shadowed, without):
    """Checks that shadows only darken: columns ``shadowed`` and ``without`` of a lit picture."""
    picture = renderer.machine_window(figure, size)
    mask = renderer.machine_window(figure, size, shading=SceneShading.MASK)
    columns = [slice(k * size, (k + 1) * size) for k in (shadowed, without)]
    a, b = (picture[:, c] for c in columns)
    lit = agreement.lit_mask(mask[:, columns[0]])
    seen = agreement.lit_mask(mask[:, columns[1]])
    dark = seen & ~lit & faces_the_lamp(size, figure.values["lamp"])
    return (
        Check(
            "how much brighter a pixel is with shadows than without",
            float((a - b).max()),
            at_most=1.0 / 255.0 + 1e-9,
            on=Answer.MACHINE,
            reason="the catalogue's: the same passes, in another place of the window; float64's own rounding",
        ),
        Check(
            "largest difference where the light is not blocked",
            float(np.abs(a - b)[lit].max()),
            at_most=1.0 / 255.0 + 1e-9,
            on=Answer.MACHINE,
            reason="the catalogue's: the same passes, in another place of the window; float64's own rounding",
        ),
        Check(
            "mean of what is left in shadow on faces towards the lamp, of the light there",
            float(a[dark].sum() / b[dark].sum()) if dark.any() else float("nan"),
            at_most=0.43,
            on=Answer.MACHINE,
            reason="only ambient light is there; measured at "
            "the first correct picture, with a third of slack",
        ),
    )


def pass_checks(figure, renderer, board, coding, wanted, reason, size=32):
    """Checks of a frame's number of passes: ``wanted`` if nothing moves, and one more if something does."""
    panel, parameters = Panel(0, 0, size, size), figure.values
    common = {"lamp": parameters["lamp"], "shading": SceneShading.LIT}
    frame = compared(panel, renderer.profile, board, coding, background=parameters["background"], **common)
    map_ = stored(panel, renderer.profile, board, coding, ratio=parameters["ratio"], **common)
    return (
        Check(
            "passes of a frame where nothing moves",
            alpha.passes(frame),
            at_most=wanted,
            on=Answer.MACHINE,
            reason=reason,
        ),
        Check(
            "passes where light or objects move",
            alpha.passes((*map_, *frame)),
            at_most=wanted + 1,
            on=Answer.MACHINE,
            reason=reason,
        ),
    )

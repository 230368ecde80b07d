"""F003-21: not enough bias, the right one, too much (Z12)."""

from fixedpipe.effects.acceptance import agreement, ray_caster, shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.map_bias import acne, gap, shadows_under_offsets
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.board import board_view, ring_and_board
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import OFFSET_UNITS

DATA = figure_data(__file__, "F003-21")

_SIZE = 256


def _hidden_by_the_top(scene, truth):
    """The floor's pixels from which the board's top hides the lamp: bool [_SIZE, _SIZE]."""
    (board,) = (thing.surface for thing in scene.objects if thing.name == "board")
    top = ray_caster.RayCaster(
        board.positions[board.triangles[board.normals[board.triangles[:, 0], 1] > 0.9]]
    )
    out = truth.shown.object == 0
    points = truth.shown.points[out]
    out[out] = top.occluded(points, *ray_caster.to_light(points, truth.lamp)[:1], longest=1.0)
    return out


def checks(figure, renderer):
    """Speckle on the lit floor, and the gap between the board and its shadow."""
    scene, lamp = ring_and_board(_SIZE)
    truth = agreement.truth_of(scene, board_view(Panel(0, 0, _SIZE, _SIZE)), lamp)
    edge = map_edge(_SIZE, figure.values["ratio"])
    line = _hidden_by_the_top(scene, truth)
    for on in Answer:
        picture = renderer.window(on, figure, _SIZE, shading=SceneShading.MASK)
        masks = [agreement.lit_mask(picture[:, k * _SIZE : (k + 1) * _SIZE]) for k in range(3)]
        little, right, much = (acne(mask, truth) for mask in masks)
        gaps = [gap(mask, truth, edge) for mask in masks]
        found = agreement.compare(masks[1], truth, map_edge=edge, where=truth.shown.object == 0)
        yield DATA.check("not enough: lit floor that is dark", little, on)
        yield DATA.check("correct: lit floor that is dark", right, on)
        yield DATA.check("too much: lit floor that is dark", much, on)
        yield DATA.check("correct: gap behind the board, texels", gaps[1], on)
        yield DATA.check("too much: gap behind the board, texels", gaps[2], on)
        yield DATA.check(
            "too much: floor in the shadow of the board's top that is dark",
            float((~masks[2])[line].mean()),
            on,
        )
        yield DATA.check("correct: floor that agrees with rays", found.agreeing, on)
        yield DATA.check("correct: floor of no understood kind", found.other, on)


def reference(size, *, offsets, shading, **_):
    """The shadows by rays, which need no bias: the same in every panel."""
    scene, lamp = ring_and_board(size)
    shot = shadow_reference.Shot(scene, board_view(Panel(0, 0, size, size)), (lamp,), shading=shading)
    return shadow_reference.row(size, [shot] * len(offsets))


FIGURE = Figure(
    **DATA.words,
    parameters={
        "ratio": word.RATIO(1),
        "offsets": word.of(
            word.Several((word.OFFSET_KIND,) * 3),
            ((0.0, 0.0), (1.5, OFFSET_UNITS), (14.0, OFFSET_UNITS)),
            "The polygon offset of each panel, factor and units.",
        ),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=(
        Method(
            "depth texture times the light", shadows_under_offsets, ("GEFORCE_3", "NV2A", "INFINITE_REALITY")
        ),
    ),
    acceptance=checks,
    reference=reference,
)

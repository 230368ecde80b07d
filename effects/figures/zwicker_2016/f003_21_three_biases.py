"""F003-21: not enough bias, the right one, too much (Z12)."""

from fixedpipe.effects.acceptance import agreement, shadow_reference
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.map_bias import acne, gap, shadows_under_offsets
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry.views import Panel
from fixedpipe.effects.scenes.board import board_view, ring_and_board
from fixedpipe.effects.shadows.lit_scene import SceneShading, map_edge
from fixedpipe.effects.shadows.shadow_maps import OFFSET_UNITS

_SIZE = 256


def checks(figure, renderer):
    """Speckle on the lit floor, and the gap between the board and its shadow."""
    scene, lamp = ring_and_board(_SIZE)
    truth = agreement.truth_of(scene, board_view(Panel(0, 0, _SIZE, _SIZE)), lamp)
    edge = map_edge(_SIZE, figure.values["ratio"])
    for on in Answer:
        picture = renderer.window(on, figure, _SIZE, shading=SceneShading.MASK)
        masks = [agreement.lit_mask(picture[:, k * _SIZE : (k + 1) * _SIZE]) for k in range(3)]
        said = "the catalogue's acceptance"
        little, right, much = (acne(mask, truth) for mask in masks)
        gaps = [gap(mask, truth, edge) for mask in masks]
        found = agreement.compare(masks[1], truth, map_edge=edge, where=truth.shown.object == 0)
        yield Check("not enough: lit floor that is dark", little, at_least=0.2, on=on, reason=said)
        yield Check("correct: lit floor that is dark", right, at_most=0.001, on=on, reason=said)
        yield Check("too much: lit floor that is dark", much, at_most=0.001, on=on, reason=said)
        yield Check("correct: gap behind the board, texels", gaps[1], at_most=1.0, on=on, reason=said)
        yield Check("too much: gap behind the board, texels", gaps[2], at_least=3.0, on=on, reason=said)
        yield Check(
            "correct: floor that agrees with rays",
            found.agreeing,
            at_least=0.99,
            on=on,
            reason="shadows lie where rays have them; measured 0.995",
        )
        yield Check(
            "correct: floor of no understood kind",
            found.other,
            at_most=0,
            on=on,
            reason="what differs lies at an edge or an outline",
        )


def reference(size, *, offsets, shading, **_):
    """The shadows by rays, which need no bias: the same in every panel."""
    scene, lamp = ring_and_board(size)
    shot = shadow_reference.Shot(scene, board_view(Panel(0, 0, size, size)), (lamp,), shading=shading)
    return shadow_reference.row(size, [shot] * len(offsets))


FIGURE = Figure(
    id="F003-21",
    title="Bias: not enough, correct, too much",
    caption=(
        "One shadow map whose depths were moved away from the light by three polygon offsets: none (left), "
        "1.5 times the slope and 4 units (middle), 14 times the slope (right). Beyond the "
        "floor's edge the ground is in no map, and lit."
    ),
    must_see=(
        "Left stripes and speckle on all that is lit and in the map: surfaces shade themselves. In the "
        "middle clean light and shadows that begin where things stand, within a texel, which lights a pixel "
        "or two at the board's foot. Right clean light too, but the board, the ring and the "
        "sphere float: between their feet and their shadows there is light (and a thin line of shadow, of "
        "the board's narrow top, whose slope is less)."
    ),
    source="Zwicker2016",
    techniques=("Z10", "Z12"),
    panels=("too little", "correct", "too much"),
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

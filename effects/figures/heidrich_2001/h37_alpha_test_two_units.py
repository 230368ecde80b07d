"""H37: shadows by an alpha test, with two texture units: register combiners, texture environments."""

from dataclasses import replace

from fixedpipe.effects.acceptance import shadow_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import alpha_shadows
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.shadows.alpha_coded_shadows import Coding
from fixedpipe.effects.shadows.lit_scene import SceneShading

DATA = figure_data(__file__, "H37")


def make_scene(board):
    """The scene drawn in a board's way."""

    def scene(profile, size, *, lamp, ratio, bits, bias, background, shading):
        """H37: without shadows, with a map that has no bias, and with one that has."""
        left, middle, right = row_of_panels(3, size)
        common = {"lamp": lamp, "shading": shading}
        out = [
            Coding(bits).ramp(profile),
            *alpha_shadows.without_shadows(left, background=background, **common),
        ]
        for panel, steps in ((middle, 0.0), (right, bias)):
            coding, name = Coding(bits, bias=steps - board.free), f"map, {steps:g} steps away"
            out += alpha_shadows.stored(panel, profile, board, coding, ratio=ratio, name=name, **common)
            out += alpha_shadows.compared(
                panel, profile, board, coding, background=background, name=name, **common
            )
        return tuple(out)

    return scene


_BOARDS = {"register combiners": alpha_shadows.COMBINERS, "texture environments": alpha_shadows.ENVIRONMENTS}
_SIZE = 256
_PASSES = "the paper's count; a shadow extension that marks a stencil needs as many (erratum E000.8)"


def checks(figure, renderer):
    """Shadows against rays, acne without a bias, that shadows only darken, and how many passes there are."""
    board, bits = _BOARDS[renderer.method.name], figure.values["bits"]
    masks = renderer.machine_window(figure, _SIZE, shading=SceneShading.MASK)
    spotted, _ = alpha_shadows.agreements(figure, masks, _SIZE, 1, bits, 0.0)
    return (
        *alpha_shadows.agreement_checks(
            figure, renderer, board, _SIZE, 2, least=0.976, least_facing=0.985, other=9
        ),
        DATA.check(
            "pixels with acne where the map has no bias", spotted.other / spotted.compared, Answer.MACHINE
        ),
        *alpha_shadows.brightness_checks(figure, renderer, _SIZE, 2, 0),
        *alpha_shadows.pass_checks(figure, renderer, board, Coding(bits), 3, _PASSES),
    )


def reference(size, *, lamp, shading, background, **_):
    """The light without shadows, and twice the shadows by rays."""
    shot = alpha_shadows.by_rays(size, lamp, background, shading)
    return shadow_reference.row(size, [replace(shot, shadows=False), shot, shot])


FIGURE = Figure(
    **DATA.words,
    parameters=alpha_shadows.PARAMETERS,
    methods=(
        Method(
            "register combiners", make_scene(alpha_shadows.COMBINERS), ("GEFORCE_256", "GEFORCE_3", "NV2A")
        ),
        Method("texture environments", make_scene(alpha_shadows.ENVIRONMENTS), ("MULTITEXTURE", "G400")),
    ),
    acceptance=checks,
    reference=reference,
)

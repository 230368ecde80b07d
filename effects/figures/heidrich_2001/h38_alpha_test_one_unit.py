"""H38: shadows by an alpha test, with one texture unit and destination alpha."""

import numpy as np

from fixedpipe.effects.acceptance import shadow_reference
from fixedpipe.effects.acceptance.agreement import lit_mask, silhouettes
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import alpha_shadows
from fixedpipe.effects.geometry.views import row_of_panels
from fixedpipe.effects.passes.draws import copy_of_panel
from fixedpipe.effects.scenes.still_life import still_life_view
from fixedpipe.effects.shadows.alpha_coded_shadows import (
    ONLY_ALPHA,
    Coding,
    difference_in_alpha,
    scale_alpha,
    show_alpha,
)
from fixedpipe.effects.shadows.lit_scene import SceneShading
from fixedpipe.pipeline.commands import Saturate
from fixedpipe.pipeline.pixel_transfer import PixelTransfer
from fixedpipe.pipeline.state import PassState

DATA = figure_data(__file__, "H38")


def stretched(panel, stretch, subtract):
    """The command that stretches a panel's alpha by the factor ``stretch``: from zero upwards, or without
    ``subtract`` from one downwards.
    """
    transfer = PixelTransfer(
        scale=(1.0, 1.0, 1.0, stretch), bias=(0.0, 0.0, 0.0, 0.0 if subtract else 1.0 - stretch)
    )
    state = PassState(scissor=panel.scissor, color_mask=ONLY_ALPHA)
    return copy_of_panel(f"stretch alpha {stretch:g} times", panel, state, transfer)


def make_scene(board):
    """The scene drawn in a board's way."""

    def scene(profile, size, *, lamp, ratio, bits, bias, background, shading, stretch):
        """H38: the difference of depths in destination alpha; what the copy makes of it; the picture."""
        coding, common = Coding(bits, bias=bias), {"lamp": lamp, "shading": shading}
        left, middle, right = row_of_panels(3, size)
        things, light = alpha_shadows.lit_scene_of(size, lamp)
        subtract = board.stored.get("subtract", True)
        out = [coding.ramp(profile, subtract)]
        out += alpha_shadows.stored(left, profile, board, coding, ratio=ratio, **common)
        for panel in (left, middle):
            view = still_life_view(panel)
            settings = {"background": background, "subtract": subtract, "shading": shading}
            out += difference_in_alpha(things, view, light, profile, coding, **settings)
            if panel is middle:
                out.append(scale_alpha(panel, bits, subtract=subtract))
                out.append(Saturate(label="alpha 0 or 1", scissor=panel.scissor))
            elif stretch != 1.0:
                out.append(stretched(panel, stretch, subtract))
            out.append(show_alpha(panel))
        out += alpha_shadows.compared(right, profile, board, coding, background=background, **common)
        return tuple(out)

    return scene


_BOARDS = {
    "one texture unit": alpha_shadows.ONE_UNIT,
    "one texture unit, twelve bits": alpha_shadows.ONE_UNIT_OF_TWELVE_BITS,
    "one texture unit, added": alpha_shadows.ONE_UNIT_ADDED,
}
_SIZE = 256
_PASSES = 'without the light, ramp, map, copy of the window, light; "at least three", says the paper'


def _beyond_the_map(size, lamp, stretch):
    """The ground's pixels that no texel of the map shows, and which of them lie beyond the lamp's far plane:
    two bool [size, size]. None is at a thing's outline or at the map's edge, or so near to that plane that
    what is stretched is grey.
    """
    known, objects = alpha_shadows.truth(size, lamp), alpha_shadows.lit_scene_of(size, lamp)[0].objects
    number = [thing.name for thing in objects].index("ground")
    points, plane = known.shown.points, np.array(known.lamp.depth_plane)
    s, t, _, q = (points @ np.array(row[:3]) + row[3] for row in known.lamp.texture_matrix)
    outside = np.maximum(np.abs(s - 0.5 * q), np.abs(t - 0.5 * q)) > 0.51 * np.abs(q)
    depth = points @ plane[:3] + plane[3]
    outside &= (known.shown.object == number) & ~silhouettes(known) & (np.abs(depth - 1.0) > 1.0 / stretch)
    return outside, outside & (depth > 1.0)


def checks(figure, renderer):
    """Shadows against rays, and that the copy makes alpha zero or one, as the difference is."""
    board = _BOARDS[renderer.method.name]
    bits = figure.values_of(renderer.method)["bits"]
    stretch = figure.values_of(renderer.method)["stretch"]
    shown = renderer.machine_window(figure, _SIZE, shading=SceneShading.MASK)[:, :_SIZE, 0]
    picture = renderer.machine_window(figure, _SIZE, shading=SceneShading.MASK, stretch=1.0)
    difference, scaled = (picture[:, k * _SIZE : (k + 1) * _SIZE, 0] for k in (0, 1))
    # Subtracted, what is above zero is in shadow; added, what is one.
    dark = difference > 0.0 if board is not alpha_shadows.ONE_UNIT_ADDED else difference == 1.0
    lit = lit_mask(picture[:, 2 * _SIZE :])
    seen = lit | (scaled == 1.0)
    top = 0.0 if board is not alpha_shadows.ONE_UNIT_ADDED else 1.0
    spread = np.clip(top + stretch * (difference - top), 0.0, 1.0)
    outside, beyond = _beyond_the_map(_SIZE, figure.values["lamp"], stretch)
    black = outside & ~beyond if board is alpha_shadows.ONE_UNIT_ADDED else outside
    right = np.where(black, shown <= 1.0 / 255.0, shown >= 0.8)
    return (
        DATA.check(
            "ground beyond the map that is black, or nearly white beyond the far plane, a share",
            float(right[outside].mean()),
            Answer.MACHINE,
        ),
        DATA.check(
            "left panel less what alpha holds, stretched, largest",
            float(np.abs(shown - spread).max()),
            Answer.MACHINE,
        ),
        *alpha_shadows.agreement_checks(
            figure, renderer, board, _SIZE, 2, least=0.976, least_facing=0.985, other=9
        ),
        DATA.check(
            "pixels whose alpha the copy leaves between zero and one",
            float(((scaled > 0.0) & (scaled < 1.0)).sum()),
            Answer.MACHINE,
            bits=bits,
        ),
        DATA.check(
            "pixels where the copy's alpha is not what the difference says",
            float((dark != (scaled == 1.0)).mean()),
            Answer.MACHINE,
        ),
        DATA.check(
            "pixels of the scene that are lit and have an alpha of one, or neither",
            float((lit == (scaled == 1.0))[seen].mean()),
            Answer.MACHINE,
        ),
        DATA.check(
            "differences of depths, number",
            float(len(np.unique(np.round(difference * (2**bits - 1))))),
            Answer.MACHINE,
        ),
        *alpha_shadows.pass_checks(figure, renderer, board, Coding(bits), 5, _PASSES),
    )


def reference(size, *, lamp, shading, background, **_):
    """The picture's shadows by rays; what alpha holds has no reference."""
    return shadow_reference.row(size, [None, None, alpha_shadows.by_rays(size, lamp, background, shading)])


FIGURE = Figure(
    **DATA.words,
    parameters={
        **alpha_shadows.PARAMETERS,
        "stretch": word.NUMBER(
            2.0,
            "How many times the left panel's alpha is stretched, from zero; on boards that add, from one.",
            low=1.0,
            high=256.0,
        ),
    },
    methods=(
        Method("one texture unit", make_scene(alpha_shadows.ONE_UNIT), ("OCTANE", "OPENGL_1_2_IMAGING")),
        # The bias of 8 bits, with the half step that rounding adds there, in steps of 12: what it hides is
        # the slope of what lies under a texel (study P4).
        Method(
            "one texture unit, twelve bits",
            make_scene(alpha_shadows.ONE_UNIT_OF_TWELVE_BITS),
            ("INFINITE_REALITY",),
            {"bits": 12, "bias": 40.0},
        ),
        Method(
            "one texture unit, added",
            make_scene(alpha_shadows.ONE_UNIT_ADDED),
            ("OPENGL_1_2", "TEXRAM"),
            {"stretch": 32.0},
        ),
    ),
    acceptance=checks,
    reference=reference,
)

"""F003-26: where z-pass fails: the eye in shadow, and a near plane that cuts a shadow volume (Z25)."""

from fixedpipe.effects.acceptance import ray_caster
from fixedpipe.effects.acceptance.agreement import compare, lit_mask, truth_of
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.counted_volumes import counted, lamp_without_frustum
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene, detail_of
from fixedpipe.effects.scenes.still_life import still_life
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading

OPERATIONS = {"clamped counts": shadow_volumes.CLAMPED, "wrapping counts": shadow_volumes.WRAPPING}
EYE, CENTER, FIELD_OF_VIEW = (0.6, 4.9, 8.4), (0.0, 0.62, 0.0), 31.0
# What is in shadow; two panels each.
CASES = ("eye", "near plane")


def setting(case, panel, detail, *, light, hidden, shares, boards, nears):
    """The still life, a board beside the picture that throws its shadow over the eye or over the near plane,
    its lamp and the camera: Scene, Lamp, View.

    Of each case: ``hidden``, the middle of the board's shadow; ``shares``, how far along the way there from
    the lamp the board is; ``boards``, its edges; ``nears``, the near plane's distance.
    """
    k = CASES.index(case)
    view = View(panel, look_at(EYE, CENTER), perspective(FIELD_OF_VIEW, 1.0, nears[k], 24.0), EYE, False)
    place = (at + shares[k] * (to - at) for at, to in zip(light, hidden[k], strict=True))
    board = Object("board", surfaces.box(*boards[k]).moved(*place), (0.5, 0.5, 0.5))
    return Scene((*still_life(detail).objects, board)), lamp_without_frustum(light), view


def make_scene(operations):
    """The scene drawn with CLAMPED or WRAPPING operations."""

    def scene(profile, size, *, background, shading, **places):
        """Each case by z-pass, which fails, and z-fail."""
        ways = [(c, a) for c in CASES for a in (shadow_volumes.z_pass, shadow_volumes.z_fail)]
        out = []
        for panel, (case, algorithm) in zip(row_of_panels(4, size), ways, strict=True):
            objects, lamp, view = setting(case, panel, detail_of(size), **places)
            out += (
                panel.clear(background),
                *algorithm(objects, view, lamp, profile, shading, operations=operations),
            )
        return tuple(out)

    return scene


# How much of the picture z-pass gets wrong with the eye in shadow, and of what is seen through the shadowed
# part of the near plane: the catalogue's bound, and where counts wrap, all but where volumes overlap.
_WRONG = {
    "clamped counts": (0.30, "the catalogue's; shadows are gone, as a count below zero is held there"),
    "wrapping counts": (0.90, "a complement: what is lit counts -1, and what one volume hides 0"),
}


def checks(figure, renderer):
    """How wrong z-pass is, and where; z-fail against rays."""
    operations, size = OPERATIONS[renderer.method.name], 512
    least, reason = _WRONG[renderer.method.name]
    places = {name: value for name, value in figure.values.items() if name not in ("background", "shading")}
    drawn = lit_mask(renderer.machine_window(figure, size, shading=SceneShading.MASK))
    for case in CASES:
        objects, lamp, view = setting(case, Panel(0, 0, size, size), 40, **places)
        truth = truth_of(objects, view, lamp)
        # Where the near plane, which z-pass counts from, is in shadow.
        on_plane, _ = ray_caster.primary_rays(view)
        to_lamp, longest = ray_caster.to_light(on_plane, lamp)
        hidden = truth.caster.occluded(on_plane, to_lamp, longest=longest).reshape(size, size)
        seen = truth.shown.something
        yield Check(
            f"part of the near plane that is in shadow, {case} in shadow", float(hidden.mean()),
            at_least=1.0 if case == CASES[0] else 0.3, on=Answer.IDEAL,
            reason="the board's shadow: all of it, or a part",
        )  # fmt: skip
        for on in (Answer.IDEAL, Answer.MACHINE) if case == CASES[0] else (Answer.MACHINE,):
            if on is Answer.MACHINE:
                first = 2 * CASES.index(case) * size
                wrong, right = (drawn[:, x : x + size] for x in (first, first + size))
            else:
                wrong, right = (
                    counted(renderer, algorithm, view, objects, lamp, on, operations)[1]
                    for algorithm in (shadow_volumes.z_pass, shadow_volumes.z_fail)
                )
            yield Check(
                f"z-pass: wrong pixels of those seen through the near plane's shadow, {case} in shadow",
                float((wrong != truth.lit)[seen & hidden].mean()), at_least=least, on=on, reason=reason,
            )  # fmt: skip
            yield Check(
                f"z-fail: pixels lit or not as rays say, {case} in shadow",
                float((right == truth.lit)[seen].mean()), at_least=0.999, on=on, reason="the catalogue's",
            )  # fmt: skip
            if not hidden.all():
                yield Check(
                    f"z-pass: wrong pixels of the others, {case} in shadow",
                    float((wrong != truth.lit)[seen & ~hidden].mean()), at_most=0.0011, on=on,
                    reason="there z-pass counts from outside all volumes; edges differ by a pixel; measured "
                    "at the first correct picture, with at most a third of slack",
                )  # fmt: skip
        yield Check(
            f"z-fail: pixels lit or not unlike the rays', not on an edge, {case} in shadow",
            compare(right, truth).other, at_most=0.0, on=Answer.MACHINE,
            reason="shadow volumes are exact in the picture",
        )  # fmt: skip


FIGURE = Figure(
    id="F003-26",
    title="Where z-pass fails",
    caption=(
        "Two cases, each by z-pass, which fails, and by z-fail: a board beside the picture throws its shadow "
        "over the eye (left pair), or over the right of the near plane, which cuts the board's shadow volume "
        "open (right pair)."
    ),
    must_see=(
        "Where counts are clamped, z-pass loses the shadows on what is seen through the board's: nearly all "
        "in the first picture, and those right of a slanting line in the third; only where two shadows lie "
        "over each other one is left. Where counts wrap, it draws light for shadow and shadow for light "
        "there. The second and the fourth picture are right."
    ),
    source="Zwicker2016",
    techniques=("Z22", "Z23", "Z24", "Z25"),
    panels=("z-pass, eye in shadow", "z-fail", "z-pass, cut by near", "z-fail"),
    size=384,
    parameters={
        "light": word.POSITION((-5.0, 5.2, -2.0), "Where the light is."),
        "hidden": word.of(
            word.Several((word.POSITION_KIND,) * 2),
            (EYE, (0.95, 2.75, 4.0)),
            "The middle of the board's shadow, where the eye is in shadow, then where the near plane is.",
            "world coordinates",
        ),
        "shares": word.of(
            word.Several((word.Number(0.05, 0.95),) * 2),
            (0.6, 0.35),
            "How far along the way from the light to there the board is, of either.",
        ),
        "boards": word.of(
            word.Several((word.Several((word.Number(0.01, 4.0),) * 3),) * 2),
            ((0.8, 0.8, 0.8), (0.5, 0.8, 0.3)),
            "The board's edges along x, y and z, of either.",
            "world units",
        ),
        "nears": word.of(
            word.Several((word.Number(0.05, 8.0),) * 2),
            (0.5, 4.9),
            "The distance of the near plane, of either.",
            "world units",
        ),
        "background": word.BACKDROP(BACKGROUND),
        "shading": word.SHADING(SceneShading.LIT),
    },
    methods=tuple(
        Method(name, make_scene(OPERATIONS[name]), machines)
        for name, machines in (
            ("clamped counts", ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY")),
            ("wrapping counts", ("GEFORCE_256", "GEFORCE_3")),
        )
    ),
    acceptance=checks,
)

"""F003-26: where z-pass fails: the eye in shadow, and a near plane that cuts a shadow volume (Z25)."""

from fixedpipe.effects.acceptance import ray_caster, shadow_reference
from fixedpipe.effects.acceptance.agreement import compare, lit_mask, truth_of
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.zwicker_2016.shared.counted_volumes import (
    counted,
    expected_counts,
    lamp_without_frustum,
)
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import look_at, perspective, rotation
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, View, row_of_panels
from fixedpipe.effects.scenes.objects_and_lamps import Object, Scene, detail_of
from fixedpipe.effects.scenes.still_life import still_life
from fixedpipe.effects.shadows import shadow_volumes
from fixedpipe.effects.shadows.lit_scene import SceneShading

DATA = figure_data(__file__, "F003-26")

# What the stencil counts from, and how. Clamped counts go below 128 as wrapping ones do below zero.
CLAMPED = {"operations": shadow_volumes.CLAMPED}
BELOW_ZERO = {
    "clamped counts from 128": {"operations": shadow_volumes.CLAMPED, "start": 128},
    "wrapping counts": {"operations": shadow_volumes.WRAPPING},
}
EYE, CENTER, FIELD_OF_VIEW = (0.6, 5.2, 8.6), (0.08, 0.25, 0.52), 28.5
# What is in shadow; two panels each.
CASES = ("eye", "near plane")


def _things(detail):
    """What of the still life throws one shadow where the light comes from behind: things whose shadows lie
    in no other's, nor in their own. The box is turned, so that the light grazes none of its sides.
    """
    kept = [thing for thing in still_life(detail).objects if thing.name not in ("vase", "column", "box")]
    box = surfaces.box(0.9, 1.2, 0.9).rotated(rotation("y", 70.0)).moved(1.5, 0.6, -1.3)
    pillar = surfaces.lathe(((0.0, 0.0), (0.28, 0.0), (0.28, 1.55), (0.0, 1.55)), detail)
    kept.append(Object("box", box, (0.34, 0.52, 0.34), 0.1))
    return (*kept, Object("pillar", pillar.moved(-1.55, 0.0, -1.55), (0.66, 0.62, 0.55), 0.1))


def setting(case, panel, detail, *, light, hidden, shares, boards, nears):
    """Things on the floor, a board beside the picture, the lamp and the camera: Scene, Lamp, View.

    The board's shadow falls over the eye or over the near plane. For each case: ``hidden`` is the middle of
    the board's shadow; ``shares`` is the board's place on the way from the lamp to there, as a fraction;
    ``boards`` has its edges; ``nears`` the near plane's distance.
    """
    k = CASES.index(case)
    view = View(panel, look_at(EYE, CENTER), perspective(FIELD_OF_VIEW, 1.0, nears[k], 60.0), EYE, False)
    place = (at + shares[k] * (to - at) for at, to in zip(light, hidden[k], strict=True))
    board = Object("board", surfaces.box(*boards[k]).moved(*place), (0.5, 0.5, 0.5))
    return Scene((*_things(detail), board)), lamp_without_frustum(light), view


def make_scene(below_zero):
    """The scene drawn with counts that stay at zero, and with counts that go below it."""

    def scene(profile, size, *, background, shading, **places):
        """Each case by z-pass, which fails, in both ways, and one by z-fail."""
        ways = [(case, shadow_volumes.z_pass, way) for case in CASES for way in (CLAMPED, below_zero)]
        ways.append((CASES[1], shadow_volumes.z_fail, below_zero))
        out = []
        for panel, (case, algorithm, way) in zip(row_of_panels(5, size), ways, strict=True):
            objects, lamp, view = setting(case, panel, detail_of(size), **places)
            out += (panel.clear(background), *algorithm(objects, view, lamp, profile, shading, **way))
        return tuple(out)

    return scene


# How much of the picture z-pass gets wrong with the eye in shadow, and of what is seen through the shadowed
# part of the near plane: the catalogue's bound, and where counts go below zero, all but where volumes
# overlap.
_WRONG = (
    ("clamped", 0.30, "the catalogue's; shadows are gone, as a count below zero is held there"),
    ("below zero", 0.90, "a complement: what is lit counts -1, and what one volume hides 0"),
)


def checks(figure, renderer):
    """How wrong z-pass is, and where; z-fail against rays."""
    below_zero, size = BELOW_ZERO[renderer.method.name], 384
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
        yield DATA.check(
            "part of the near plane that is in shadow, {case} in shadow",
            float(hidden.mean()),
            Answer.IDEAL,
            at_least=1.0 if case == CASES[0] else 0.3,
            case=case,
        )
        volumes = shadow_volumes.shadow_volumes(objects, lamp.homogeneous)
        yield DATA.check(
            "pixels that lie in two shadows, of all, {case} in shadow",
            float((expected_counts(volumes, truth) > 1).mean()),
            Answer.IDEAL,
            case=case,
        )
        for number, (name, least, reason) in enumerate(_WRONG):
            way = (CLAMPED, below_zero)[number]
            for on in (Answer.IDEAL, Answer.MACHINE) if case == CASES[0] else (Answer.MACHINE,):
                if on is Answer.MACHINE:
                    first = (2 * CASES.index(case) + number) * size
                    wrong = drawn[:, first : first + size]
                else:
                    _, wrong = counted(renderer, shadow_volumes.z_pass, view, objects, lamp, on, **way)
                yield Check(
                    f"z-pass, {name}: wrong pixels of those seen through the near plane's shadow, "
                    f"{case} in shadow",
                    float((wrong != truth.lit)[seen & hidden].mean()), at_least=least, on=on, reason=reason,
                )  # fmt: skip
                if not hidden.all():
                    yield DATA.check(
                        "z-pass, {name}: wrong pixels of the others, {case} in shadow",
                        float((wrong != truth.lit)[seen & ~hidden].mean()),
                        on,
                        name=name,
                        case=case,
                    )
        for on in Answer:
            if on is Answer.MACHINE and case == CASES[1]:
                right = drawn[:, 4 * size :]
            else:
                _, right = counted(renderer, shadow_volumes.z_fail, view, objects, lamp, on, **below_zero)
            yield DATA.check(
                "z-fail: pixels lit or not as rays say, {case} in shadow",
                float((right == truth.lit)[seen].mean()),
                on,
                case=case,
            )
            if on is Answer.MACHINE:
                yield DATA.check(
                    "z-fail: pixels lit or not unlike the rays', not on an edge, {case} in shadow",
                    compare(right, truth).other,
                    on,
                    case=case,
                )


def reference(size, *, background, shading, **places):
    """Both cases' shadows by rays, for every algorithm."""
    cases = (CASES[0], CASES[0], CASES[1], CASES[1], CASES[1])
    shots = {}
    for case in CASES:
        objects, lamp, view = setting(case, Panel(0, 0, size, size), detail_of(size), **places)
        shots[case] = shadow_reference.Shot(objects, view, (lamp,), background, shading)
    return shadow_reference.row(size, [shots[case] for case in cases])


FIGURE = Figure(
    **DATA.words,
    size=384,
    parameters={
        "light": word.POSITION((-3.8, 5.8, -5.8), "Where the light is."),
        "hidden": word.of(
            word.Several((word.POSITION_KIND,) * 2),
            (EYE, (-0.35, 2.75, 4.2)),
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
        Method(name, make_scene(BELOW_ZERO[name]), machines)
        for name, machines in (
            ("clamped counts from 128", ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY")),
            ("wrapping counts", ("GEFORCE_256", "GEFORCE_3")),
        )
    ),
    acceptance=checks,
    reference=reference,
)

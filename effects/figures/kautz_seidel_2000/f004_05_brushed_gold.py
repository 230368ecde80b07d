"""F004-5: a sphere of slightly brushed, bumpy gold."""

import numpy as np

from fixedpipe.effects.acceptance import material_reference
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import COMBINER_MACHINES, DARK, IMAGING_MACHINES_8, Figure, Method
from fixedpipe.effects.figures.kautz_seidel_2000.shared.brushed_sphere import leaning_seen
from fixedpipe.effects.geometry.views import BACKGROUND, Light
from fixedpipe.effects.reflectance import anisotropic_blinn_phong, imaging_subset, material_textures
from fixedpipe.effects.scenes.spheres import leaning_sphere

DATA = figure_data(__file__, "F004-5")

# The method that draws flat triangles.
FLAT = "imaging subset"
# The catalogue's gold. Light that is reflected once has it; what the diffuse pass stands for has been
# reflected between bumps at least twice, and its colour is near the square.
GOLD = (1.0, 0.77, 0.34)


def _ball(
    size, map_size, repeats, lean, tilt, slices, stacks, radius, height_field, height_scale, material, bumps,
    depth, **strokes,
):  # fmt: skip
    """The panel, the view, the sphere and the gold."""
    sphere = leaning_sphere(
        size, slices=slices, stacks=stacks, repeats=repeats, lean=lean, tilt=tilt, radius=radius
    )

    def made():
        if height_field is None:
            return material_textures.gold(map_size, bumps=bumps, depth=depth, **strokes)
        slopes = height_field.slopes(map_size, height_scale, repeated=True)
        return material_textures.brushed_bumps(*slopes, **strokes)

    return *sphere, own_maps.material_or(made, material, height_field)


def scene(profile, size, *, light, diffuse, ambient, specular, background, **ball):
    """F004-5: one sphere, with register combiners."""
    panel, view, surface, gold = _ball(size, **ball)
    loading, names = material_textures.load(gold, "gold", profile)
    return (
        panel.clear(background),
        *loading,
        *diffuse_bump.diffuse_pass(
            surface, names.normal, view, Light(light), profile, color=diffuse, ambient=ambient
        ),
        *anisotropic_blinn_phong.specular_pass(
            surface, names, view, Light(light), profile, specular=specular
        ),
    )


def imaging_scene(profile, size, *, light, diffuse, ambient, specular, background, **ball):
    """The same with the imaging subset (K08), flat triangles."""
    panel, view, surface, gold = _ball(size, **ball)
    return (
        panel.clear(background),
        *imaging_subset.commands(
            surface,
            gold,
            view,
            Light(light),
            profile,
            color=diffuse,
            ambient=ambient,
            specular=specular,
            name="gold",
        ),
    )


def chords(mask):
    """Mean lengths of the runs of true pixels along the rows and along the columns of a bool image; NaN,
    which passes no check, if there are none.
    """
    begins = [(~np.roll(mask, 1, axis) & mask).sum() for axis in (1, 0)]
    return tuple(float(mask.sum() / count) if count else float("nan") for count in begins)


_OF_GOLD = ("bumps", "depth", "alpha_x", "alpha_y", "spread", "stroke_depth", "k_s")


@computed_once
def _by_pixels(values, size, flat):
    """The sphere's ``material_reference.pictures``."""
    gold = material_textures.gold(values["map_size"], **{name: values[name] for name in _OF_GOLD})
    seen = leaning_seen(values, size, flat)
    return material_reference.pictures(material_reference.fields(gold), seen, values, squared_first=flat)


def _checks_by_pixels(figure, renderer):
    """The displayed sphere against Eq. 1 at every pixel, and what each field does to it."""
    size, flat, values = figure.size, renderer.method.name == FLAT, dict(figure.values)
    where, found = leaning_seen(values, size, flat).where, {0: _by_pixels(values, size, flat)}
    return material_reference.checks(DATA, figure, renderer, where, found)


def checks(figure, renderer):
    """The highlights' arithmetic and colour, and that each bump has its own anisotropic highlight."""
    yield from _checks_by_pixels(figure, renderer)
    size, white = 256, {**DARK, "specular": (1.0, 1.0, 1.0)}
    ideal = np.clip(renderer.ideal_window(figure, size, **white)[..., 0], 0.0, 1.0)
    machine = renderer.machine_window(figure, size, **white)[..., 0]
    yield DATA.check(
        "RMS of machine - ideal over highlight pixels, of a highlight of one",
        root_mean_square((machine - ideal)[ideal > 0.05]),
        Answer.MACHINE,
    )
    color = renderer.machine_window(figure, size, **DARK)[machine > 0.5].mean(axis=0)
    yield DATA.check(
        "colour of the highlights over red, largest deviation from gold's",
        float(np.abs(color / color[0] - np.array(GOLD)).max()),
        Answer.MACHINE,
    )
    # Upright, and with textures as wide as they are high where the sphere faces the eye.
    upright = {**white, "lean": 0.0, "tilt": 0.0}
    middle = slice(size // 4, 3 * size // 4)
    for on in Answer:
        image = renderer.window(on, figure, size, **upright)[middle, middle, 0]
        across, along = chords(image > 0.4)
        isotropic = (figure.values["alpha_x"] + figure.values["alpha_y"]) / 2
        plain = renderer.window(
            on, figure, size, **upright, alpha_x=isotropic, alpha_y=isotropic, spread=0.0
        )[middle, middle, 0]
        plain_across, plain_along = chords(plain > 0.4)
        yield DATA.check(
            ("highlights drawn out along b: mean chord along b over along t, against isotropic gold's"),
            (along / across) / (plain_along / plain_across),
            on,
        )
        pixels_per_bump = figure.values["radius"] * size * np.pi / 4 / (2 * figure.values["bumps"])
        yield DATA.check(
            "mean chord of the highlights along t, in widths of a bump", across / pixels_per_bump, on
        )


FIGURE = Figure(
    **DATA.words,
    parameters={
        "map_size": word.TEXELS(128),
        "repeats": word.REPEATS((4, 2)),
        "bumps": word.COUNT(8, "Bumps along an edge of the texture, about."),
        "depth": word.SLOPE(1.6, "The largest slope of the bumps, about."),
        "alpha_x": word.ALPHA_X(0.5),
        "alpha_y": word.ALPHA_Y(0.8),
        "spread": word.SPREAD(14.0),
        "stroke_depth": word.STROKE_DEPTH(0.65),
        "k_s": word.K_S((0.3, 1.0)),
        # Towards the light, and the near pole turned into the dark: the textures' pinches are not seen.
        "lean": word.LEAN(39.0),
        "tilt": word.DEGREES(10.0, "How far the axis' upper end is turned away from the viewer."),
        "light": word.LIGHT((-0.45, 0.55, 0.75)),
        "slices": word.SLICES(50),
        "stacks": word.STACKS(26),
        "radius": word.RADIUS(0.92),
        "diffuse": word.DIFFUSE((0.60, 0.39, 0.12)),
        "ambient": word.AMBIENT((0.12, 0.08, 0.03)),
        "specular": word.SPECULAR(tuple(0.75 * c for c in GOLD)),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the bumps"),
        "height_scale": own_maps.HEIGHT_SCALE(0.06),
        "material": own_maps.MATERIAL,
    },
    methods=(
        Method("register combiners", scene, COMBINER_MACHINES),
        Method(FLAT, imaging_scene, IMAGING_MACHINES_8),
    ),
    acceptance=checks,
)

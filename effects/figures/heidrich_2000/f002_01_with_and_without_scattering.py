"""F002-1: domes without and with the light that they scatter at each other, by four machines' passes."""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.acceptance.ray_caster import primary_rays
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures import scattering_ways
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import texture_space
from fixedpipe.effects.figures.heidrich_2000.shared.relief import lit_relief, oblique_view
from fixedpipe.effects.figures.scattering_ways import MACHINES, WAYS, setup_of
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, panel_of, row_of_panels
from fixedpipe.effects.scattering import dependent_tests, height_field, light_transport
from fixedpipe.effects.scattering.dependent_tests import DIRECT, RESULT, Accumulation
from fixedpipe.effects.scattering.directions import spiral
from fixedpipe.effects.scattering.displacement import relief
from fixedpipe.effects.scattering.visibility import free_view, precompute
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import IDEAL
from fixedpipe.pipeline.textures.images import texture_2d

DATA = figure_data(__file__, "F002-1")

# Offsets are signed bytes, and textures' edges powers of two.
VALUES = {"offset textures, bumps lit at vertices": {"texels": 64}}
# Of highlights: what combiners make by squaring three times.
EXPONENT = 8.0
WITHOUT = "light without scattering"
EYE = (0.0, -2.7, 2.7)


def _domes(size, texels, domes, height, albedo, ground, directions):
    """The field, half a panel's edge at most, so that small pictures are cheap; and its visibility."""
    edge = scattering_ways.largest_power(size // 2, texels)
    whole = tuple(map(tuple, spiral(directions).tolist()))
    field, visibility = texture_space.domes_and_visibility(edge, domes, height, albedo, whole)
    # The colour ends on the ground before a dome, not on its steep rim, whose few texels are seen large.
    on_a_dome = height_field.domes(edge, edge, domes).heights > 0.0
    share = np.minimum(2.0 * height_fields.smooth(on_a_dome.astype(np.float64), edge // 32), 1.0)[..., None]
    return field.with_albedo(share * np.array(albedo) + (1.0 - share) * np.array(ground)), visibility


def scene_by(way):
    """The scene by a machine's PathPasses."""

    def scene(
        profile, size, *, specular, directions, paths, lookups, light, accumulation, exposure, bits, **domes
    ):
        field, visibility = _domes(size, directions=directions, **domes)
        field = replace(field, specular=specular, exponent=EXPONENT)
        setup = setup_of(profile, field, visibility, bits)
        numbers = light_transport.sequences(directions, lookups, paths)
        surface, panels = relief(field, level_border=True), row_of_panels(2, size)
        drawn = [
            lit_relief(f"the domes {what}", surface, oblique_view(panel, EYE), texture)
            for what, panel, texture in zip(
                ("without scattering", "with scattering"), panels, (WITHOUT, RESULT), strict=True
            )
        ]
        return (
            *dependent_tests.paths_drawn(
                way, setup, numbers, light, accumulation=accumulation, exposure=exposure
            ),
            dependent_tests.textured(
                "direct light alone",
                setup.work,
                DIRECT,
                dependent_tests.share_of(setup),
                weight=exposure,
            ),
            dependent_tests.copy_of(setup, setup.work, WITHOUT),
            *(
                command
                for pair in zip((p.clear(BACKGROUND) for p in panels), drawn, strict=True)
                for command in pair
            ),
        )

    return scene


# Directions of the reference: four times the figure's, whose noise is half.
REFERENCE_DIRECTIONS = 400


def reference(size, *, texels, domes, height, albedo, ground, specular, lookups, light, exposure, **_):
    """The light of many more paths in float64, shown on the same relief: RGBA, top row first."""
    field, visibility = _domes(size, texels, domes, height, albedo, ground, REFERENCE_DIRECTIONS)
    field = replace(field, specular=specular, exponent=EXPONENT)
    towards = height_field.check_light(light)
    numbers = light_transport.sequences(REFERENCE_DIRECTIONS, lookups, REFERENCE_DIRECTIONS)
    lights = (
        _direct(field, visibility, towards),
        light_transport.scattered(field, visibility, numbers, towards),
    )
    picture = np.ones((size, 2 * size, 4))
    picture[..., :3] = _in_float(size, field, [exposure * values for values in lights])
    return picture


def _direct(field, visibility, light):
    """Direct light with its shadows, as the eye straight above has it: float64 [rows, columns, 3]."""
    up = (0.0, 0.0, 1.0)
    return light_transport.chain(field, visibility, [], light, up, lit=free_view(field, light))


def _in_float(size, field, lights):
    """Panels of a field's relief, a texture of light each: RGB [size, n size, 3], top row first."""
    drawn = []
    for number, (panel, values) in enumerate(zip(row_of_panels(len(lights), size), lights, strict=True)):
        name = f"light {number}"
        drawn += (
            TexImage(label=f"load {name}", texture=name, image=texture_2d(values)),
            panel.clear(BACKGROUND),
            lit_relief(name, relief(field, level_border=True), oblique_view(panel, EYE), name),
        )
    return execute_ideal(tuple(drawn), len(lights) * size, size).color[..., :3]


# ---------------------------------------------------------------------------------------------- checks

# Flanks in degrees: 1 + rho F and 1 / (1 - rho F) of the mean radiance, F = 1 - cos of the flank, rho = 0.8.
# Source: the catalogue's analytic answers.
ONE_REFLECTION = {30.0: 1.107, 45.0: 1.234, 60.0: 1.40}
ALL_REFLECTIONS = 1.306
GROOVE_TEXELS = 32


def _window(renderer, on, commands, edge):
    """What commands leave in two panels side by side: RGB [edge, 2 edge, 3], bottom row first."""
    if on is Answer.IDEAL:
        return renderer.execute_ideal(commands, 2 * edge, edge).color[::-1, :, :3]
    framebuffer = renderer.execute(commands, renderer.profile, 2 * edge, edge).framebuffer
    return framebuffer.color[::-1, :, :3] / (2.0**framebuffer.color_bits - 1.0)


def gain(renderer, way, on, flank, reflections, directions, weight=light_transport.WEIGHT):
    """The mean light of a groove with scattering over that without, by a machine's passes, light from above.

    directions  float64 [n, 3]; ``weight``: of all of them together
    """
    field = height_field.ridges(GROOVE_TEXELS, GROOVE_TEXELS, flank)
    profile = IDEAL if on is Answer.IDEAL else renderer.profile
    setup = setup_of(profile, field, precompute(field, directions))
    drawn = dependent_tests.rounds_drawn(way, setup, dependent_tests.UP, reflections, weight=weight)
    shown = (
        dependent_tests.textured("with scattering", setup.work, RESULT),
        dependent_tests.textured("direct light alone", setup.total, DIRECT, dependent_tests.share_of(setup)),
    )
    window = _window(renderer, on, (*drawn, *shown), GROOVE_TEXELS)
    return float(window[:, :GROOVE_TEXELS].mean() / window[:, GROOVE_TEXELS:].mean())


def _grooves(renderer, way):
    whole = spiral(100)
    for flank, expected in ONE_REFLECTION.items():
        for on in Answer if flank == 45.0 else (Answer.IDEAL,):
            yield DATA.check(
                "grooves of {flank:g} degrees, one further reflection: deviation from {expected:g}",
                abs(gain(renderer, way, on, flank, 1, whole) / expected - 1.0),
                on,
                flank=flank,
                expected=expected,
            )
    yield DATA.check(
        "the same of 45 degrees, four further reflections: deviation from {all_reflections:g}",
        abs(gain(renderer, way, Answer.IDEAL, 45.0, 4, whole) / ALL_REFLECTIONS - 1.0),
        Answer.IDEAL,
        all_reflections=ALL_REFLECTIONS,
    )
    upper = whole[whole[:, 2] > 0.0]
    yield DATA.check(
        "the upper hemisphere alone, with 2 pi / N: deviation from 1.234",
        abs(gain(renderer, way, Answer.IDEAL, 45.0, 1, upper, 2.0) / ONE_REFLECTION[45.0] - 1.0),
        Answer.IDEAL,
    )


def _against_paths(renderer, way, values, lookups, accumulation, specular=0.0):
    """RMS of the passes' sum - the same paths in float64, by Answer: of 32 x 32 texels."""
    edge, directions = 32, values["directions"] if lookups == 1 else 40
    field, visibility = _domes(
        2 * edge, edge, *(values[name] for name in ("domes", "height", "albedo", "ground")), directions
    )
    field = replace(field, specular=specular, exponent=EXPONENT)
    numbers = light_transport.sequences(directions, lookups, directions)
    light = height_field.check_light(values["light"])
    # Paths of several lookups are noise, which may exceed 1, and half of the light with highlights too.
    exposure = values["exposure"] if lookups == 1 and not specular else 0.5
    expected = exposure * light_transport.scattered(field, visibility, numbers, light)
    for on in Answer:
        profile = IDEAL if on is Answer.IDEAL else renderer.profile
        setup = setup_of(profile, field, visibility, values["bits"])
        drawn = (
            *dependent_tests.paths_drawn(
                way, setup, numbers, light, accumulation=accumulation, exposure=exposure
            ),
            dependent_tests.textured("the result", setup.work, RESULT),
        )
        yield on, root_mean_square(_window(renderer, on, drawn, edge)[:, :edge] - expected)


def _sums(renderer, way, values):
    for accumulation in Accumulation:
        for on, error in _against_paths(renderer, way, values, 1, accumulation):
            exact = on is Answer.IDEAL
            yield Check(
                f"RMS of the sum in the {accumulation.value} - the same paths in float64",
                error,
                at_most=1e-6 if exact else BOUNDS[accumulation],
                on=on,
                reason="the same sums, in another order" if exact else REASONS[accumulation],
            )
    for lookups, bound in ((2, 0.006), (4, 0.03)):
        for on, error in _against_paths(renderer, way, values, lookups, Accumulation.ACCUMULATION_BUFFER):
            exact = on is Answer.IDEAL
            yield Check(
                f"RMS of paths of {lookups} lookups - the same paths in float64",
                error,
                at_most=1e-6 if exact else bound,
                on=on,
                reason="the same sums, in another order"
                if exact
                else f"their last direct light is kept over {4 ** (lookups - 1)}, in bytes",
            )
    for on, error in _against_paths(renderer, way, values, 1, Accumulation.ACCUMULATION_BUFFER, 0.2):
        exact = on is Answer.IDEAL
        yield Check(
            "RMS with highlights of k_s = 0.2 - the same paths in float64",
            error,
            at_most=1e-4 if exact else 0.006,
            on=on,
            reason="the Octane's table of powers has 2^14 entries, the combiners square exactly"
            if exact
            else "squared three times, a byte's error is eight times as large where the highlight is full",
        )


def _half_balls(domes, height, texels):
    """The centres [k, 2] of the domes that stand on the relief and on the tiles beside it, their radius, and
    their height: half ellipsoids, apart from what draws them.
    """
    places = np.arange(-domes, 2 * domes)
    centers = (2.0 * places + 1.0) / domes - 1.0 - 1.0 / texels
    x, y = (c.ravel() for c in np.meshgrid(centers, centers))
    return np.stack([x, y], axis=-1), 0.9 / domes, height * 0.9 / domes


def _met(origins, along, centers, radius, height):
    """How far rays [n, 3] go until they meet a half ellipsoid, float64 [n], infinite where they meet none."""
    found = np.full(len(origins), np.inf)
    scale = np.array([1.0 / radius, 1.0 / radius, 1.0 / height])
    for center in centers:
        begin, step = (origins - np.array([*center, 0.0])) * scale, along * scale
        a, b, c = dot(step, step), dot(begin, step), dot(begin, begin) - 1.0
        under = b * b - a * c
        near = (-b - np.sqrt(np.maximum(under, 0.0))) / a
        inside = (under > 0.0) & (near > 1e-9) & (origins[:, 2] + near * along[:, 2] >= 0.0)
        found = np.where(inside, np.minimum(found, near), found)
    return found


@computed_once
def _by_analysis(size, domes, height, texels, light):
    """What a panel's pixels show, by half ellipsoids: whether the relief is there, how high it is over the
    domes' height, n.l, and whether the light reaches it: float64 [4, size, size], bottom row first.
    """
    (panel,) = row_of_panels(1, size)
    origins, along = primary_rays(oblique_view(panel, EYE))
    balls = _half_balls(domes, height, scattering_ways.largest_power(size // 2, texels))
    centers, radius, height = balls
    ground = -origins[:, 2] / along[:, 2]
    reach = np.minimum(_met(origins, along, *balls), ground)
    points = origins + reach[:, None] * along
    there = (np.abs(points[:, :2]) <= 1.0).all(axis=-1)
    raised = reach < ground
    nearest = centers[((points[:, None, :2] - centers) ** 2).sum(axis=-1).argmin(axis=1)]
    outward = (points - np.concatenate([nearest, np.zeros((len(points), 1))], axis=1)) / np.array(
        [radius**2, radius**2, height**2]
    )
    normals = np.where(raised[:, None], normalize(outward), (0.0, 0.0, 1.0))
    light = np.array(height_field.check_light(light))
    facing = dot(normals, light)
    away = points + 1e-6 * normals
    lit = (facing > 0.0) & np.isinf(_met(away, np.broadcast_to(light, away.shape), *balls))
    found = there, np.where(raised, points[:, 2] / height, 0.0), facing, lit
    return np.stack([one.reshape(size, size) for one in found]).astype(np.float64)


def _displayed(figure, renderer, on, values):
    """What must be seen, in the picture that is displayed."""
    size = figure.size
    window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
    without, scattered = (panel_of(window, k) for k in range(2))
    of_relief = (values[name] for name in ("domes", "height", "texels", "light"))
    there, high, facing, lit = _by_analysis(size, *of_relief)
    there, lit = there > 0.0, lit > 0.0
    red = values["albedo"][0] * values["exposure"]
    # Where the light of the domes' pixels is found best, rows above and below.
    rows, columns = np.nonzero(there & (high > 0.0))
    expected = (red * np.maximum(facing, 0.0) * lit)[rows, columns]
    moved = range(-size // 8, size // 8 + 1)
    errors = [np.square(without[np.clip(rows + k, 0, size - 1), columns, 0] - expected).mean() for k in moved]
    yield DATA.check(
        "left: rows by which the domes are off where half ellipsoids stand",
        abs(moved[int(np.argmin(errors))]),
        on,
    )
    names = "texels", "domes", "height", "albedo", "ground", "directions"
    field, visibility = _domes(size, *(values[name] for name in names))
    light = height_field.check_light(values["light"])
    expected = _in_float(size, field, [values["exposure"] * _direct(field, visibility, light)])[::-1]
    right = np.abs(without - np.clip(expected, 0.0, 1.0)).max(axis=-1) <= 8.0 / 255.0
    yield DATA.check(
        "left: the relief's pixels that direct light with its shadows has in float, within 8/255",
        float(right[there].mean()),
        on,
    )
    dark, ground = there & ~lit, there & (high == 0.0) & lit
    gained_colors = scattered - without
    gained = gained_colors.mean(axis=-1)
    yield DATA.check(
        "right: what pixels gain that rays leave in shadow, mean", float(gained[dark].mean()), on
    )
    reddened = gained_colors[dark & (high == 0.0)].mean(axis=0)
    yield DATA.check(
        "right: red over blue of what the white ground in shadow gains",
        float(reddened[0] / reddened[2]),
        on,
    )
    yield DATA.check(
        "right: what the lit ground between the domes gains, over its light on the left",
        float(gained[ground].sum() / without[ground].mean(axis=-1).sum()),
        on,
    )


def checks(figure, renderer):
    """What must be seen, the passes against the float paths, the grooves' analytic answers, the picture."""
    p = figure.parameters_of(renderer.method)
    values = {name: parameter.default for name, parameter in p.items()}
    way, size = WAYS[renderer.method.name], figure.size // 4
    for on in Answer:
        yield from _displayed(figure, renderer, on, values)
    yield from _sums(renderer, way, values)
    names = "texels", "domes", "height", "albedo", "ground", "directions"
    field, visibility = _domes(64, *(values[name] for name in names))
    light = height_field.check_light(values["light"])
    numbers = light_transport.sequences(values["directions"], 1, values["directions"])
    expected = light_transport.scattered(field, visibility, numbers, light)
    direct = _direct(field, visibility, light)
    yield from _grooves(renderer, way)
    high = field.heights / field.heights.max()
    valleys, tops = (high < 0.25) & (direct.max(axis=-1) == 0.0), high > 0.8
    yield DATA.check(
        "what shadowed ground gains, mean", float((expected - direct)[valleys].mean()), Answer.IDEAL
    )
    yield DATA.check(
        "what the domes' tops gain, over what the shadowed ground does",
        float((expected - direct)[tops].mean() / (expected - direct)[valleys].mean()),
        Answer.IDEAL,
    )
    for on in Answer:
        window = renderer.window(on, figure, size)
        without, scattered = (panel_of(window, k) for k in range(2))
        yield DATA.check(
            "mean of the picture with scattering over that without",
            float(scattered.mean() / without.mean()),
            on,
        )
        ratios = [picture[..., 0].sum() / picture[..., 2].sum() for picture in (without, scattered)]
        yield DATA.check("red over blue with scattering, over that without", float(ratios[1] / ratios[0]), on)


BOUNDS = {
    Accumulation.FRAMEBUFFER: 0.012,
    Accumulation.ACCUMULATION_BUFFER: 0.004,
    Accumulation.HOST: 0.004,
}
REASONS = {
    Accumulation.FRAMEBUFFER: "each of 100 terms is rounded to a byte where it is added: 0.0113 (P14)",
    Accumulation.ACCUMULATION_BUFFER: "factors and terms are bytes, the sum is not",
    Accumulation.HOST: "factors and terms are bytes, the sum is not",
}
FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "texels": word.of(word.Whole(4, 128, power=True), 128, "The height field's edge, at most.", "texels"),
        "domes": word.of(word.Whole(1, 8), 3, "Domes along an edge."),
        "height": word.NUMBER(0.8, "The domes' height, over half balls'.", low=0.0, high=2.0),
        "albedo": word.COLOR((0.8, 0.26, 0.18), "The share of light that the domes scatter."),
        "ground": word.COLOR((0.84, 0.84, 0.84), "The share of light that the ground between them scatters."),
        "specular": word.NUMBER(
            0.0, "The highlights' k_s, of the exponent 8; with the albedo 1 at most.", low=0.0, high=1.0
        ),
        "directions": word.of(word.Whole(4, 400), 100, "Directions over the sphere."),
        "paths": word.of(word.Whole(1, 400), 100, "Paths of directions that are summed."),
        "lookups": word.of(word.Whole(1, 4), 1, "Lookups along a path: further reflections."),
        "light": word.LIGHT((-0.78, 0.31, 1.0)),
        "accumulation": word.of(
            word.of_enum(*Accumulation), Accumulation.ACCUMULATION_BUFFER, "Where the paths are summed."
        ),
        "exposure": word.NUMBER(1.0, "What all light is multiplied by.", low=0.1, high=1.0),
        "bits": word.of(word.Whole(8, 12, even=True), 8, "Of a coordinate in S_i; texture shaders have 8."),
    },
    methods=tuple(
        Method(name, scene_by(way), MACHINES[name], VALUES.get(name, {})) for name, way in WAYS.items()
    ),
    acceptance=checks,
    reference=reference,
)

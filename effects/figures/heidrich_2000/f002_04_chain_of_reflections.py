"""F002-4: the chain of several reflections as pictures, each drawn by the machine's own passes."""

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures import scattering_ways
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import texture_space
from fixedpipe.effects.figures.scattering_ways import MACHINES, WAYS
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, row_of_panels
from fixedpipe.effects.passes.draws import ADD
from fixedpipe.effects.scattering import dependent_tests
from fixedpipe.effects.scattering.dependent_tests import DIRECT, LIGHT, UP, Into
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.effects.scattering.light_transport import bump
from fixedpipe.effects.scattering.visibility import free_view
from fixedpipe.pipeline.commands import DrawPixels, HostStep

DATA = figure_data(__file__, "F002-4")

# Lookups along the path; a panel for the first step, and one for each lookup.
LOOKUPS = 3
# What a panel shows, as squares (x, y, edge) in shares of its height: L, and beside it S_k and bump(d_k).
MAIN, SEEN, BUMPS = (0.03125, 0.25, 0.625), (0.6875, 0.625, 0.25), (0.6875, 0.25, 0.25)


def _stage(what, k):
    return f"{what} {k}"


def _field(size, texels, domes, height, albedo, directions):
    edge = scattering_ways.largest_power(size // 2, texels)
    return texture_space.domes_and_visibility(edge, domes, height, albedo, tuple(map(tuple, directions)))


def scene_by(way):
    """The scene by a machine's PathPasses."""

    def scene(
        profile, size, *, texels, domes, height, albedo, light, directions, exposure, letters, background
    ):
        field, visibility = _field(size, texels, domes, height, albedo, directions)
        setup, panels = scattering_ways.setup_of(profile, field, visibility), row_of_panels(LOOKUPS + 1, size)
        light = tuple(check_light(light).tolist())
        lit = free_view(field, light)
        share = dependent_tests.share_of(setup)
        numbers = range(LOOKUPS)

        def shown(what, k):
            return dependent_tests.copy_of(setup, setup.work, _stage(what, k))

        def direct(blending=None):
            label = "bump mapping, light from l, times the exposure"
            return dependent_tests.textured(
                label, setup.work, DIRECT, share, weight=exposure, blending=blending
            )

        out = [
            *way.load(setup, lit, tuple(numbers)),
            *(scattering_ways.seen_picture(_stage("S", k), setup, k) for k in numbers),
            *(dependent_tests.black(setup, name) for name in (DIRECT, LIGHT)),
        ]
        for k in numbers:
            out += (*way.bumps(setup, visibility.directions[k], UP, None), shown("bumps", k))
        # What a diffuse texel sends back is the same in every direction: the step with l is drawn once and
        # added at each place of the chain.
        out += (*way.bumps(setup, light, UP, lit), *way.keep(setup, DIRECT), direct(), shown("L", LOOKUPS))
        for k in reversed(numbers):
            name = f"{LIGHT} {k}" if way.by_host else LIGHT
            out += (
                *way.keep(setup, name),
                *way.gathered(setup, k, UP, name, Into(setup.work)),
                direct(ADD),
                shown("L", k),
            )
        out += (panel.clear(background) for panel in panels)
        for panel, k in zip(panels, range(LOOKUPS, -1, -1), strict=True):
            names, places = [_stage("L", k)], [MAIN]
            if k < LOOKUPS:
                names, places = [*names, _stage("S", k), _stage("bumps", k)], [MAIN, SEEN, BUMPS]
            out += texture_space.squares(panel, places, names)
        return (*out, *(_written(panels) if letters else ()))

    return scene


def _written(panels):
    """Names of the squares, the step of each panel, and arrows from its L to the next."""
    size, count = panels[0].height, len(panels)
    whole = Panel(0, 0, count * size, size)
    view = drawing.sheet(whole)

    def corner(panel, place):
        x, y, edge = place
        return (2.0 * (panel + x) - count, 2.0 * (y + edge) - 1.0)

    names, places, out = [], [], [drawing.load_font()]
    for panel in range(count):
        k = count - panel
        names.append("L")
        places.append(corner(panel, MAIN))
        step = "L = bump(l)"
        if panel:
            names += (f"S{k}", f"bump(d{k})")
            places += (corner(panel, SEEN), corner(panel, BUMPS))
            step = f"L = bump(l) + bump(d{k}) L[S{k}]"
            x = 2.0 * panel - count
            line = [(x - 0.66, 0.125), (x + 0.05, 0.125)]
            out.append(drawing.arrow(f"L is looked up at S{k}", view, line, drawing.YELLOW, width=2.5))
        out.append(
            drawing.text(step, view, (2.0 * panel - count + 0.0625, -0.62), drawing.INK, align=(-1, 0))
        )
    return (*out, *texture_space.letters(whole, names, places))


def lookups_of(commands):
    """How many dependent lookups there are: texture shaders' draws, pixel textures, steps of the host."""
    return sum(
        isinstance(c, HostStep)
        or (isinstance(c, DrawPixels) and c.pixel_texture is not None)
        or getattr(getattr(c, "state", None), "texture_shader", None) is not None
        for c in commands
    )


def _chain(field, visibility, light, exposure):
    """Every L of the chain in float64, the first step's first; without the weight W."""
    direct = exposure * bump(field, light, UP) * free_view(field, light)[..., None]
    out = [direct]
    for k in reversed(range(LOOKUPS)):
        seen = visibility.seen[k]
        found = out[-1].reshape(-1, 3)[np.maximum(seen, 0)] * (seen >= 0)[..., None]
        out.append(direct + bump(field, visibility.directions[k], UP) * found)
    return out


def checks(figure, renderer):
    """The steps are counted, and every L is the float one."""
    p, size = figure.values, figure.size
    field, visibility = _field(
        size, *(p[name] for name in ("texels", "domes", "height", "albedo", "directions"))
    )
    light = tuple(check_light(p["light"]).tolist())
    expected = _chain(field, visibility, light, p["exposure"])
    commands = figure.commands(renderer.profile, size, renderer.method)
    steps = sum(c.label.startswith("bump mapping, light from l,") for c in commands)
    for name, found, wanted in (
        ("bump-mapping steps with l, from K + 1", steps, LOOKUPS + 1),
        ("dependent lookups, from K", lookups_of(commands), LOOKUPS),
    ):
        yield DATA.check("difference of the {name}", abs(found - wanted), Answer.MACHINE, name=name)
    edge = field.columns
    for on in Answer:
        window, errors, gains = renderer.window(on, figure, size, letters=False), [], []
        x, y, share = MAIN
        left, low, span = (round(v * size) for v in (x, y, share))
        texel = np.arange(span) * edge // span
        for k, light_sent in enumerate(expected):
            shown = window[low : low + span, k * size + left : k * size + left + span]
            errors.append(root_mean_square(shown - light_sent[np.ix_(texel, texel)]))
            gains.append(shown.mean())
        yield DATA.check("largest RMS of an L - the same step in float64", max(errors), on)
        yield DATA.check(
            "least gain of a later L's mean over the first's", float(min(gains[1:]) - gains[0]), on
        )
        yield DATA.check(
            "pixels of S1 to S3 that name the texel that is seen within 8/255, the least",
            min(_named_alike(window, size, k, visibility.seen[k]) for k in range(LOOKUPS)),
            on,
        )


def _named_alike(window, size, k, seen):
    """The share of the pixels of S_k that name the texel that is seen, ``seen``: int [rows, columns]."""
    x, y, share = SEEN
    left, low, span = (round(v * size) for v in (x, y, share))
    texel, first = np.arange(span) * len(seen) // span, (LOOKUPS - k) * size + left
    named = seen_places.named_texels(seen)[np.ix_(texel, texel)]
    return seen_places.alike(window[low : low + span, first : first + span], named, seen_places.WITHIN)


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "texels": texture_space.TEXELS,
        "domes": word.of(word.Whole(1, 8), 2, "Domes along an edge."),
        "height": texture_space.HEIGHT,
        "albedo": word.COLOR((0.95, 0.7, 0.5), "The share of light that the surface scatters."),
        "light": word.LIGHT((-0.78, 0.31, 1.0)),
        "directions": word.of(
            word.Several((word.DIRECTION_KIND,) * LOOKUPS),
            ((0.85, -0.3, 0.2), (-0.7, -0.6, 0.15), (0.25, 0.9, 0.25)),
            "The directions d1 to d3 along which texels are seen.",
        ),
        "exposure": word.NUMBER(0.6, "What all light is multiplied by.", low=0.1, high=1.0),
        "letters": word.FLAG(True, "Whether names and arrows are drawn over the pictures."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=tuple(Method(name, scene_by(way), MACHINES[name]) for name, way in WAYS.items()),
    acceptance=checks,
)

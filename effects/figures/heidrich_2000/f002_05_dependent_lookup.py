"""F002-5: two textures, S_i and L_d, one read by the other: the dependent lookup as pictures."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.diagrams import drawing
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures import scattering_ways
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2000.shared import texture_space
from fixedpipe.effects.figures.scattering_ways import MACHINES, WAYS
from fixedpipe.effects.geometry.vectors import dot
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, panel_of, row_of_panels
from fixedpipe.effects.scattering import dependent_tests
from fixedpipe.effects.scattering.dependent_tests import DIRECT, UP, Into
from fixedpipe.effects.scattering.height_field import check_light
from fixedpipe.effects.scattering.light_transport import bump
from fixedpipe.effects.scattering.visibility import free_view
from fixedpipe.effects.scattering.visibility_textures import texels_seen

DATA = figure_data(__file__, "F002-5")

# What the panels show: textures' names.
PICTURES = ("picture of S_i", "picture of L_d", "picture of L_d[S_i]", "picture of the product")
NAMES = ("S_i", "L_d", "L_d[S_i]", "bump(d_i) L_d[S_i]")


def _field(size, texels, domes, height, albedo, direction):
    edge = scattering_ways.largest_power(size, texels)
    return texture_space.domes_and_visibility(edge, domes, height, albedo, (tuple(direction),))


def _example(field, visibility):
    """A texel whose bumps face d_i and the texel of its own tile that it sees: (column, row) each."""
    (seen,), ahead = visibility.seen, visibility.directions[0]
    rows, columns = seen.shape
    row, column = np.mgrid[0:rows, 0:columns]
    along = (seen % columns - column) * ahead[0] + (seen // columns - row) * ahead[1]
    inside = np.minimum(np.minimum(column, row), np.minimum(columns - 1 - column, rows - 1 - row))
    fit = (seen >= 0) & (along > 0.0) & (inside >= min(rows, columns) // 16)
    best = int(np.argmax(np.where(fit, dot(field.normals, ahead), -1.0)))
    q = max(int(seen.flat[best]), 0)
    return (best % columns, best // columns), (q % columns, q // columns)


def scene_by(way):
    """The scene by a machine's PathPasses."""

    def scene(profile, size, *, texels, domes, height, albedo, light, direction, arrows, background):
        field, visibility = _field(size, texels, domes, height, albedo, direction)
        setup, panels = scattering_ways.setup_of(profile, field, visibility), row_of_panels(4, size)
        light = tuple(check_light(light).tolist())
        lit = free_view(field, light)

        def shown(name):
            return dependent_tests.copy_of(setup, setup.work, name)

        out = [
            scattering_ways.seen_picture(PICTURES[0], setup, 0),
            *way.load(setup, lit, (0,)),
            dependent_tests.black(setup, DIRECT),
            *way.bumps(setup, light, UP, lit),
            *way.keep(setup, DIRECT),
            shown(PICTURES[1]),
            *way.looked_up(setup, 0, DIRECT),
            shown(PICTURES[2]),
            *way.gathered(setup, 0, UP, DIRECT, Into(setup.work)),
            shown(PICTURES[3]),
            *(panel.clear(background) for panel in panels),
        ]
        out += (
            dependent_tests.textured(f"show the {n}", p, n) for p, n in zip(panels, PICTURES, strict=True)
        )
        return (*out, *(_drawn_over(panels, field, visibility) if arrows else ()))

    return scene


def _drawn_over(panels, field, visibility):
    """The panels' names, the texel p in each, and the arrow from S_i[p] to the texel q of L_d."""
    size = panels[0].height
    whole = Panel(0, 0, len(panels) * size, size)
    view, count = drawing.sheet(whole), len(panels)

    def place(panel, texel):
        x, y = ((t + 0.5) / n for t, n in zip(texel, (field.columns, field.rows), strict=True))
        return (2.0 * (panel + x) - count, 2.0 * y - 1.0)

    p, q = _example(field, visibility)
    corners = [(2.0 * k - count, 1.0) for k in range(count)]
    return (
        drawing.load_font(),
        drawing.arrow("S_i at p names q", view, [place(0, p), place(1, q)], drawing.YELLOW, width=2.0),
        drawing.arrow("L_d at q comes to p", view, [place(1, q), place(2, p)], drawing.YELLOW, width=2.0),
        drawing.arrow("times the bumps at p", view, [place(2, p), place(3, p)], drawing.YELLOW, width=2.0),
        drawing.dots(
            "p and q", view, [place(0, p), place(1, q), place(2, p), place(3, p)], drawing.RED, radius=3.5
        ),
        *texture_space.letters(whole, NAMES, corners),
    )


def checks(figure, renderer):
    """S_i decodes to the texels that are seen, the lookup is their light, the product is the float one."""
    p = figure.values
    size = p["texels"]
    field, visibility = _field(
        size, *(p[name] for name in ("texels", "domes", "height", "albedo", "direction"))
    )
    seen = visibility.seen[0]
    light = tuple(check_light(p["light"]).tolist())
    direct = bump(field, light, UP) * free_view(field, light)[..., None]
    expected = direct.reshape(-1, 3)[np.maximum(seen, 0)] * (seen >= 0)[..., None]
    product = bump(field, visibility.directions[0], UP) * expected
    for on in Answer:
        window = renderer.window(on, figure, size, arrows=False)
        coordinates, light_sent, found, result = (panel_of(window, k) for k in range(4))
        yield DATA.check(
            "S_i: the brightest of what is shown where nothing is seen",
            float(coordinates[seen < 0].max()),
            on,
        )
        # Shown are twice the codes: the field fills half of what is looked up.
        stored = np.floor(coordinates[..., :2] * 255.0 / 2.0 + 0.5).astype(np.int64)
        stored[seen < 0] = 255
        yield DATA.check(
            "texels whose coordinates in S_i lead elsewhere than to what is seen",
            int((texels_seen(stored, size, size) != np.where(seen < 0, -1, seen)).sum()),
            on,
        )
        gathered = light_sent.reshape(-1, 3)[np.maximum(seen, 0)] * (seen >= 0)[..., None]
        yield DATA.check(
            "largest difference of L_d[S_i] from the light of the texels that are seen",
            float(np.abs(found - gathered).max()),
            on,
        )
        error = root_mean_square(result - product)
        yield DATA.check("RMS of the product - float64", error, on)
    yield DATA.check("share of texels that see another along d_i", float((seen >= 0).mean()), Answer.IDEAL)


FIGURE = Figure(
    **DATA.words,
    panels=NAMES,
    size=512,
    parameters={
        "texels": texture_space.TEXELS,
        "domes": word.of(word.Whole(1, 8), 2, "Domes along an edge."),
        "height": texture_space.HEIGHT,
        "albedo": word.COLOR((0.95, 0.7, 0.5), "The share of light that the surface scatters."),
        "light": word.LIGHT((-0.78, 0.31, 1.0)),
        "direction": word.of(
            word.DIRECTION_KIND, (0.85, -0.3, 0.2), "The direction d_i along which texels are seen."
        ),
        "arrows": word.FLAG(True, "Whether names and arrows are drawn over the pictures."),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=tuple(Method(name, scene_by(way), MACHINES[name]) for name, way in WAYS.items()),
    acceptance=checks,
)

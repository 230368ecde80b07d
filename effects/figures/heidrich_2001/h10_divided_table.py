"""H10: a low light over a floor: a table clamped at one, a divided one, and the model at every pixel."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rigid_inverse, rotate, rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import Light, perspective_view, row_of_panels
from fixedpipe.effects.passes.draws import at_pixel
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import torrance_sparrow_passes as tables
from fixedpipe.effects.reflectance.anisotropic_tables import diffuse_pass
from fixedpipe.effects.reflectance.microfacets import torrance_sparrow
from fixedpipe.effects.reflectance.torrance_sparrow_passes import Remedy
from fixedpipe.pipeline.commands import DrawPixels
from fixedpipe.pipeline.pixel_transfer import PixelImage

DATA = figure_data(__file__, "H10")

# World units: the floor's half edge, the eye and what it looks at.
HALF, EYE, CENTER, FIELD = 6.0, (0.0, 0.75, 6.6), (0.0, -0.55, 0.0), 34.0
BLACK = (0.0, 0.0, 0.0)
UP = np.array([0.0, 1.0, 0.0])


def floor(size, polygons):
    """The floor, y = 0; coarser where panels are small."""
    count = min(polygons, max(12, polygons * size // 256))
    return surfaces.plane(count, count, HALF, HALF).rotated(rotation("x", -90.0))


def camera(panel):
    """The view of a panel."""
    return perspective_view(panel, EYE, CENTER, FIELD, 9.0)


def at_pixels(size, light, roughness, index, specular, diffuse):
    """The model at every pixel: RGB float64 [size, size, 3], bottom row first; and where the floor is."""
    (panel,) = row_of_panels(1, size)
    view = camera(panel)
    edge = (np.arange(size) + 0.5) * 2.0 / size - 1.0
    x, y = np.meshgrid(edge / view.projection[0][0], edge / view.projection[1][1])
    inverse = np.array(rigid_inverse(view.modelview))
    rays = rotate(inverse[:3, :3], np.stack([x, y, 0.0 * x - 1.0], axis=-1))
    down = rays[..., 1] < 0.0
    far = -EYE[1] / np.where(down, rays[..., 1], -1.0)
    place = np.array(EYE) + far[..., None] * rays
    on = down & (np.abs(place[..., 0]) < HALF) & (np.abs(place[..., 2]) < HALF)
    normal = np.broadcast_to(UP, place.shape)
    toward_light, toward_viewer = normalize(np.array(light) - place), normalize(np.array(EYE) - place)
    shining = torrance_sparrow(toward_light, toward_viewer, normal, roughness, index)
    lit = np.maximum(0.0, dot(normal, toward_light))
    shown = shining[..., None] * np.array(specular) + lit[..., None] * np.array(diffuse)
    return np.where(on[..., None], shown, 0.0), on


def make_scene(remedy):
    """The scene whose middle panel is multiplied back by this."""

    def scene(profile, size, *, light, roughness, index, divisor, specular, diffuse, polygons):
        """Clamped; divided and multiplied; by the host."""
        panels, lamp = row_of_panels(3, size), Light(light, point=True)
        body = floor(size, polygons)
        views = [camera(panel) for panel in panels]
        picture = at_pixels(size, light, roughness, index, specular, diffuse)[0]
        picture = np.concatenate([picture, np.ones((size, size, 1))], axis=-1)
        by_combiners = remedy is Remedy.COMBINER
        units = 2 if by_combiners else 1
        out = [panel.clear(BLACK) for panel in panels]
        out += tables.load(profile, roughness, index, name="clamped ")
        out += tables.load(profile, roughness, index, divisor=divisor, name="divided ")
        out += tables.passes(body, views[0], lamp, specular, units=units, name="clamped ")
        out.append(diffuse_pass(body, views[0], lamp, diffuse))
        scale = divisor if by_combiners else 1
        out += tables.passes(body, views[1], lamp, specular, units=units, name="divided ", scale=scale)
        if not by_combiners:
            out += tables.multiplied(body, views[1], divisor, remedy)
        out.append(diffuse_pass(body, views[1], lamp, diffuse))
        return (
            *out,
            DrawPixels(
                label="the host's picture",
                image=PixelImage(factor_texels(picture, profile)),
                position=at_pixel(panels[2].x, panels[2].y),
            ),
        )

    return scene


def reference(size, *, light, roughness, index, specular, diffuse, **_):
    """The model at every pixel, three times: RGBA float64, top row first."""
    color = np.clip(at_pixels(size, light, roughness, index, specular, diffuse)[0], 0.0, 1.0)
    panel = np.concatenate([color, np.ones((size, size, 1))], axis=-1)
    return np.concatenate([panel] * 3, axis=1)[::-1]


_SIZE = 256
_ALONE = {"diffuse": (0.0, 0.0, 0.0), "specular": (1.0, 1.0, 1.0)}


def checks(figure, renderer):
    """The light that the clamp takes, and how much of that a divided table still loses."""
    values = {**figure.values, **_ALONE}
    expected, on_floor = at_pixels(
        _SIZE, values["light"], values["roughness"], values["index"], values["specular"], values["diffuse"]
    )
    expected = np.clip(expected[..., 0], 0.0, 1.0)
    # A pixel on the floor's outline is half a polygon's.
    inner = on_floor.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inner &= np.roll(on_floor, step, axis)
    bright = inner & (expected > 0.5)
    image = renderer.window(Answer.MACHINE, figure, _SIZE, **_ALONE)[..., 0]
    clamped, divided, host = (image[:, k * _SIZE : (k + 1) * _SIZE] for k in range(3))
    lost = 1.0 - float(clamped[bright].mean() / expected[bright].mean())
    yield DATA.check("clamped: of the reflection's light, lost", lost, Answer.MACHINE)
    left = abs(1.0 - float(divided[bright].mean() / expected[bright].mean()))
    yield DATA.check("divided: lost", left, Answer.MACHINE)
    error = root_mean_square((divided - expected)[inner])
    yield DATA.check("divided: RMS from the model at every pixel", error, Answer.MACHINE)
    yield DATA.check("the host's: RMS from it", root_mean_square((host - expected)[inner]), Answer.MACHINE)
    ideal = renderer.window(Answer.IDEAL, figure, _SIZE, **_ALONE)[:, _SIZE : 2 * _SIZE, 0]
    error = root_mean_square((ideal - expected)[inner])
    yield DATA.check("ideal: divided, RMS from the model at every pixel", error, Answer.IDEAL)


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "light": word.POSITION((0.0, 1.2, -5.2), "Where the lamp is."),
        "roughness": word.of(word.Number(0.05, 1.0), 0.25, "The roughness m: the slope where D is 1/e."),
        "index": word.of(word.Number(1.0, 200.0), 8.0, "The floor's index of refraction."),
        "divisor": word.of(word.Whole(1, 4, power=True), 4, "What the table is divided by."),
        "specular": word.SPECULAR((1.0, 0.9, 0.7)),
        "diffuse": word.DIFFUSE((0.10, 0.25, 0.45)),
        "polygons": word.of(word.Whole(12, 256), 160, "Polygons along the floor's edges."),
    },
    methods=(
        Method("a combiner's scale", make_scene(Remedy.COMBINER), ("GEFORCE_256", "GEFORCE_3", "NV2A")),
        Method(
            "white drawn with DST_COLOR, ONE",
            make_scene(Remedy.DOUBLING),
            ("OPENGL_1_2", "MULTITEXTURE", "G400", "TEXRAM"),
        ),
        Method(
            "the accumulation buffer",
            make_scene(Remedy.ACCUMULATION),
            ("OCTANE", "INFINITE_REALITY", "OPENGL_1_2_IMAGING"),
        ),
    ),
    acceptance=checks,
    reference=reference,
)

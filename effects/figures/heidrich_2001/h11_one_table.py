"""H11: lighting at the vertices, a table by vertices, the model at every pixel; and a lobe of Lafortune's."""

import numpy as np

from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.passes.draws import at_pixel
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.reflectance import phong_tables
from fixedpipe.effects.reflectance.brdfs import half_vector
from fixedpipe.effects.reflectance.phong_tables import Cosine
from fixedpipe.pipeline.commands import DrawPixels
from fixedpipe.pipeline.pixel_transfer import PixelImage

DATA = figure_data(__file__, "H11")

RADIUS = 0.9
MACHINES = (
    *("OPENGL_1_2", "OPENGL_1_2_IMAGING", "MULTITEXTURE", "GEFORCE_256", "GEFORCE_3", "NV2A", "OCTANE"),
    *("INFINITE_REALITY", "G400", "TEXRAM", "FUTURE"),
)
_VIEWER = np.array([0.0, 0.0, 1.0])


def _pixels(size):
    """The sphere seen along -z: where it is, [size, size], and its frames, three float64 [size, size, 3],
    bottom row first; the binormal points up.
    """
    at = ((np.arange(size) + 0.5) * 2.0 / size - 1.0) / RADIUS
    x, y = np.meshgrid(at, at)
    inside = x * x + y * y < 1.0
    x, y = np.where(inside, x, 0.0), np.where(inside, y, 0.0)
    normals = np.stack([x, y, np.sqrt(1.0 - (x * x + y * y))], axis=-1)
    across = np.sqrt(1.0 - y * y)
    tangents = np.stack([normals[..., 2] / across, 0.0 * x, -x / across], axis=-1)
    binormals = np.stack([-y * x / across, across, -y * normals[..., 2] / across], axis=-1)
    return inside, normals, tangents, binormals


def at_pixels(size, cosine, light, exponent, coefficients, background, **colors):
    """The model at every pixel: RGB float64 [size, size, 3], bottom row first."""
    inside, normals, tangents, binormals = _pixels(size)
    toward_light = unit_vector(light, "The light's direction")
    if cosine is Cosine.HALF:
        other = dot(normals, half_vector(toward_light, _VIEWER))
    else:
        light_here, viewer_here = (
            np.stack([dot(axis, v) for axis in (tangents, binormals, normals)], axis=-1)
            for v in (toward_light, _VIEWER)
        )
        other = phong_tables.lobe_cosine(light_here, viewer_here, coefficients)
    shaded = phong_tables.shade(dot(normals, toward_light), other, exponent, cosine, **colors)
    return np.where(inside[..., None], shaded, np.array(background))


def scene(profile, size, *, light, exponent, lobe_exponent, coefficients, slices, background, **colors):
    """Four spheres, a pass each; the third is the host's picture."""
    panels = row_of_panels(4, size)
    views = [orthographic_view(panel) for panel in panels]
    lamp = Light(light)
    # As many as there are, but for a small panel, whose pixels they would be smaller than.
    count = min(slices, max(12, size // 8))
    sphere = surfaces.sphere(count, max(6, count // 2)).scaled(RADIUS)
    picture = at_pixels(size, Cosine.HALF, light, exponent, None, background, **colors)
    picture = np.concatenate([picture, np.ones((size, size, 1))], axis=-1)
    return (
        *(panel.clear(background) for panel in panels),
        phong_tables.load("Blinn-Phong", profile, exponent, Cosine.HALF, **colors),
        phong_tables.load("cosine lobe", profile, lobe_exponent, Cosine.LOBE, **colors),
        phong_tables.lighting_pass(sphere, views[0], lamp, exponent, **colors),
        phong_tables.matrix_pass(sphere, views[1], lamp, "Blinn-Phong"),
        DrawPixels(
            label="the host's picture",
            image=PixelImage(factor_texels(picture, profile)),
            position=at_pixel(panels[2].x, panels[2].y),
        ),
        phong_tables.table_pass(
            sphere, views[3], lamp, "cosine lobe", Cosine.LOBE, coefficients=coefficients
        ),
    )


def reference(
    size, *, light, exponent, lobe_exponent, coefficients, ambient, diffuse, specular, background, **_
):
    """The models at every pixel: RGBA float64, top row first."""
    colors = {"ambient": ambient, "diffuse": diffuse, "specular": specular}
    blinn = at_pixels(size, Cosine.HALF, light, exponent, None, background, **colors)
    lobe = at_pixels(size, Cosine.LOBE, light, lobe_exponent, coefficients, background, **colors)
    row = np.clip(np.concatenate([blinn, blinn, blinn, lobe], axis=1), 0.0, 1.0)
    return np.concatenate([row, np.ones((*row.shape[:2], 1))], axis=-1)[::-1]


_SIZE = 512


def _outline(picture, normals, values):
    """The highlight's outline, where it falls to half of k_s: the angle's mean in degrees over directions
    round it, and the standard deviation over the mean.
    """
    light = unit_vector(values["light"], "The light's direction")
    half = half_vector(light, _VIEWER)
    unlit = values["ambient"][2] + values["diffuse"][2] * np.maximum(0.0, dot(normals, light))
    excess = picture[..., 2] - unlit
    angle = np.degrees(np.arccos(np.clip(dot(normals, half), -1.0, 1.0)))
    first = unit_vector((half[2], 0.0, -half[0]), "An axis")
    azimuth = np.degrees(np.arctan2(dot(normals, np.cross(half, first)), dot(normals, first)))
    near = angle < 40.0
    angle, excess, azimuth = angle[near], excess[near], azimuth[near]
    sector = np.rint(azimuth / 5.0) % 72.0
    radii = []
    for k in range(72):
        within = sector == k
        within[within] = np.abs((azimuth[within] - 5.0 * k + 180.0) % 360.0 - 180.0) < 2.5
        order = np.argsort(angle[within])
        dark = excess[within][order] < 0.5 * values["specular"][2]
        radii.append(angle[within][order][np.argmax(dark)])
    return float(np.mean(radii)), float(np.std(radii) / np.mean(radii))


def checks(figure, renderer):
    """Errors from the model at every pixel, and the highlights' outlines."""
    values = figure.values
    expected = reference(_SIZE, **values)[::-1, :, :3]
    inside, normals, _, _ = _pixels(_SIZE)
    # Within the polygons' own outline.
    inside &= normals[..., 2] > 0.3
    tilted = half_vector(unit_vector(values["light"], "The light's direction"), _VIEWER)
    peak = inside & (dot(normals, tilted) > 0.995)
    for on in (Answer.IDEAL, Answer.MACHINE):
        image = renderer.window(on, figure, _SIZE)[..., :3]
        panels = [image[:, k * _SIZE : (k + 1) * _SIZE] for k in range(4)]
        wanted = [expected[:, k * _SIZE : (k + 1) * _SIZE] for k in range(4)]
        errors = [root_mean_square((p - w)[inside]) for p, w in zip(panels, wanted, strict=True)]
        rounding = 0.0 if on is Answer.IDEAL else 0.5 / 255.0
        yield DATA.check(
            "Gouraud: RMS from the model at every pixel", errors[0], on, at_most=0.013 + rounding
        )
        yield DATA.check("one table: RMS from it", errors[1], on, at_most=0.017 + rounding)
        yield DATA.check(
            "the host's picture: RMS from it", errors[2], on, at_most=1e-12 if not rounding else 0.002
        )
        yield DATA.check(
            "the lobe by a table: RMS from the model at every pixel", errors[3], on, at_most=0.009 + rounding
        )
        middle = [float(p[peak].mean()) for p in panels]
        yield DATA.check("the highlight's middle: Gouraud's, below the model's", middle[2] - middle[0], on)
        yield DATA.check("the table's beside Gouraud's", abs(middle[1] - middle[0]), on)
        outlines = [_outline(panel, normals, values) for panel in panels[:3]]
        yield DATA.check(
            "the outline's spread, Gouraud's over the table's", outlines[0][1] / outlines[1][1], on
        )
        yield DATA.check("the table's over that at every pixel", outlines[1][1] / outlines[2][1], on)


FIGURE = Figure(
    **DATA.words,
    size=512,
    parameters={
        "light": word.LIGHT((-0.5, 0.6, 0.9)),
        "exponent": word.of(
            word.Whole(1, 128), 30, "Blinn's exponent N: the larger, the narrower the highlight."
        ),
        "lobe_exponent": word.of(word.Whole(1, 128), 5, "The exponent of Lafortune's lobe."),
        "coefficients": word.of(
            word.Several((word.Number(-1.0, 1.0),) * 2, what="two numbers from -1 to 1"),
            (-1.0, 0.9),
            "C_x, which is C_y too, and C_z of Lafortune's lobe; -1 and 1 are Phong's.",
        ),
        "ambient": word.AMBIENT((0.05, 0.03, 0.02)),
        "diffuse": word.DIFFUSE((0.45, 0.22, 0.10)),
        "specular": word.SPECULAR((0.55, 0.55, 0.55)),
        "slices": word.SLICES(36),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("lighting, and tables", scene, MACHINES),),
    acceptance=checks,
    reference=reference,
)

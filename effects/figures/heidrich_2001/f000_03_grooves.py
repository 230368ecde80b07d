"""F000-3: a disc and a sphere, isotropic and with Banks's model: circular grooves, radial grooves."""

import math

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import cross, dot, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, orthographic_view, row_of_panels
from fixedpipe.effects.reflectance import banks_texture_matrix as banks

DATA = figure_data(__file__, "F000-3")

ASPECT = (2, 3)
# In half heights of a panel: the radius of both bodies, and how far above and below the middle they are.
RADIUS, PLACE = 0.46, 0.49
MACHINES = (
    *("OPENGL_1_2", "OPENGL_1_2_IMAGING", "MULTITEXTURE", "GEFORCE_256", "GEFORCE_3", "NV2A", "OCTANE"),
    *("INFINITE_REALITY", "G400", "TEXRAM", "FUTURE"),
)
_VIEWER = np.array([0.0, 0.0, 1.0])


def _turn(lean):
    """From a body whose axis is z to the panel: its upper side leans to the back."""
    return rotation("x", -lean)


def bodies(size, lean, hole, slices):
    """The disc above and the sphere below, both with their axis towards the viewer and leaning back."""
    count = min(slices, max(16, slices * size // 256))
    disc = surfaces.disc(count, hole)
    sphere = surfaces.sphere(count, max(8, count // 2)).rotated(rotation("x", 90.0))
    return tuple(
        body.rotated(_turn(lean)).scaled(RADIUS).moved(0.0, place, 0.0)
        for body, place in ((disc, PLACE), (sphere, -PLACE))
    )


def scene(profile, size, *, light, exponent, diffuse, specular, color, lean, hole, slices, background):
    """A panel for each kind of grooves. Each body takes one pass, and the tangent is the texture
    coordinate.
    """
    panels = row_of_panels(3, size, ASPECT)
    model = {"diffuse": diffuse, "specular": specular, "exponent": exponent}
    lights = ((Light(light), (1.0, 1.0, 1.0)),)
    out = [panel.clear(background) for panel in panels]
    out.append(banks.load_rough("rough", profile, **model))
    out.append(banks.load_threads("threads", profile, **model))
    views = [orthographic_view(panel) for panel in panels]
    for body in bodies(size, lean, hole, slices):
        out += banks.isotropic_passes(body, views[0], lights, "rough", color=color)
        out += banks.banks_passes(body, body.tangents, views[1], lights, "threads", color=color)
        out += banks.banks_passes(body, body.binormals, views[2], lights, "threads", color=color)
    return tuple(out)


def _at_pixels(size, lean, hole):
    """What rays along -z meet: body (0 none, 1 disc, 2 sphere), normals and circular tangents, [size, width,
    ...], bottom row first.
    """
    width = row_of_panels(1, size, ASPECT)[0].width
    x = ((np.arange(width) + 0.5) * 2.0 - width) / size
    y = ((np.arange(size) + 0.5) * 2.0 - size) / size
    x, y = np.meshgrid(x / RADIUS, y)
    body = np.zeros(x.shape, int)
    normals, tangents = np.zeros((*x.shape, 3)), np.zeros((*x.shape, 3))
    back = _turn(lean).T
    # The disc: where the ray meets the plane through its middle.
    axis = rotate(_turn(lean), np.array([0.0, 0.0, 1.0]))
    above = (y - PLACE) / RADIUS
    point = rotate(back, np.stack([x, above, -(axis[0] * x + axis[1] * above) / axis[2]], axis=-1))
    distance = np.sqrt(point[..., 0] ** 2 + point[..., 1] ** 2)
    on = (distance < 1.0) & (distance > hole)
    body[on], normals[on] = 1, axis
    local = np.stack([-point[..., 1], point[..., 0], 0.0 * x], axis=-1)
    tangents[on] = rotate(_turn(lean), normalize(local[on]))
    # The sphere, on which a normal is a place.
    below = (y + PLACE) / RADIUS
    on = x * x + below * below < 1.0
    place = np.stack([x[on], below[on], np.sqrt(1.0 - x[on] ** 2 - below[on] ** 2)], axis=-1)
    body[on], normals[on] = 2, place
    around = rotate(back, place)
    tangents[on] = rotate(
        _turn(lean), normalize(np.stack([-around[:, 1], around[:, 0], 0.0 * around[:, 0]], axis=-1))
    )
    return body, normals, tangents


def _thread_light(normal_of, light, viewer, diffuse, specular, exponent):
    """Eq. 4's bracket with n', the thread's normal nearest to the light, and r_v' about the thread's normals:
    by vectors, not by products with the tangent. ``normal_of``: a vector's part across the thread.
    """
    toward_light, toward_viewer = normal_of(light), normal_of(viewer)
    across = np.sqrt(dot(toward_light, toward_light)), np.sqrt(dot(toward_viewer, toward_viewer))
    # In the plane that holds the thread and the light; the viewer is turned into it about the thread.
    along = dot(light - toward_light, viewer - toward_viewer)
    cosine = np.maximum(0.0, across[0] * across[1] - along)
    return diffuse * across[0] + specular * cosine**exponent


def reference(size, *, light, exponent, diffuse, specular, color, lean, hole, background, **_):
    """Eq. 4 at every pixel: RGBA float64, top row first."""
    body, normals, circular = _at_pixels(size, lean, hole)
    toward_light = unit_vector(light, "The light's direction")
    halfway = normalize(toward_light + _VIEWER)
    cosine = np.maximum(0.0, dot(normals, toward_light))
    shapes = [diffuse + specular * np.maximum(0.0, dot(normals, halfway)) ** exponent]
    for tangents in (circular, cross(normals, circular)):

        def across(vector, tangents=tangents):
            return vector - dot(vector, tangents)[..., None] * tangents

        shapes.append(_thread_light(across, toward_light, _VIEWER, diffuse, specular, exponent))
    panels = []
    for value in shapes:
        lit = np.clip((cosine * value)[..., None] * np.array(color), 0.0, 1.0)
        shown = np.where((body > 0)[..., None], lit, np.array(background))
        panels.append(np.concatenate([shown, np.ones((*body.shape, 1))], axis=-1))
    return np.concatenate(panels, axis=1)[::-1]


_WHITE = {"color": (1.0, 1.0, 1.0)}
_SIZE = 384


def _around(panel, size, lean, hole, share):
    """The disc's brightness at ``share`` of its radius, a value a degree: float64 [360]."""
    angle = np.radians(np.arange(360.0))
    local = share * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=-1)
    place = rotate(_turn(lean), local) * RADIUS
    x = place[:, 0] * size / 2.0 + panel.shape[1] / 2.0 - 0.5
    y = (place[:, 1] + PLACE) * size / 2.0 + size / 2.0 - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b = x - i, y - j
    return (panel[j, i] * (1 - a) + panel[j, i + 1] * a) * (1 - b) + (
        panel[j + 1, i] * (1 - a) + panel[j + 1, i + 1] * a
    ) * b


def _sectors(values):
    """The directions in degrees of the two lobes of a brightness round a disc, by the second harmonic, and
    of the brightest degree in either half round them.
    """
    angle = np.radians(np.arange(360.0))
    turned = math.atan2(
        float((values * np.sin(2.0 * angle)).sum()), float((values * np.cos(2.0 * angle)).sum())
    )
    first = math.degrees(turned) / 2.0 % 180.0
    peaks = []
    for middle in (first, first + 180.0):
        near = np.arange(-60, 61) + round(middle)
        weight = values[near % 360] - values[near % 360].min()
        weight = weight**8
        peaks.append(float((weight * near).sum() / weight.sum()))
    return peaks


def checks(figure, renderer):
    """The panels against Eq. 4 by vectors, and the sectors where the grooves say."""
    values = {**figure.values, **_WHITE}
    lean, hole = values["lean"], values["hole"]
    body, normals, _ = _at_pixels(_SIZE, lean, hole)
    width = body.shape[1]
    # A pixel beside the outline belongs to polygons or to none.
    whole = body > 0
    for axis in (0, 1):
        for step in (-2, -1, 1, 2):
            whole &= np.roll(body, step, axis) == body
    expected = reference(_SIZE, **values)[::-1, :, 0]
    light = unit_vector(values["light"], "The light's direction")
    # Where l.t = -v.t: (l + v).t = 0, so the groove is across the part of l + v in the disc.
    both = rotate(_turn(lean).T, light + _VIEWER)
    toward = math.degrees(math.atan2(both[1], both[0])) % 180.0
    for on, bound, reason in (
        (Answer.IDEAL, 0.01, "the catalogue's bound"),
        (Answer.MACHINE, 0.01, "the same: a byte of the table, one of lighting, one of their product"),
    ):
        image = renderer.window(on, figure, _SIZE, **_WHITE)[..., 0]
        panels = [image[:, k * width : (k + 1) * width] for k in range(3)]
        for k, name in enumerate(figure.panels):
            error = root_mean_square((panels[k] - expected[:, k * width : (k + 1) * width])[whole])
            name = f"{name}: RMS from Eq. 4 at every pixel"
            yield Check(name, error, at_most=bound, on=on, reason=reason)
        peaks = {}
        for k, name, at in ((1, "circular", toward), (2, "radial", toward + 90.0)):
            peaks[k] = _sectors(_around(panels[k], _SIZE, lean, hole, 0.5))
            aside = max(abs((peak - at + 90.0) % 180.0 - 90.0) for peak in peaks[k])
            yield DATA.check("{name}: bright sectors off where l.t = -v.t, degrees", aside, on, name=name)
            apart = abs(abs(peaks[k][0] - peaks[k][1]) - 180.0)
            yield DATA.check("{name}: the two sectors' distance, off 180 degrees", apart, on, name=name)
        turned = abs((peaks[2][0] - peaks[1][0]) % 180.0 - 90.0)
        yield DATA.check("radial sectors to circular ones, off 90 degrees", turned, on)
        around = _around(panels[1], _SIZE, lean, hole, 0.5)
        yield DATA.check(
            "circular: brightest over darkest round the disc", float(around.max() / around.min()), on
        )
        flat = _around(panels[0], _SIZE, lean, hole, 0.5)
        yield DATA.check(
            "isotropic: spread of brightness round the disc", float(np.ptp(flat)), on, at_most=1.5 / 255.0
        )
        halfway = normalize(light + _VIEWER)
        cosine, toward_light = dot(normals, halfway), dot(normals, light)
        ring = whole & (body == 2) & (np.abs(cosine - math.cos(math.radians(8.0))) < 0.0004)
        seen = panels[0][ring] / toward_light[ring]
        yield DATA.check(
            "isotropic: brightness over n.l, 8 degrees from h, relative spread",
            float(np.ptp(seen) / seen.mean()),
            on,
        )


FIGURE = Figure(
    **DATA.words,
    size=768,
    aspect=ASPECT,
    parameters={
        "light": word.LIGHT((-0.55, 0.45, 0.71)),
        "exponent": word.NUMBER(
            30.0, "The exponent 1/r: the larger, the narrower the highlight.", low=1.0, high=128.0
        ),
        "diffuse": word.SHARE(0.3, "The share of light that is scattered, k_d."),
        "specular": word.SHARE(0.7, "The highlight's strength, k_s."),
        "color": word.COLOR((1.0, 0.88, 0.68), "The metal's colour."),
        "lean": word.of(word.Number(-60.0, 60.0), 18.0, "How far the axes' front ends point up.", "degrees"),
        "hole": word.of(word.Number(0.0, 0.9), 0.12, "The hole in the disc.", "radii"),
        "slices": word.of(
            word.Whole(16, 256),
            128,
            "Segments of the disc and the sphere around the axis, where the panel is large enough.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(Method("texture matrix and lighting", scene, MACHINES),),
    acceptance=checks,
    reference=reference,
)

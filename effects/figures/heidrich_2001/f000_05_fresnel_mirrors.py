"""F000-5: mirrors by Fresnel's factor, alone, over diffuse light and as its coat, and a filtered map.

The first column has the inputs of the others: the map, the diffuse light, F, and the filtered map.
"""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.computed_once import computed_once
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.environment_maps import (
    environments,
    fresnel_passes,
    prefilter,
    refracted_light,
)
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.figures.heidrich_2001.shared import glass
from fixedpipe.effects.geometry import cube_maps
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.vertex_vectors import dot_products, reflected, refracted
from fixedpipe.effects.geometry.views import (
    BACKGROUND,
    Panel,
    orthographic_view,
    panel_width,
    perspective_view,
)
from fixedpipe.effects.passes.draws import EDGE, FIRST_PASS, REPLACE, draw, unit
from fixedpipe.effects.passes.encoding import colors_of, factor_texels
from fixedpipe.effects.reflectance.fresnel import fresnel
from fixedpipe.effects.reflectance.sampled_functions import positions
from fixedpipe.pipeline.commands import TexImage
from fixedpipe.pipeline.enums import InternalFormat
from fixedpipe.pipeline.textures.images import texture_1d

DATA = figure_data(__file__, "F000-5")

ROWS, ASPECT = 4, (1, 3)
EYE, CENTER, FIELD_OF_VIEW = (0.0, 0.35, 2.9), (0.0, -0.09, 0.0), 31.5
LAMP = normalize(np.array((-0.45, 0.5, 0.75)))
SHARP, GLOSSY = "environment map", "filtered map"


def white(toward):
    """An environment that is one everywhere."""
    return np.ones(toward.shape)


def lamp(toward):
    """A black environment with a disc of 1.5 degrees' radius, 25 times as bright as white."""
    inside = dot(normalize(toward), LAMP) > 0.99966
    return np.where(inside[..., None], 25.0, 0.0) * np.ones(3)


ENVIRONMENTS = {"room": environments.room, "white": white, "lamp": lamp}


def camera(panel):
    """The view of a cell."""
    return perspective_view(panel, EYE, CENTER, FIELD_OF_VIEW, radius=1.2)


def cells(size):
    """Panels for all columns, from left to right, and in each for the rows, from top to bottom; the first
    column has the inputs.
    """
    width, height = panel_width(size, ASPECT), size // ROWS
    if height < 1:
        raise ValueError(f"A panel of {size} pixels has no room for {ROWS} rows; give it {ROWS} or more.")
    return [
        [Panel(column * width, size - (row + 1) * height, width, height) for row in range(ROWS)]
        for column in range(4)
    ]


def segments(edge):
    """Segments of round things in a cell of ``edge`` pixels: few for the plain-Python specification."""
    return 12 if edge < 16 else 48 if edge < 80 else 128


@lru_cache(maxsize=8)
def maps(seen, edge, roughness):
    """An environment, directions to colours, as cube maps of floats: unfiltered, filtered by Phong's lobe,
    and filtered by the cosine.
    """
    cube = environments.faces(edge, seen)
    glossy = prefilter.phong(cube, 1.0 / roughness)
    # What is brighter than one is scaled, so that bytes hold it.
    glossy = glossy / max(1.0, float(glossy.max()))
    return np.minimum(cube, 1.0), glossy, prefilter.cosine(cube, 64)


def exposed(factor, exposure, row, number):
    """F as a mirror shows it: the first row's first index ``exposure`` times as bright, one at most."""
    return np.minimum(exposure * factor, 1.0) if (row, number) == (0, 0) else factor


def load_exposed(name, index, exposure, profile):
    """The command that loads ``exposed`` F(n.v) as ``fresnel_passes.load_table`` loads F(n.v)."""
    factor = fresnel(positions(fresnel_passes.TEXELS), index)
    values = factor_texels(exposed(factor, exposure, 0, 0), profile)
    image = texture_1d(values[..., None], InternalFormat.INTENSITY8)
    return TexImage(label=f"load {name}", texture=name, image=image)


def used(panels, way, surface, colors, table, background):
    """The first column: the map, L_d, F and the filtered map."""
    facing = surface.mesh(dot_products((surface.normals, camera(panels[0]).view_vectors(surface.positions))))
    factor = (unit(table, EDGE, environment=REPLACE),)
    drawn = (
        ("the map, laid out", *way.shown(SHARP)),
        ("diffuse light alone", surface.mesh(colors=colors), None),
        (f"{table} as a colour", facing, factor[0]),
        ("the filtered map, laid out", *way.shown(GLOSSY)),
    )
    for panel, (label, mesh, read) in zip(panels, drawn, strict=True):
        flat = label.endswith("laid out")
        view = orthographic_view(panel, glass.MAP_HALF_HEIGHT) if flat else camera(panel)
        yield panel.clear(background)
        units = () if read is None else (read,)
        yield draw(label, mesh, view, None, units, depth_test=FIRST_PASS)


def make_scene(way):
    """The figure's scene by a ``glass.Refraction``."""

    def scene(
        profile, size, *,
        indices, roughness, exposure, diffuse, environment, photograph, objects, detail, background,
    ):  # fmt: skip
        (first, *columns), edge = cells(size), size // ROWS
        texels = glass.texels(edge)
        surface = glass.OBJECTS[objects](segments(edge) if detail is None else detail)
        seen = photograph.panorama if photograph else ENVIRONMENTS[environment]
        sharp, glossy, cosine = maps(seen, texels, roughness)
        light = cube_maps.look_up(cosine, surface.normals) * np.array(diffuse)
        colors = colors_of(factor_texels(light, profile))
        out = list(way.loading(profile, camera(columns[0][0]), {SHARP: sharp, GLOSSY: glossy}))
        for number, (panels, index) in enumerate(zip(columns, indices, strict=True)):
            table = f"F(n.v), index {index:g}"
            out.append(fresnel_passes.load_table(table, index, profile))
            if number == 0:
                out += used(first, way, surface, colors, table, background)
                out.append(load_exposed(f"exposed {table}", index, exposure, profile))
            for row, panel in enumerate(panels):
                view = camera(panel)
                mirror = way.mirror(SHARP if row < ROWS - 1 else GLOSSY, view)
                factor = f"exposed {table}" if (row, number) == (0, 0) else table
                out += (panel.clear(background), *way.passes(surface, view, factor, mirror))
                if row in (1, 2):
                    out.append(fresnel_passes.diffuse_pass(surface, view, colors, coat=row == 2))
                if row == ROWS - 1 and number == 0:
                    mesh = refracted_light.refracted_mesh(surface, view, index)
                    out.append(fresnel_passes.under_coat_pass(mesh, view, way.through(GLOSSY, view, texels)))
        return tuple(out)

    return scene


def reference(size, *, indices, roughness, exposure, diffuse, environment, photograph, objects, detail, **_):
    """The equations at each pixel that a ray finds on the objects. Other pixels, and the maps, have no
    reference.
    """
    edge, (first, *columns) = size // ROWS, cells(size)
    surface = glass.OBJECTS[objects](segments(edge) if detail is None else detail)
    seen = photograph.panorama if photograph else ENVIRONMENTS[environment]
    sharp, glossy, cosine = maps(seen, glass.texels(edge), roughness)
    normals, eye, there = glass.surface_by_rays(surface, camera(columns[0][0]))
    normals, eye = normals[there], eye[there]
    under = cube_maps.look_up(cosine, normals) * np.array(diffuse)
    mirrored = reflected(eye, normals)
    out = np.zeros((size, 4 * first[0].width, 4))

    def fill(panel, colors):
        cell = out[panel.y : panel.y + panel.height, panel.x : panel.x + panel.width]
        cell[there, :3], cell[there, 3] = np.clip(colors, 0.0, 1.0), 1.0

    fill(first[1], under)
    fill(first[2], np.repeat(fresnel(dot(normals, eye), indices[0])[:, None], 3, axis=-1))
    for number, (panels, index) in enumerate(zip(columns, indices, strict=True)):
        factor = fresnel(dot(normals, eye), index)[:, None]
        room = cube_maps.look_up(sharp, mirrored)
        alone, mirror = exposed(factor, exposure, 0, number) * room, factor * room
        frosted = factor * cube_maps.look_up(glossy, mirrored)
        if number == 0:
            through, _ = refracted(eye, normals, 1.0 / index)
            frosted = frosted + (1.0 - factor) * cube_maps.look_up(glossy, through)
        rows = alone, mirror + under, mirror + (1.0 - factor) * under, frosted
        for panel, colors in zip(panels, rows, strict=True):
            fill(panel, colors)
    return out[::-1]


# ----------------------------------------------------------------------------------------------- checks


def half_width(degrees, values):
    """The angle at which values fall to one half, by a line through those near it."""
    near = np.abs(values - 0.5) < 0.2
    slope, at = np.polyfit(degrees[near], values[near], 1)
    return float((0.5 - at) / slope)


# Pixels of a row in the pictures that checks ask for, and the cosine of the edge up to which they do: nearer
# to the outline a pixel holds many angles.
_ROW, _EDGE = 160, 0.15
_BYTE = 1.0 / 255.0


# Of the picture that is displayed: every so manieth pixel is asked; texels along a face by which a lobe is
# summed; radians about a reflection within which the room must have one colour; and what that is.
_EVERY, _FACES, _AROUND, _ONE = 7, 32, 0.03, 3.0 * _BYTE
_NAMES = "first row", "second row", "third row"


@computed_once
def _lobe(directions, exponent):
    """The room filtered by the lobe cos^exponent about directions [n, 3], a sum over texels: RGB [n, 3]."""
    toward = normalize(cube_maps.directions(_FACES)).reshape(-1, 3)
    room = environments.faces(_FACES).reshape(-1, 3)
    solid_angles = np.tile(cube_maps.solid_angles(_FACES).ravel(), 6)
    weights = np.maximum(directions @ toward.T, 0.0) ** exponent * solid_angles
    return (weights @ room) / weights.sum(axis=1, keepdims=True)


def _refracted(eye, normals, index):
    """Where one who looks from ``eye`` looks through a surface, by Snell's law."""
    cosine = dot(eye, normals)[:, None]
    inside = np.sqrt(1.0 - (1.0 - cosine * cosine) / index**2)
    return (cosine / index - inside) * normals - eye / index


def _laid_out(panel, view, sphere):
    """Where each pixel of a map that is laid out looks: directions [height, width, 3], and where it is the
    map, bool [height, width]; of a sphere map without its rim.
    """
    x, y = (
        (2.0 * (np.arange(n) + 0.5) / n - 1.0) * glass.MAP_HALF_HEIGHT * n / panel.height
        for n in (panel.width, panel.height)
    )
    x, y = np.meshgrid(x, y)
    if sphere:
        x, y = x / 1.5, y / 1.5
        inside = x * x + y * y < 0.8
        z = np.sqrt(np.maximum(1.0 - x * x - y * y, 0.0))
        # A mirror's ball far away: +z is reflected in its normals, in the eye's axes.
        toward = np.stack([2.0 * z * x, 2.0 * z * y, 2.0 * z * z - 1.0], axis=-1)
        return toward @ np.array(view.modelview)[:3, :3], inside
    # A room's walls as they stand around one who looks ahead, unfolded.
    column, row = np.floor(x + 2.0), np.floor(y + 1.5)
    u, v, one = 2.0 * (x + 1.5 - column), 2.0 * (y + 1.0 - row), np.ones(x.shape)
    walls = {
        (0, 1): (-one, v, -u), (1, 1): (u, v, -one), (2, 1): (one, v, u), (3, 1): (-u, v, one),
        (1, 2): (u, one, v), (1, 0): (u, -one, -v),
    }  # fmt: skip
    toward, inside = np.stack([u, v, one], axis=-1), np.zeros(x.shape, np.bool_)
    for (across, up), wall in walls.items():
        here = (column == across) & (row == up) & (np.maximum(np.abs(u), np.abs(v)) < 0.97)
        toward[here], inside[here] = np.stack(wall, axis=-1)[here], True
    return toward, inside


def _cell(window, panel):
    return window[panel.y : panel.y + panel.height, panel.x : panel.x + panel.width]


def _even(toward, room):
    """About which directions [n, 3] the room has one colour."""
    steps = _AROUND * np.concatenate([np.eye(3), -np.eye(3)])
    return np.abs(environments.room(toward + steps[:, None]) - room).max(axis=(0, 2)) <= _ONE


def _first_column(window, on, panels, asked, of, exponent, sphere):
    """What the first column must show. ``of``: L_d and F where the objects are ``asked``."""
    toward, inside = _laid_out(panels[0], camera(panels[0]), sphere)
    inside[np.arange(len(inside)) % _EVERY != 0] = inside[:, np.arange(inside.shape[1]) % _EVERY != 0] = False
    toward = normalize(toward[inside])
    room = environments.room(toward)
    expected = (
        ("the map", _cell(window, panels[0])[inside] - room, _even(toward, room)),
        *(
            (name, _cell(window, panel)[asked] - value, slice(None))
            for name, panel, value in zip(("diffuse light", "F"), panels[1:3], of, strict=True)
        ),
    )
    for name, off, where in expected:
        yield DATA.check(
            "first column, {what}: pixels that show it within 6/255",
            float((np.abs(off).max(axis=-1) <= 6.0 * _BYTE)[where].mean()),
            on,
            what=name,
        )
    yield DATA.check(
        "first column, lowest row: RMS from Phong's lobe over the room, in the picture",
        root_mean_square(_cell(window, panels[3])[inside] - _lobe(toward, exponent)),
        on,
    )


def _displayed(figure, renderer):
    """What must be seen, in the picture that is displayed: the equations' colours in the room itself, without
    the maps that the figure makes of it.
    """
    values, (first, *columns) = figure.values, cells(figure.size)
    surface = glass.OBJECTS[values["objects"]](segments(figure.size // ROWS))
    normals, eye, seen = glass.surface_by_rays(surface, camera(columns[0][0]))
    grid = np.zeros(seen.shape, np.bool_)
    grid[::_EVERY, ::_EVERY] = True
    asked = grid & seen & (dot(normals, eye) > _EDGE)
    normals, eye = normals[asked], eye[asked]
    mirrored = reflected(eye, normals)
    room = environments.room(mirrored)
    even = _even(mirrored, room)
    under = _lobe(normals, 1.0) * np.array(values["diffuse"])
    exponent = 1.0 / values["roughness"]
    blurred = _lobe(mirrored, exponent)
    through = _lobe(_refracted(eye, normals, values["indices"][0]), exponent)
    for on in Answer:
        window = np.clip(renderer.window(on, figure, figure.size), 0.0, 1.0)
        of = under, glass.by_polarizations(dot(normals, eye), values["indices"][0])[:, None]
        sphere = renderer.method.name.endswith("sphere map")
        yield from _first_column(window, on, first, asked, of, exponent, sphere)
        for number, (panels, index) in enumerate(zip(columns, values["indices"], strict=True)):
            factor = glass.by_polarizations(dot(normals, eye), index)[:, None]
            drawn = [_cell(window, panel)[asked] for panel in panels]
            mirror, frosted = factor * room, factor * blurred
            alone = exposed(factor, values["exposure"], 0, number) * room
            rows = alone, mirror + under, mirror + (1.0 - factor) * under
            for row, of, expected in zip(_NAMES, drawn, rows, strict=False):
                off = np.abs(of - np.minimum(expected, 1.0)).max(axis=-1)
                yield DATA.check(
                    "index {index:g}, {row}: pixels with the equation's colour of the room, within 6/255",
                    float((off <= 6.0 * _BYTE)[even].mean()),
                    on,
                    index=index,
                    row=row,
                )
            if number == 0:
                frosted = frosted + (1.0 - factor) * through
            yield DATA.check(
                "index {index:g}, lowest row: RMS from Phong's lobe over the room, in the picture",
                root_mean_square(drawn[3] - frosted),
                on,
                index=index,
            )


def checks(figure, renderer):
    """What must be seen; and a ball whose normals come from rays, in a white room, in the room, and in one
    with only a lamp.
    """
    yield from _displayed(figure, renderer)
    size, indices = ROWS * _ROW, figure.values["indices"]
    _, *columns = cells(size)
    normals, eye, seen = glass.ball_by_rays(camera(columns[0][0]))
    cosine = dot(normals, eye)
    asked = seen & (cosine > _EDGE)
    factors = [glass.by_polarizations(cosine[asked], index)[:, None] for index in indices]
    mirrored = reflected(eye, normals)[asked]
    _, glossy, diffuse = maps(environments.room, glass.texels(_ROW), figure.values["roughness"])
    under = cube_maps.look_up(diffuse, normals[asked]) * np.array(figure.values["diffuse"])
    for on in Answer:
        # A machine rounds the table, the map, each product and the sum; the ideal none of them.
        steps = 1.0 if on is Answer.IDEAL else 2.0
        rounding = "" if on is Answer.IDEAL else "; a byte's step more for what bytes round"
        pictures = {}
        for name in ENVIRONMENTS:
            scene = {"environment": name, "objects": "ball", "detail": 192, "exposure": 1.0}
            image = np.clip(renderer.window(on, figure, size, **scene), 0.0, 1.0)
            pictures[name] = [[_cell(image, panel)[asked] for panel in panels] for panels in columns]
        for index, factor, of in zip(indices, factors, pictures["white"], strict=True):
            error = np.abs(of[0] - factor)
            yield DATA.check(
                "index {index:g}: mirror over the map, largest error of F from 0 to 75 degrees",
                error[cosine[asked] > 0.25].max(),
                on,
                at_most=2.0 * _BYTE,
                index=index,
            )
            yield DATA.check(
                "index {index:g}: the same to 81 degrees", error.max(), on, at_most=7.0 * _BYTE, index=index
            )
        for index, factor, (alone, added, coat, _) in zip(indices, factors, pictures["room"], strict=True):
            whole = (added < 1.0).all(axis=-1)
            yield DATA.check(
                "index {index:g}: second row less the first against L_d, where nothing is clamped",
                np.abs(added - alone - under)[whole].max(),
                on,
                at_most=(1.0 if on is Answer.IDEAL else 1.5) * _BYTE,
                index=index,
            )
            yield Check(
                f"index {index:g}: third row less the first against (1 - F) L_d, from 0 to 75 degrees",
                np.abs(coat - alone - (1.0 - factor) * under)[cosine[asked] > 0.25].max(),
                at_most=steps * _BYTE,
                on=on,
                reason="the coat lets through what it does not reflect" + rounding,
            )
            yield DATA.check(
                "index {index:g}: third row above the second", (coat - added).max(), on, index=index
            )
        front = cosine[asked] > 0.5
        least = float(under[front, 0].min())
        left = (pictures["room"][2][2] - pictures["room"][2][0])[front, 0] / under[front, 0]
        yield Check(
            "index 200: what the coat leaves of L_d's red below 60 degrees",
            left.max(),
            at_most=0.04 if on is Answer.IDEAL else 0.04 + _BYTE / least,
            on=on,
            reason="the catalogue's: F is 0.98 to 0.975 there" + rounding,
        )
        metal = pictures["room"][2][3]
        yield DATA.check(
            "index 200, lowest row: RMS from the filtered map looked up at every pixel, times F",
            root_mean_square(metal - factors[2] * cube_maps.look_up(glossy, mirrored)),
            on,
            at_most=0.5 * _BYTE if on is Answer.IDEAL else 0.8 * _BYTE,
        )
        for number, index in enumerate(indices):
            expected = 1.0 if number == 0 else factors[number]
            yield Check(
                f"index {index:g}, lowest row in a white room: largest deviation from "
                + ("one" if number == 0 else "F"),
                np.abs(pictures["white"][number][3] - expected).max(),
                at_most=(1.0 if number == 0 else 2.0) * _BYTE,
                on=on,
                reason="a filter leaves a constant map as it is, and glass what it does not reflect it lets "
                "through",
            )
        peak = pictures["lamp"][2][3][:, 0] / factors[2][:, 0]
        degrees = np.degrees(np.arccos(np.clip(dot(mirrored, LAMP), -1.0, 1.0)))
        yield DATA.check(
            "index 200, lowest row: a lamp's image, degrees to half of its height, off 6.74",
            abs(half_width(degrees, peak / peak.max()) - 6.74),
            on,
        )
    yield DATA.check(
        ("index 1.5: how far the room that is refracted differs from the one that is reflected, RMS"),
        root_mean_square(pictures["room"][0][3] - factors[0] * cube_maps.look_up(glossy, mirrored)),
        Answer.MACHINE,
    )


FIGURE = Figure(
    **DATA.words,
    size=1152,
    aspect=ASPECT,
    parameters={
        "indices": word.of(
            word.Several((word.Number(0.1, 1000.0),) * 3),
            (1.5, 5.0, 200.0),
            "The index of refraction of each column, inside over outside.",
        ),
        "roughness": word.NUMBER(
            0.01, "The lowest row's: the reciprocal of Phong's exponent.", low=0.001, high=1.0
        ),
        "exposure": word.NUMBER(
            6.0, "By what the first row's first index is shown brighter.", low=1.0, high=100.0
        ),
        "diffuse": word.DIFFUSE((0.95, 0.34, 0.16)),
        "environment": word.of(
            word.Choice({name: name for name in ENVIRONMENTS}),
            "room",
            "What is reflected: a room, white everywhere, or a small lamp alone.",
        ),
        "photograph": own_maps.PANORAMA,
        "objects": word.of(
            word.Choice({name: name for name in glass.OBJECTS}), "ball in a ring", "What it is reflected in."
        ),
        "detail": word.of(
            word.Maybe(word.Whole(6, 256, even=True), "as many as fit the panel"),
            None,
            "Segments of round things.",
        ),
        "background": word.BACKDROP(BACKGROUND),
    },
    methods=(
        Method("three passes, a cube map", make_scene(glass.CUBE_MAPS), ("GEFORCE_256",)),
        Method(
            "two units and two passes, a cube map",
            make_scene(glass.CUBE_MAPS_FOLDED),
            ("GEFORCE_3", "NV2A", "FUTURE"),
        ),
        Method(
            "three passes, a sphere map",
            make_scene(glass.SPHERE_MAPS),
            ("OPENGL_1_2", "OCTANE", "INFINITE_REALITY"),
        ),
        Method(
            "two units and two passes, a sphere map",
            make_scene(glass.SPHERE_MAPS_FOLDED),
            ("MULTITEXTURE", "G400"),
        ),
    ),
    acceptance=checks,
    reference=reference,
)

"""S15: a globe whose frame comes from its normal and its axis, and a sheet where frames part."""

from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.acceptance.distant_light import shone
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import pixel_grid, root_mean_square
from fixedpipe.effects.bump_mapping import blinn, normalization_cube_map, offset_vector_passes, offset_vectors
from fixedpipe.effects.bump_mapping.offset_vector_passes import Lighting
from fixedpipe.effects.bump_mapping.offset_vectors import Frame
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.matrices import rotate, rotation
from fixedpipe.effects.geometry.vectors import cosine, dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.scenes.bumped_patches import Patch, corners_of_grid, globe, sheared_sheet
from fixedpipe.effects.user_pictures.bumped_mesh import fitted

DATA = figure_data(__file__, "S15")

_LAND, _STONES = 256, 128
_CUBE, _PLANE = 128, 256
_HALF_HEIGHT, _TILT = 1.1, 24.0
_AXIS = (0.0, 1.0, 0.0)
# Parts of the globe's, the sheet's and a mesh's texture space, on boards with one matrix for a draw.
_GLOBE_PARTS, _SHEET_PARTS, _MESH_PARTS = (24, 12), (4, 4), (16, 12)


@lru_cache(4)
def land(height, size):
    """Heights of a globe, over its radius: float64 [rows, columns], flat towards the poles and at sea."""
    rows = min(_LAND, max(32, 1 << (size - 1).bit_length()))
    columns = 2 * rows
    s, t = height_fields.texel_centers(columns, rows)
    # Twice as many cells along the equator as from pole to pole.
    ground = height_fields.turbulence(2.0 * s % 1.0, t, 4, 5, 11) * 0.6
    ground = ground + height_fields.turbulence(s, 0.5 * t, 6, 5, 5)
    ground = np.maximum(ground + 0.06, 0.0)
    shore = ground / (ground + 0.05)
    latitude = cosine(np.pi * (t - 0.5))
    return height * (shore * (0.35 + ground)) * np.clip(3.0 * latitude - 1.2, 0.0, 1.0)


def land_slopes(height, size):
    """(f_1, f_2) of the globe's heights, eastward and northward: float64 [rows, columns, 2]."""
    f = offset_vectors.of_heights(land(height, size))
    rows, columns = f.shape[:2]
    _, t = height_fields.texel_centers(columns, rows)
    around = 2.0 * np.pi * cosine(np.pi * (t - 0.5))
    return np.stack([f[..., 0] / around, f[..., 1] / np.pi], axis=-1)


@lru_cache(4)
def stones(depth, own, own_scale):
    """(f_1, f_2) of a round stone, or of a user's heights: float64 [_STONES, _STONES, 2]."""
    if own is not None:
        return offset_vectors.of_heights(own.fitted(_STONES, _STONES, own_scale, repeated=True))
    s, t = height_fields.texel_centers(_STONES, _STONES)
    x, y = 2.0 * s - 1.0, 2.0 * t - 1.0
    left = np.maximum(1.0 - (x * x + y * y) / 0.72, 0.0)
    return offset_vectors.of_heights(depth * (left * left * (3.0 - 2.0 * left)))


def globe_normals(size, corners):
    """The fine globe, and n_I at its vertices, which goes straight between ``corners``."""
    columns, rows = corners
    divided = max(1, min(6, size // 80))
    at, coarse = corners_of_grid(columns, rows, divided), globe(columns, rows).surface.normals
    turn = rotation("x", _TILT)
    straight = offset_vectors.straight(coarse[at.numbers], at.weights)
    return globe(columns * divided, rows * divided).rotated(turn), rotate(turn, straight)


def axis():
    """The globe's main direction: its axis, turned to the viewer."""
    return rotate(rotation("x", _TILT), np.array(_AXIS))


def sheet(size, p):
    """The Patch whose u and v meet aslant, or the user's mesh."""
    if p["mesh"] is not None:
        surface = fitted(p["mesh"].surface, (0.0, 0.0, 1.0))
        return Patch(surface, *offset_vectors.derivatives_of_mesh(surface)).with_repeats(*p["repeats"])
    cells = max(4, min(24, size // 20))
    made = sheared_sheet(cells, cells, shear=p["shear"], half_width=0.95, half_height=0.95)
    return made.with_repeats(*p["repeats"])


def sheet_frames(patch, p):
    """S14's Frame at the vertices, and S15's for the same offsets: slopes turn their sign along e_1, e_2."""
    unit = offset_vectors.normalized(patch.p_u, patch.p_v, patch.surface.normals)
    e = offset_vectors.of_main_direction(patch.surface.normals, p["main"])
    return unit, Frame(e.normal, -e.first, -e.second)


def _lighting(p):
    return Lighting(**{name: p[name] for name in ("light", "color", "ambient", "specular", "exponent")})


def _globe_frame(normals, unit=True):
    return offset_vectors.of_main_direction(normals, axis(), unit=unit)


def _maps(size, p):
    """Offsets of the globe's map and of the sheet's, with their scales."""
    g = offset_vectors.along_frame(land_slopes(p["height"], size))
    f = stones(p["depth"], p["height_field"], p["height_scale"])
    return g, offset_vectors.largest(g), f, offset_vectors.largest(f)


def scene_by(way):
    """The scene by "rows", "combiners" or "offsets"."""

    def scene(profile, size, *, background, **p):
        panels = row_of_panels(4, size)
        views = [orthographic_view(panel, _HALF_HEIGHT) for panel in panels]
        g, land_scale, f, stone_scale = _maps(size, p)
        lighting, passes = _lighting(p), offset_vector_passes
        placed, normals = globe_normals(size, p["corners"])
        patch = sheet(size, p)
        frames = sheet_frames(patch, p)
        out = [panel.clear(background) for panel in panels]
        if way == "offsets":
            out += [
                *(passes.load_light_in_plane(_PLANE, profile, lighting, unit) for unit in (True, False)),
                passes.load_offsets(g, land_scale, "land", profile),
                passes.load_offsets(f, stone_scale, "stones", profile),
            ]
            cut = {"across": _GLOBE_PARTS[0], "along": _GLOBE_PARTS[1]}
            for view, unit in ((views[0], True), (views[1], False)):
                frame = _globe_frame(normals, unit)
                out += passes.offset_passes(
                    placed.surface, frame, "land", land_scale, view, unit_length=unit, **cut
                )
            across, along = _SHEET_PARTS if p["mesh"] is None else _MESH_PARTS
            cut = {"across": across, "along": along}
            for view, frame in zip(views[2:], frames, strict=True):
                out += passes.offset_passes(patch.surface, frame, "stones", stone_scale, view, **cut)
            return tuple(out)
        out += [
            passes.load_light(_CUBE, profile, lighting),
            passes.load_with_one(g, land_scale, "land and one", profile),
            *passes.plain_pass(
                placed.surface, _globe_frame(normals, unit=False), "land and one", land_scale, views[1],
                profile, lighting=lighting,
            ),
        ]  # fmt: skip
        if way == "combiners":
            slopes, turned = "stones by slopes", "stones by offsets"
            out += [
                normalization_cube_map.load(_CUBE, profile),
                passes.load_biased(g, land_scale, "land", profile),
                passes.load_biased(f, stone_scale, slopes, profile),
                passes.load_biased(offset_vectors.along_frame(f), stone_scale, turned, profile),
                *passes.main_direction_pass(
                    placed.surface, normals, axis(), "land", land_scale, views[0], profile
                ),
                *passes.natural_pass(patch.surface, frames[0], None, slopes, stone_scale, views[2], profile),
                *passes.main_direction_pass(
                    patch.surface, patch.surface.normals, p["main"], turned, stone_scale, views[3], profile
                ),
            ]
            return tuple(out)
        out += [
            passes.load_signed(g, land_scale, "land", profile),
            passes.load_signed(f, stone_scale, "stones", profile),
            *passes.dot_product_pass(placed.surface, _globe_frame(normals), "land", land_scale, views[0]),
        ]
        for view, frame in zip(views[2:], frames, strict=True):
            out += passes.dot_product_pass(patch.surface, frame, "stones", stone_scale, view)
        return tuple(out)

    return scene


# ---------------------------------------------------------------------------------------------- checks

_ROWS, _COMBINERS, _OFFSETS = (
    "dot products, frames by the host",
    "roots and quotients in the combiners",
    "displaced light, a matrix for each part",
)
# RMS from the light in float, by way, and why.
_NEAR = {
    _ROWS: (
        0.01,
        "frames go straight between vertices 3.75 degrees apart; n' and light are bytes' width off",
    ),
    _COMBINERS: (0.01, "normals alone go straight; the cube map's texels are 0.7 degrees"),
    _OFFSETS: (
        0.055,
        "one matrix, a secant, for parts of 15 degrees, and slopes that leave the disc of normals; measured "
        "0.042, and 0.071 with matrices transposed",
    ),
}


def _offset_normals(size, g):
    """n + g_1 e_1 + g_2 e_2 at every pixel of the globe, and which pixels lie well on it: bool.

    Vectors are float64 [size, size, 3].
    """
    x, y = pixel_grid(size, 1.0 / _HALF_HEIGHT)
    square = 1.0 - x * x - y * y
    normals = np.stack([x, y, np.sqrt(np.maximum(square, 0.0))], axis=-1)
    back = rotate(rotation("x", -_TILT), normals)
    s = np.arctan2(back[..., 0], back[..., 2]) / (2.0 * np.pi) + 0.5
    t = np.arcsin(np.clip(back[..., 1], -1.0, 1.0)) / np.pi + 0.5
    g = np.stack([blinn.interpolated(g[..., k], s, t) for k in range(2)], axis=-1)
    east = normalize(np.cross(np.broadcast_to(axis(), normals.shape), normals))
    return normals + g[..., :1] * east + g[..., 1:] * np.cross(normals, east), square > 0.1


def in_float(size, p):
    """The globe's light at every pixel, and which pixels lie well on it: float64 [size, size, 3], bool."""
    bumped, inside = _offset_normals(size, _maps(size, p)[0])
    return np.clip(_lighting(p).radiance(normalize(bumped)), 0.0, 1.0), inside


def _not_normalized(size, p, g):
    """The second globe's light at pixels well on it, [n, 3], and these pixels."""
    bumped, inside = _offset_normals(size, g)
    cosine = np.clip(bumped[inside] @ seen_places.unit(np.array(p["light"])), 0.0, 1.0)
    return np.array(p["ambient"]) + cosine[:, None] * np.array(p["color"]), inside


def _sheets_in_float(size, p, field):
    """Both sheets' light from their equation, [n, 3] each, and the pixels well on them."""
    half, bulge = 0.95, 0.35
    x, y = pixel_grid(size, half / _HALF_HEIGHT)
    where = np.maximum(np.abs(x), np.abs(y)) < 0.97
    x, y = x[where], y[where]
    p_u = np.stack([0.0 * x + 2.0 * half, 0.0 * x, -2.0 * bulge * x], axis=-1)
    p_v = np.stack([0.0 * x, 0.0 * x + 2.0 * half, -2.0 * bulge * y], axis=-1) + p["shear"] * p_u
    normals, t = seen_places.unit(np.cross(p_u, p_v)), (y + 1.0) / 2.0
    s = ((x + 1.0) / 2.0 - p["shear"] * (t - 0.5)) * p["repeats"][0]
    place = seen_places.Seen(where, s, t * p["repeats"][1], np.empty((len(s), 3, 3)))
    f = seen_places.looked_up(field, place)
    east = seen_places.unit(np.cross(np.array(p["main"]), normals))
    frames = (np.cross(normals, p_v), np.cross(p_u, normals)), (-east, -np.cross(normals, east))
    light = []
    for first, second in frames:
        offsets = f[:, :1] * seen_places.unit(first) + f[:, 1:] * seen_places.unit(second)
        light.append(shone(seen_places.unit(normals + offsets), p))
    return light, where


def _relief_checks(figure, renderer, size, changes):
    """The second globe beside its land upside down; each sheet beside its stones so, and the other frame."""
    p = dict(figure.values)
    g, _, f, _ = _maps(size, p)
    (globe_true, inside), (globe_turned, _) = (_not_normalized(size, p, v) for v in (g, g[::-1]))
    (true, where), (turned, _) = (_sheets_in_float(size, p, v) for v in (f, f[::-1]))
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size, **changes), 0.0, 1.0)
        yield DATA.check(
            "not normalized: of the land's way up, the share that is seen",
            least_share(panel_of(window, 1)[inside], globe_true, globe_turned),
            on,
        )
        shares = [
            least_share(panel_of(window, 2 + k)[where], true[k], turned[k], true[1 - k]) for k in (0, 1)
        ]
        yield DATA.check(
            "sheets: of the stones' way up and of the frame, the least share that is seen", min(shares), on
        )


def _displaced(p):
    """Normals of the displaced globe's points by differences, and by offsets in the frame, at texels below 65
    degrees of latitude: float64 [n, 3] each.
    """
    heights = land(p["height"], 256)
    s, t = height_fields.texel_centers(*heights.shape[::-1])
    longitude, latitude = 2.0 * np.pi * (s - 0.5), np.pi * (t - 0.5)
    normals = np.stack(
        [np.cos(latitude) * np.sin(longitude), np.sin(latitude), np.cos(latitude) * np.cos(longitude)], -1
    )
    points = (1.0 + heights)[..., None] * normals
    along = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
    up = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    frame = offset_vectors.of_main_direction(normals, _AXIS)
    offsets = offset_vectors.along_frame(land_slopes(p["height"], 256))
    kept = np.abs(latitude) < np.radians(65.0)
    return normalize(np.cross(along, up))[kept], normalize(offset_vectors.bumped(frame, offsets))[kept]


def _lengths(size, corners):
    """|n_I| at the pixels of the globe: the least, of those that are seen well."""
    placed, normals = globe_normals(size, corners)
    seen = placed.surface.normals[:, 2] > 0.4
    return float(np.sqrt(dot(normals, normals))[seen].min())


def checks(figure, renderer):
    """East and the displaced globe; pictures against light in float; lost relief, and where the frames
    differ.
    """
    p, size, way = dict(figure.values), 256, renderer.method.name
    longitude = np.linspace(-3.0, 3.0, 61)
    for latitude in (-1.2, 0.0, 0.7):
        normals = np.stack(
            [
                np.cos(latitude) * np.sin(longitude),
                np.full(61, np.sin(latitude)),
                np.cos(latitude) * np.cos(longitude),
            ],
            -1,
        )
        first = offset_vectors.of_main_direction(normals, _AXIS).first
        east = np.stack([np.cos(longitude), 0.0 * longitude, -np.sin(longitude)], axis=-1)
        yield DATA.check(
            "e_1 from east at {n:.0f} degrees of latitude, largest",
            float(np.abs(first - east).max()),
            Answer.IDEAL,
            n=np.degrees(latitude),
        )
    truth, bumped = _displaced(p)
    lean = np.degrees(np.arccos(np.clip(dot(truth, bumped), -1.0, 1.0)))
    yield DATA.check(
        "angle of n' from the displaced globe's normal by differences, RMS in degrees",
        root_mean_square(lean),
        Answer.IDEAL,
    )
    fine, dark = {"corners": (48, 24)}, {"background": (0.0, 0.0, 0.0)}
    expected, inside = in_float(size, p)
    bound, why = _NEAR[way]
    for on in Answer:
        first = panel_of(np.clip(renderer.window(on, figure, size, **fine, **dark), 0.0, 1.0), 0)
        yield Check(
            "RMS of the first globe from light in float, with corners 7.5 degrees apart",
            root_mean_square((first - expected)[inside]),
            at_most=bound,
            on=on,
            reason=why,
        )
        plain = {"specular": 0.0, "ambient": (0.0,) * 3, "color": (1.0,) * 3, "height": 0.0, **dark}
        window = renderer.window(on, figure, size, **plain)
        first, second = (panel_of(window, k)[..., 0] for k in (0, 1))
        bright = inside & (first > 0.4)
        if way != _OFFSETS:
            yield DATA.check(
                (
                    "least of light not normalized over normalized, no bumps, from the shortest "
                    "normal's length"
                ),
                abs(float((second[bright] / first[bright]).min()) - _lengths(size, p["corners"])),
                on,
            )
        for shear, bounds in ((0.0, {"at_most": 0.008}), (p["shear"], {"at_least": 0.05})):
            window = np.clip(renderer.window(on, figure, size, shear=shear, **dark), 0.0, 1.0)
            yield Check(
                f"RMS between the sheet's frames, lines of u leaning {shear:g} widths",
                root_mean_square(panel_of(window, 2) - panel_of(window, 3)),
                **bounds,
                on=on,
                reason="at right angles both frames are one, but for the sheet's bulge; aslant u's and v's "
                "vectors follow the stones and an orthonormal frame does not",
            )
    if way != _OFFSETS:  # there one matrix, a secant, serves a part of the surface
        yield from _relief_checks(figure, renderer, size, {**fine, **dark})


FIGURE = Figure(
    **DATA.words,
    parameters={
        "corners": word.of(
            word.Several((word.Whole(3, 64), word.Whole(2, 32))),
            (8, 4),
            "Cells of the grid, around the globe and from pole to pole, whose corners have normals.",
        ),
        "height": word.NUMBER(0.3, "How high the globe's land is.", low=0.0, high=2.0),
        "shear": word.NUMBER(
            1.5, "How far the sheet's lines of one u lean to the right, in its width.", low=-4.0, high=4.0
        ),
        "repeats": word.of(
            word.Several((word.Whole(1, 64),) * 2), (4, 5), "How often the stone comes along u and v."
        ),
        "depth": word.NUMBER(0.28, "How high a stone is, of its map's edge.", low=0.0, high=2.0),
        "main": word.of(word.DIRECTION_KIND, _AXIS, "The main direction m of the sheet, or of the mesh."),
        "light": word.LIGHT((-0.62, 0.42, 0.66)),
        "color": word.DIFFUSE((0.66, 0.66, 0.56)),
        "ambient": word.AMBIENT((0.06, 0.06, 0.08)),
        "specular": word.NUMBER(0.25, "The highlight's strength, k_s.", low=0.0, high=1.0),
        "exponent": word.of(word.Whole(1, 128), 16, "The highlight's exponent."),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the stones"),
        "height_scale": own_maps.HEIGHT_SCALE(0.2),
        "mesh": own_maps.mesh("the sheet"),
    },
    methods=(
        Method(_ROWS, scene_by("rows"), ("GEFORCE_3", "NV2A")),
        Method(_COMBINERS, scene_by("combiners"), ("FUTURE",)),
        Method(_OFFSETS, scene_by("offsets"), ("G400", "TEXRAM")),
    ),
    acceptance=checks,
)

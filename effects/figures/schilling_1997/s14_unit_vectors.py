"""S14: one bump map on a ring, few and many times, in the natural frame and in one of unit vectors."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.acceptance import seen_places
from fixedpipe.effects.acceptance.check import Answer
from fixedpipe.effects.acceptance.distant_light import shone
from fixedpipe.effects.acceptance.material_reference import least_share
from fixedpipe.effects.acceptance.measures import root_mean_square
from fixedpipe.effects.bump_mapping import blinn, normalization_cube_map, offset_vector_passes, offset_vectors
from fixedpipe.effects.bump_mapping.offset_vector_passes import Lighting
from fixedpipe.effects.bump_mapping.offset_vectors import Frame
from fixedpipe.effects.data_files import figure_data
from fixedpipe.effects.figures import own_maps
from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.figure import Figure, Method
from fixedpipe.effects.geometry import height_fields
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import dot, normalize
from fixedpipe.effects.geometry.views import BACKGROUND, Panel, orthographic_view, panel_of, row_of_panels
from fixedpipe.effects.scenes.bumped_patches import ring

DATA = figure_data(__file__, "S14")

_MAP, _CUBE = 128, 128
_MAP_NAME = "pebbles"
_HALF_HEIGHT, _TILT = 1.08, 52.0
_RADIUS, _TUBE = 0.68, 0.32
# Of each panel: whether vectors are of length one, and which number of repeats it has.
_PANELS = ((False, 0), (False, 1), (True, 0), (True, 1))


@lru_cache(4)
def derivatives(height, own, own_scale):
    """(f_u, f_v) of a bed of pebbles, or of a user's heights: float64 [_MAP, _MAP, 2]."""
    if own is not None:
        return offset_vectors.of_heights(own.fitted(_MAP, _MAP, own_scale, repeated=True))
    heights = height_fields.smooth(height_fields.pebbles(_MAP, _MAP, 4, 7), 3)
    return offset_vectors.of_heights(height * heights)


def _ring(size):
    around = max(24, min(96, size // 5))
    return ring(around, around // 2, _RADIUS, _TUBE).rotated(rotation("x", _TILT))


def _repeated(patch, repeats, which):
    around, across = (count * (repeats[2] if which else 1) for count in repeats[:2])
    return patch.with_repeats(around, across)


def frame_of(patch, of_unit_length):
    """The vertices' Frame."""
    of = offset_vectors.normalized if of_unit_length else offset_vectors.natural
    return of(patch.p_u, patch.p_v)


def _sizes(frame):
    """Lengths of s_u and s_v over the normal's: float64 [n, 2]."""
    normal, *lengths = (np.sqrt(dot(v, v)) for v in (frame.normal, frame.first, frame.second))
    return np.stack([length / normal for length in lengths], axis=-1)


def _lighting(p):
    return Lighting(**{name: p[name] for name in ("light", "color", "ambient", "specular", "exponent")})


def scene_by(combiners):
    """The scene on machines whose combiners have roots and quotients, or on those without."""

    def scene(profile, size, *, repeats, background, **p):
        panels, patch = row_of_panels(len(_PANELS), size), _ring(size)
        f = derivatives(p["height"], p["height_field"], p["height_scale"])
        scale = offset_vectors.largest(f)
        loaded = offset_vector_passes.load_biased if combiners else offset_vector_passes.load_signed
        out = [
            *(panel.clear(background) for panel in panels),
            offset_vector_passes.load_light(_CUBE, profile, _lighting(p)),
            loaded(f, scale, _MAP_NAME, profile),
        ]
        if combiners:
            out.append(normalization_cube_map.load(_CUBE, profile))
        for panel, (of_unit_length, which) in zip(panels, _PANELS, strict=True):
            view, placed = orthographic_view(panel, _HALF_HEIGHT), _repeated(patch, repeats, which)
            frame = frame_of(placed, of_unit_length)
            if combiners:
                toward = Frame(*(normalize(v) for v in (frame.normal, frame.first, frame.second)))
                sizes = None if of_unit_length else _sizes(frame)
                out += offset_vector_passes.natural_pass(
                    placed.surface, toward, sizes, _MAP_NAME, scale, view, profile
                )
            else:
                out += offset_vector_passes.dot_product_pass(placed.surface, frame, _MAP_NAME, scale, view)
        return tuple(out)

    return scene


# ---------------------------------------------------------------------------------------------- checks


def _slopes(p, of_unit_length, which):
    """How steep bumps are on the ring, at points that fall anywhere on the map: RMS."""
    patch = _repeated(ring(211, 97), p["repeats"], which)
    frame = frame_of(patch, of_unit_length)
    st = patch.surface.texture_coordinates
    f = derivatives(p["height"], p["height_field"], p["height_scale"])
    f = np.stack([blinn.interpolated(f[..., k], st[:, 0], st[:, 1]) for k in range(2)], axis=-1)
    added = offset_vectors.bumped(frame, f) - frame.normal
    return root_mean_square(np.sqrt(dot(added, added) / dot(frame.normal, frame.normal)))


def _by_rays(size, p, seen, of_unit_length, which, heights):
    """A panel's light where rays meet the ring, in float64: [n, 3]. ``heights``: the map's derivatives."""
    u, v = (count * (p["repeats"][2] if which else 1) for count in p["repeats"][:2])
    slopes = seen_places.looked_up(heights, replace(seen, s=seen.s * u, t=seen.t * v))
    if not of_unit_length:
        # How far a step of the map leads: round the axis, and round the tube.
        away = _RADIUS + _TUBE * np.cos(2.0 * np.pi * (seen.t - 0.5))
        slopes = slopes / (2.0 * np.pi * np.stack([away / u, np.full_like(away, _TUBE / v)], axis=-1))
    tangents, binormals, normals = np.moveaxis(seen.frames, 1, 0)
    return shone(seen_places.unit(normals - slopes[:, :1] * tangents - slopes[:, 1:] * binormals), p)


def _displayed_checks(figure, renderer):
    """Each panel beside its own map upside down, and beside the other frame."""
    size, p = figure.size, dict(figure.values)
    view = orthographic_view(Panel(0, 0, size, size), _HALF_HEIGHT)
    seen = seen_places.surface(_ring(size).surface, view)
    heights = derivatives(p["height"], p["height_field"], p["height_scale"])
    true = [
        (
            _by_rays(size, p, seen, unit, which, heights),
            _by_rays(size, p, seen, unit, which, heights[::-1]),
            _by_rays(size, p, seen, not unit, which, heights),
        )
        for unit, which in _PANELS
    ]
    for on in Answer:
        window = np.clip(renderer.window(on, figure, size), 0.0, 1.0)
        shares = [least_share(panel_of(window, k)[seen.where], *of) for k, of in enumerate(true)]
        yield DATA.check(
            "of the map's way up and of the frame's lengths, the least share that is seen", min(shares), on
        )


def checks(figure, renderer):
    """How steep bumps are where the map is scaled: of the frames by themselves, and in the pictures."""
    p, size = dict(figure.values), 256
    times = p["repeats"][2]
    # Low bumps and dull ones, whose light goes with their slopes.
    low = {"specular": 0.0, "ambient": (0.5, 0.5, 0.5), "color": (0.5, 0.5, 0.5), "background": (0.0,) * 3}
    for on in Answer:
        bumped, smooth = (
            renderer.window(on, figure, size, **low, height=height) for height in (0.2 * p["height"], 0.0)
        )
        shown = panel_of(smooth, 0).max(axis=-1) > 0.0
        change = [root_mean_square(panel_of(bumped - smooth, k)[shown]) for k in range(4)]
        yield DATA.check(
            ("what low bumps change {times} times smaller over what they change at first, natural frame"),
            change[1] / change[0] / times,
            on,
            times=times,
        )
        yield DATA.check(
            "the same in unit vectors, its distance from one", abs(change[3] / change[2] - 1.0), on
        )
    for name, of_unit_length, expected in (("natural", False, times), ("unit vectors", True, 1.0)):
        ratio = _slopes(p, of_unit_length, 1) / _slopes(p, of_unit_length, 0)
        yield DATA.check(
            "slopes of the frames by themselves, many over few, {name}: distance from {expected:g}",
            abs(ratio - expected),
            Answer.IDEAL,
            at_most=0.03 * expected,
            name=name,
            expected=expected,
        )
    yield from _displayed_checks(figure, renderer)


FIGURE = Figure(
    **DATA.words,
    parameters={
        "repeats": word.of(
            word.Several((word.Whole(1, 64), word.Whole(1, 64), word.Whole(1, 8))),
            (4, 2, 3),
            "How often the map comes around the ring's axis and its tube, and how many times as often then.",
        ),
        "height": word.NUMBER(
            1.0, "How high the pebbles stand over half balls of a map a unit wide.", low=0.0, high=4.0
        ),
        "light": word.LIGHT((-0.45, 0.6, 0.66)),
        "color": word.DIFFUSE((0.36, 0.56, 0.66)),
        "ambient": word.AMBIENT((0.05, 0.06, 0.08)),
        "specular": word.NUMBER(0.5, "The highlight's strength, k_s.", low=0.0, high=1.0),
        "exponent": word.of(word.Whole(1, 128), 24, "The highlight's exponent."),
        "background": word.BACKDROP(BACKGROUND),
        "height_field": own_maps.height_field("the pebbles"),
        "height_scale": own_maps.HEIGHT_SCALE(0.1),
    },
    methods=(
        Method("dot products of texture shaders", scene_by(False), ("GEFORCE_3", "NV2A")),
        Method("roots and quotients in the combiners", scene_by(True), ("FUTURE",)),
    ),
    acceptance=checks,
)

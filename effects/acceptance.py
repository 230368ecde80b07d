"""Acceptance checks of the figures, as code: what must be seen, measured.

A check renders what it needs, on the machine or on the ideal, and compares one number with one bound. Bounds
are the catalogue's (docs/reading-guide.md) where it computed or proposed them; others were measured at the
first correct picture and frozen with about a third of slack. The mathematics is asserted on the free ideal;
the machine has bounds of its own.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from effects import brdfs, height_fields, scenes
from effects.matrices import rotate, rotation
from effects.scenes import RING_HALF, pixel_grid
from effects.vectors import cross, normalize
from pipeline.profiles import IDEAL


@dataclass(frozen=True)
class Check:
    """One acceptance check: ``value relation bound``.

    ``relation``: "<=" or ">=". ``on``: "ideal" (the algorithm itself) or "machine" (with its arithmetic).
    ``reason``: why this bound.
    """

    name: str
    value: float
    relation: str
    bound: float
    on: str
    reason: str

    @property
    def passed(self):
        """Whether the value keeps the bound; a NaN does not."""
        return self.value <= self.bound if self.relation == "<=" else self.value >= self.bound


@dataclass(frozen=True)
class Renderer:
    """How checks get pictures: a machine, and ``pipeline.execute.execute`` and
    ``pipeline.ideal.execute_ideal``.
    """

    profile: object
    execute: Callable
    execute_ideal: Callable

    def machine(self, scene, columns, size, /, **parameters):
        """RGB float64 [size, columns * size, 3] of the machine's bytes / 255, bottom row first."""
        commands = scene(self.profile, size, **parameters)
        result = self.execute(commands, self.profile, columns * size, size)
        return result.framebuffer.color[::-1, :, :3] / 255.0

    def ideal(self, scene, columns, size, /, **parameters):
        """RGB float64 [size, columns * size, 3] of the free ideal, bottom row first."""
        result = self.execute_ideal(scene(IDEAL, size, **parameters), columns * size, size)
        return result.color[::-1, :, :3]


def _rms(a):
    return float(np.sqrt((a * a).mean()))


_HIGHLIGHT_ONLY = {
    "domes": 1,
    "extent": 1.0,
    "diffuse": (0.0, 0.0, 0.0),
    "ambient": (0.0, 0.0, 0.0),
    "specular": (1.0, 1.0, 1.0),
    "background": (0.0, 0.0, 0.0),
}


def ring_energy(image, map_size, alpha_x, alpha_y):
    """Error energy in the annulus 1.5 texels wide on either side of the rim, over the true highlight's
    energy.

    ``image``: float64 [size, size] of one dome, bottom row first. Returns the ratio, and the image's maximum
    where the true highlight in the annulus is zero.
    """
    size = image.shape[0]
    s, t = height_fields.texel_centers(size, size)
    _, tangent, binormal = height_fields.frames(*height_fields.dome_slopes(s, t))
    true = brdfs.anisotropic_blinn_phong(RING_HALF, tangent, binormal, alpha_x, alpha_y)
    x, y = pixel_grid(size, 1.0)
    annulus = np.abs(np.sqrt(x * x + y * y) - 0.6) < 3.0 / map_size
    error = (image - true)[annulus]
    dark = annulus & (true == 0.0)
    return float((error * error).sum() / (true * true).sum()), float(image[dark].max())


def domes_checks(figure, renderer):
    """The rings' energies, their brightness, and that they come from interpolation and not from 8 bits."""
    size, alphas, out = 512, {"alpha_x": 0.25, "alpha_y": 0.25}, []
    catalogued = {32: (0.2574, 7e-4), 64: (0.115, 1e-4), 128: (0.058, 1e-4)}
    for map_size, (expected, software_bound) in catalogued.items():
        parameters = {**_HIGHLIGHT_ONLY, **alphas, "map_size": map_size}
        ideal = renderer.ideal(scenes.domes_scene, 2, size, **parameters)[..., 0]
        machine = renderer.machine(scenes.domes_scene, 2, size, **parameters)[..., 0]
        software, _ = ring_energy(ideal[:, :size], map_size, 0.25, 0.25)
        ideal_energy, ideal_peak = ring_energy(ideal[:, size:], map_size, 0.25, 0.25)
        energy, peak = ring_energy(machine[:, size:], map_size, 0.25, 0.25)
        what = f"{map_size}x{map_size} maps"
        out += [
            Check(
                f"ring energy of evaluate-then-interpolate, {what}",
                software,
                "<=",
                1.1 * software_bound,
                "ideal",
                "the catalogue's computed energy with 10 % for its rounding to one digit",
            ),
            Check(
                f"ring energy of the pass against {expected:g}, {what}: relative deviation",
                abs(ideal_energy / expected - 1.0),
                "<=",
                0.05,
                "ideal",
                "the catalogue's computed energy, printed to two or three digits",
            ),
            Check(
                f"ring energy, software / combiners, {what}",
                software / energy,
                "<=",
                0.05,
                "machine",
                "the catalogue's acceptance: rings stand out against the software renderer",
            ),
            Check(
                f"brightest ring pixel where the true highlight is zero, {what}",
                peak,
                ">=",
                0.9,
                "machine",
                "the catalogue's acceptance: the rings are as bright as a highlight",
            ),
            Check(
                f"brightest ring pixel where the true highlight is zero, {what}",
                ideal_peak,
                ">=",
                0.9,
                "ideal",
                "the same without the machine's arithmetic: interpolation alone makes the rings",
            ),
            Check(
                f"ring energy, machine against ideal, {what}: relative deviation",
                abs(energy / ideal_energy - 1.0),
                "<=",
                0.05,
                "machine",
                "the catalogue's acceptance: 8-bit textures must not change the energy by more than 5 %; "
                "here with the 9-bit combiners included",
            ),
        ]
    return tuple(out)


def scratch_visibility(image, material, extent):
    """Contrast (on - off)/(on + off) of the scratches along x and along y in one panel.

    ``image``: float64 [size, size] intensities, bottom row first. A pixel belongs to the texel under its
    centre.
    """
    x, y = pixel_grid(image.shape[0], extent)
    edge = material.scratched.shape[0]
    inside = np.maximum(np.abs(x), np.abs(y)) < 1.0
    column = np.clip(np.floor((x + 1.0) * (0.5 * edge)).astype(np.int64), 0, edge - 1)
    row = np.clip(np.floor((y + 1.0) * (0.5 * edge)).astype(np.int64), 0, edge - 1)
    off = float(image[inside & ~material.scratched[row, column]].mean())
    contrasts = []
    for scratches in (material.along_s, material.along_t):
        on = float(image[inside & scratches[row, column]].mean())
        contrasts.append((on - off) / (on + off))
    return tuple(contrasts)


def scratches_checks(figure, renderer):
    """Which scratches each light shows, on the ideal and on the machine."""
    size, out = 512, []
    material = scenes.scratched_square(figure.parameters["seed"], figure.parameters["count"])
    reasons = {
        "ideal": "the catalogue's acceptance",
        "machine": "the catalogue's acceptance; the contrast is a mean over thousands of pixels, in which "
        "rounding to bytes averages out",
    }
    for on in ("ideal", "machine"):
        image = getattr(renderer, on)(scenes.scratches_scene, 3, size, **figure.parameters).mean(axis=-1)
        from_x, from_y, top = (
            scratch_visibility(image[:, k * size : (k + 1) * size], material, figure.parameters["extent"])
            for k in range(3)
        )
        for name, value, relation, bound in (
            ("light from +x: scratches along y seen", from_x[1], ">=", 0.3),
            ("light from +x: scratches along x not seen, |contrast|", abs(from_x[0]), "<=", 0.05),
            ("light from +y: scratches along x seen", from_y[0], ">=", 0.3),
            ("light from +y: scratches along y not seen, |contrast|", abs(from_y[1]), "<=", 0.05),
            ("light from the top: scratches along x seen", top[0], ">=", 0.15),
            ("light from the top: scratches along y seen", top[1], ">=", 0.15),
        ):
            out.append(Check(name, value, relation, bound, on, reasons[on]))
    return tuple(out)


def principal_axis(image):
    """Orientation in degrees and elongation of a bright region by its second moments.

    ``image``: float64 [h, w] intensities. Elongation is the ratio of the standard deviations along and
    across.
    """
    y, x = np.mgrid[0 : image.shape[0], 0 : image.shape[1]]
    total = image.sum()
    dx, dy = x - (image * x).sum() / total, y - (image * y).sum() / total
    xx, xy, yy = ((image * a).sum() / total for a in (dx * dx, dx * dy, dy * dy))
    angle = 0.5 * math.degrees(math.atan2(2.0 * xy, xx - yy))
    root = math.sqrt((xx - yy) ** 2 + 4.0 * xy * xy)
    return angle, math.sqrt((xx + yy + root) / max(xx + yy - root, 1e-12))


def half_maximum_aspect(image, frame, radius):
    """Width ratio of a highlight on a sphere at half its peak, along b over along t, in the tangent plane of
    the peak.

    ``image``: float64 [size, size], bottom row first. ``frame``: unit vectors (tangent, binormal, normal) at
    the peak, in world coordinates. Widths are read off the great circles through the peak, with linear
    interpolation.
    """
    size, widths = image.shape[0], []
    peak_normal, peak = frame[2], None
    for axis in frame[:2]:
        reach = []
        for sign in (1.0, -1.0):
            angle = np.radians(np.arange(0.0, 89.0, 0.1))
            points = np.cos(angle)[:, None] * peak_normal + sign * np.sin(angle)[:, None] * axis
            points = points[points[:, 2] > 0.0]
            x, y = ((points[:, k] * radius + 1.0) * (0.5 * size) - 0.5 for k in (0, 1))
            i, j = np.floor(x).astype(int), np.floor(y).astype(int)
            a, b = x - i, y - j
            profile = (image[j, i] * (1 - a) + image[j, i + 1] * a) * (1 - b) + (
                image[j + 1, i] * (1 - a) + image[j + 1, i + 1] * a
            ) * b
            peak = profile[0] if peak is None else peak
            below = int(np.argmax(profile < 0.5 * peak))
            if below == 0:
                return math.nan
            f = (profile[below - 1] - 0.5 * peak) / (profile[below - 1] - profile[below])
            reach.append(math.sin(angle[below - 1] + f * (angle[below] - angle[below - 1])))
        widths.append(sum(reach))
    return widths[1] / widths[0]


def brushed_spheres_checks(figure, renderer):
    """Orientation, elongation and aspect of the two spheres' highlights."""
    size, out = 512, []
    parameters = dict(figure.parameters)
    dark = {"diffuse": (0.0, 0.0, 0.0), "ambient": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0)}
    parameters |= {**dark, "specular": (1.0, 1.0, 1.0)}
    for on in ("ideal", "machine"):
        image = getattr(renderer, on)(scenes.brushed_spheres_scene, 2, size, **parameters)[..., 0]
        (left, long_left), (right, long_right) = (
            principal_axis(image[:, k * size : (k + 1) * size]) for k in (0, 1)
        )
        turn = abs(left - right) % 180.0
        reason = "the catalogue's acceptance" + (
            "; moments of the whole highlight average the 9-bit steps" if on == "machine" else ""
        )
        across = (
            "highlights lie across the strokes, at 90 degrees to meridians and parallels; the sphere's "
            "curvature and the tilt of its axis turn them by a few degrees"
        )
        out += [
            Check(
                "highlight orientations differ by 90 degrees, deviation",
                abs(turn - 90.0),
                "<=",
                5.0,
                on,
                reason,
            ),
            Check(
                "angle of the highlight to the horizontal, longitudinal brushing, degrees",
                abs(left),
                "<=",
                15.0,
                on,
                across,
            ),
            Check(
                "angle of the highlight to the vertical, latitudinal brushing, degrees",
                90.0 - abs(right),
                "<=",
                15.0,
                on,
                across,
            ),
            Check("elongation of the highlight, longitudinal brushing", long_left, ">=", 2.5, on, reason),
            Check("elongation of the highlight, latitudinal brushing", long_right, ">=", 2.5, on, reason),
        ]
    parameters |= {"spread": 0.0, "depth": 0.0, "k_s": (1.0, 1.0), "slices": 200, "stacks": 101}
    image = renderer.ideal(scenes.brushed_spheres_scene, 2, size, **parameters)[:, size:, 0]
    half = normalize(normalize(np.array(parameters["light"])) + np.array([0.0, 0.0, 1.0]))
    axis = rotate(rotation("x", parameters["tilt"]), np.array([0.0, 1.0, 0.0]))
    east = normalize(cross(axis, half))
    aspect = half_maximum_aspect(image, (east, cross(half, east), half), parameters["radius"])
    expected = parameters["alpha_y"] / parameters["alpha_x"]
    out.append(
        Check(
            "aspect at half maximum over alpha_y / alpha_x, relative deviation",
            abs(aspect / expected - 1.0),
            "<=",
            0.1,
            "ideal",
            "the catalogue's acceptance; smooth brushing and 200 slices, so that only Eq. 1 is measured",
        )
    )
    return tuple(out)


_NO_DIFFUSE = {"diffuse": (0.0, 0.0, 0.0), "ambient": (0.0, 0.0, 0.0), "background": (0.0, 0.0, 0.0)}


def _arithmetic_check(renderer, figure, bound, reason):
    """The machine's picture against the free ideal's: RMS over the framebuffer at half the figure's size."""
    arguments = figure.scene, figure.columns, figure.size // 2
    machine = renderer.machine(*arguments, **figure.parameters)
    ideal = np.clip(renderer.ideal(*arguments, **figure.parameters), 0.0, 1.0)
    return Check("RMS of machine - ideal", _rms(machine - ideal), "<=", bound, "machine", reason)


def gloss_checks(figure, renderer):
    """The highlight under the gloss map is the plain one times k_s."""
    size = 256
    parameters = {**figure.parameters, **_NO_DIFFUSE}
    image = renderer.ideal(scenes.gloss_scene, 2, size, **parameters)[..., 0]
    plain, glossy = image[:, :size], image[:, size:]
    ratio = glossy[plain > 0.05] / plain[plain > 0.05]
    exact = "float64: a product; the factor is between the two k_s everywhere and reaches both"
    return (
        Check(
            "smallest ratio of highlights - k_s of dull checks",
            abs(ratio.min() - parameters["dull"]),
            "<=",
            1e-9,
            "ideal",
            exact,
        ),
        Check(
            "largest ratio of highlights - k_s of polished checks",
            abs(ratio.max() - parameters["polished"]),
            "<=",
            1e-9,
            "ideal",
            exact,
        ),
        _arithmetic_check(renderer, figure, 0.0075, _POWER_8),
    )


_POWER_8 = (
    "8-bit normals and vectors leave n.h within about one byte, which the eighth power multiplies by eight "
    "near one; measured at the first correct picture, with at most a third of slack"
)


def frames_checks(figure, renderer):
    """Both frames give the same picture."""
    size, out = 256, []
    for on, bound, reason in (
        (
            "ideal",
            0.0008,
            "interpolating a halfway vector over 7 degrees of turning frames; zero for infinitely many "
            "triangles",
        ),
        ("machine", 0.0085, "the two frames round different components to bytes: twice the pass's own error"),
    ):
        image = getattr(renderer, on)(scenes.frames_scene, 2, size, **figure.parameters)
        difference_of_frames = np.clip(image[:, :size], 0.0, 1.0) - np.clip(image[:, size:], 0.0, 1.0)
        out.append(Check("RMS of local - global frame", _rms(difference_of_frames), "<=", bound, on, reason))
    return tuple(out)


def normalization_checks(figure, renderer):
    """A flat square under a close light: the cube map gives (n.l)+, the vertex colours far less in the
    middle.
    """
    size, out = 256, []
    parameters = {
        **figure.parameters,
        **_NO_DIFFUSE,
        "depth": 0.0,
        "specular": (0.0, 0.0, 0.0),
        "diffuse": (1.0, 1.0, 1.0),
    }
    x, y = pixel_grid(size, 1.0 / 1.06)
    inside = np.maximum(np.abs(x), np.abs(y)) < 0.98
    to_light = normalize(np.array(parameters["light"]) - np.stack([x, y, np.zeros_like(x)], axis=-1))
    true = brdfs.lambert(np.array([0.0, 0.0, 1.0]), to_light)
    for on, bound, reason in (
        ("ideal", 0.0008, "linear filtering between a 64-texel cube map's unit vectors"),
        ("machine", 0.007, "a byte of the cube map and one of the normal: two half steps of 2/255"),
    ):
        image = getattr(renderer, on)(scenes.normalization_scene, 2, size, **parameters)[..., 0]
        error = (image[:, size:] - true)[inside]
        out += [
            Check("RMS of (n.l)+ with the cube map - Lambert's law", _rms(error), "<=", bound, on, reason),
            Check(
                "(n.l)+ below the light with vertex colours, of a true value of one",
                float(image[size // 2, size // 2]),
                "<=",
                0.5,
                on,
                "four unit vectors at the corners of the square sum to 0.44 in its middle",
            ),
        ]
    return tuple(out)


def longest_row(mask):
    """The greatest number of true pixels side by side in one row of a bool image [h, w]."""
    beyond = np.pad(~mask, ((0, 0), (1, 1)), constant_values=True)
    return max(int(np.diff(np.flatnonzero(row)).max()) - 1 for row in beyond)


def dot_product_checks(figure, renderer):
    """That every pebble of the torus has a highlight of its own, and the torus against the ideal."""
    size = figure.size // 2
    image = renderer.machine(figure.scene, figure.columns, size, **figure.parameters)
    # Five beds of pebbles lie round the circle of tube centres, of radius 0.7; 2.2 units fill the picture.
    pebble = 2.0 * math.pi * 0.7 / (5 * figure.parameters["cells"]) * size / 2.2
    return (
        Check(
            "longest row of pixels brighter than 0.7, in widths of a pebble",
            longest_row(image.mean(axis=-1) > 0.7) / pebble,
            "<=",
            1.35,
            "machine",
            "a highlight ends with its pebble; measured at the first correct picture, a third of slack "
            "(pebbles of an eighth of this depth are lost in a glare 3.4 pebbles long)",
        ),
        _arithmetic_check(renderer, figure, 0.0083, _POWER_8),
    )

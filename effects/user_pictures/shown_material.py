"""A mesh of one material, of any reflectance, under lights or in an environment, on any machine.

The reflectance is a row of ``reflectance.brdfs.BRDFS`` or a file (``factored_brdf``). Its factors are drawn
once for each light. Copies add the pictures of several lights up. Each picture but the last is drawn over
black, the sum of the earlier ones is added, and the window becomes a texture with the new sum. The background
behind the mesh comes before the last.

An environment becomes as many directional lights (``environment_lights``), and is also the backdrop.

Source: Heidrich 2001, section 1.1.2 (H17 and H18 of the catalogue).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fixedpipe.effects.environment_maps import bumped_reflections, environments
from fixedpipe.effects.environment_maps.environment_lights import lights_of
from fixedpipe.effects.geometry import surfaces
from fixedpipe.effects.geometry.matrices import rotation
from fixedpipe.effects.geometry.vectors import cross, dot, in_frame, normalize, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, Panel, perspective_view
from fixedpipe.effects.passes.draws import ADD, FIRST_PASS, REPLACE, draw
from fixedpipe.effects.reflectance import dependent_lookups, factored_passes
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.reflectance.hemisphere_maps import AnalyticBRDF, Halves
from fixedpipe.effects.reflectance.separable_factors import MOST_TERMS, SeparableFactors
from fixedpipe.effects.refusal import Refusal, nearest
from fixedpipe.effects.scenes.teapot import teapot
from fixedpipe.effects.user_pictures import factored_brdf, probes
from fixedpipe.effects.user_pictures.bumped_mesh import EYE, fitted
from fixedpipe.effects.user_pictures.drawing import Drawing
from fixedpipe.effects.user_pictures.factored_brdf import Factored, Factorisation
from fixedpipe.pipeline.profiles import IDEAL, PROFILES
from fixedpipe.pipeline.validation.validate import validate

MESHES = ("plane", "sphere", "torus", "teapot")
ROOM = "room"
# Texels along an edge of the cube map that becomes lights.  Assumed: three degrees are finer than the
# distances of up to 64 lights.
_LIGHT_TEXELS = 32
MOST_LIGHTS = 64
FIELD_OF_VIEW = 36.0


# ---------------------------------------------------------------------------------------- what is given


def mesh(name):
    """One of ``MESHES`` as a Surface. Raises ValueError for an unknown name."""
    if name == "plane":
        return surfaces.plane(32, 32)
    if name == "sphere":
        return surfaces.sphere(96, 48)
    if name == "torus":
        return surfaces.torus(96, 48).rotated(rotation("x", 40.0))
    if name == "teapot":
        return teapot(8)
    raise ValueError(
        f"There is no mesh {name!r}.{nearest(name, MESHES)} Give one of {', '.join(MESHES)}, or an OBJ or a "
        "PLY file."
    )


def _numbers(value):
    return value if isinstance(value, tuple) else (value,)


def _words(value):
    return ",".join(f"{number:g}" for number in _numbers(value))


def listed():
    """What ``--list`` says: a text of the models of ``BRDFS`` and their parameters."""
    lines = []
    for name, row in BRDFS.items():
        lines.append(f"{name}: {row.title}. {row.equation}")
        lines += [
            f"    {p.name}={_words(p.default)}, from {_words(p.low)} to {_words(p.high)}: {p.meaning}"
            for p in row.parameters
        ]
    return "\n".join(lines)


def _value(parameter, text, title):
    """The value of a model's parameter from its text. Raises ValueError."""
    low, high = _numbers(parameter.low), _numbers(parameter.high)
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != len(low) or not all(
        a <= number <= b for a, number, b in zip(low, numbers, high, strict=True)
    ):
        count = "a number" if len(low) == 1 else f"{len(low)} numbers"
        raise ValueError(
            f"{title}'s {parameter.name} is {text!r}; give {count} from {_words(parameter.low)} to "
            f"{_words(parameter.high)}."
        )
    return numbers if isinstance(parameter.default, tuple) else numbers[0]


def reflectance(name, settings=None):
    """The BRDF of a name of ``BRDFS`` or of a file, an object with ``at``.

    settings  texts by name: a model's parameters that are not to have their default

    Raises ValueError (Refusal) for anything else, for parameters that the model lacks, for values out of
    range, and for any parameter of a file.
    """
    settings = dict(settings or {})
    if name not in BRDFS:
        if not Path(name).suffix and not Path(name).exists():
            raise Refusal(
                f"There is no reflectance {name!r}.{nearest(name, BRDFS)} Give one of {', '.join(BRDFS)}; a "
                "MERL table, FILE.binary; or FILE.npz of fixedpipe brdf."
            )
        if settings:
            raise Refusal(
                f"{name} is a file, which has no parameter {', '.join(settings)}; leave --set out, or give "
                f"one of {', '.join(BRDFS)}."
            )
        return factored_brdf.read(name)
    row = BRDFS[name]
    there = {p.name: p for p in row.parameters}
    for each in settings:
        if each not in there:
            raise ValueError(
                f"{row.title} has no parameter {each!r}.{nearest(each, there)} It has "
                f"{', '.join(there) or 'none'}."
            )
    values = {each: _value(there[each], text, row.title) for each, text in settings.items()}
    return AnalyticBRDF(row, values)


def factored(brdf, terms=None, way=None):
    """The Factored of a BRDF by the way of the smallest error.

    terms  None: of all three ways, separable factors with two terms; a number: of the two separable ways,
           with so many
    way    the Factorisation to take instead of the best one

    Raises ValueError for a number of terms that is not from 1 to 8, or for terms of a homomorphic product.
    """
    if terms is None:
        return factored_brdf.factored(brdf, way)
    if isinstance(terms, bool) or not 1 <= terms <= MOST_TERMS:
        raise ValueError(f"{terms} terms are asked for; give 1 to {MOST_TERMS}.")
    if way is Factorisation.HOMOMORPHIC:
        raise ValueError("A homomorphic product has no terms; leave them out, or take another way.")
    if way is not None:
        return factored_brdf.factored(brdf, way, terms=terms)
    found = [
        factored_brdf.factored(brdf, way, terms=terms)
        for way in (Factorisation.HALFWAY, Factorisation.DIRECTIONS)
    ]
    return min(found, key=lambda each: each.error)


@dataclass(frozen=True, eq=False)
class Lighting:
    """What a mesh is lit by.

    directions  float64 [n, 3], towards the lights
    colors      float64 [n, 3]: the light that a white surface facing each of them sends back, with the
                exposure
    behind      directions [..., 3] to the backdrop's RGB in [0, 1]; None: a dark ground
    exposure    by what both were multiplied
    """

    directions: np.ndarray
    colors: np.ndarray
    behind: Callable | None
    exposure: float


def _checked_exposure(exposure):
    if exposure is not None and not 0.0 < exposure < float("inf"):
        raise ValueError(f"The exposure is {exposure:g}; give a positive number.")
    return exposure


def directional(directions, exposure=None):
    """The Lighting of white directional lights of intensity one. Raises ValueError for what is none."""
    exposure = _checked_exposure(exposure) or 1.0
    towards = np.array([unit_vector(each, "The light's direction") for each in directions])
    if not 1 <= len(towards) <= MOST_LIGHTS:
        raise ValueError(f"{len(towards)} lights are given; give 1 to {MOST_LIGHTS}.")
    return Lighting(towards, np.full(towards.shape, exposure), None, exposure)


def environment(name, count=16, exposure=None, layout=None):
    """The Lighting of an environment: ``room``, or a file of ``probes.probe``.

    count     of lights; fewer where fewer texels shine
    exposure  None: one where bytes hold all, else so that 99.5 % of the environment are below one
    layout    of the file's picture, as for ``probes.probe``

    Raises ValueError (Refusal) for anything else, and for a black environment.
    """
    exposure = _checked_exposure(exposure)
    if not 1 <= count <= MOST_LIGHTS:
        raise ValueError(f"{count} lights are asked for; give 1 to {MOST_LIGHTS}.")
    if name == ROOM:
        radiance, cube = environments.room, environments.faces(_LIGHT_TEXELS)
    else:
        found = probes.probe(name, layout)
        radiance, cube = found.radiance, probes.maps(found, "cube", _LIGHT_TEXELS)
    exposure = exposure or probes.exposure_of(cube)
    lights = lights_of(cube, count)

    def behind(toward):
        return np.clip(exposure * radiance(toward), 0.0, 1.0)

    return Lighting(lights.directions, exposure * lights.irradiance, behind, exposure)


# --------------------------------------------------------------------------------------------- commands


def _backdrop(lighting, view, profile):
    """Commands that clear the panel and show what is behind the mesh."""
    ground = (view.panel.clear(BACKGROUND),)
    if lighting.behind is None:
        return ground
    # Texels as fine as pixels, where the machine holds so many.
    edge = max(view.panel.width, view.panel.height)
    texels = min(1 << (edge - 1).bit_length(), profile.textures.max_texture_size)
    return (
        *ground,
        *bumped_reflections.picture_backdrop(view, max(texels, 2), profile, lighting.behind),
    )


def _colors_of(lighting, color):
    """The lights' colours times the material's: float64 [n, 3]. Raises ValueError."""
    color = np.asarray(color, np.float64)
    if color.shape != (3,) or not ((color >= 0.0) & (color <= 1.0)).all() or not color.any():
        raise ValueError(
            f"The colour is {_words(tuple(color.ravel()))}; give red, green and blue from 0 to 1, not all 0."
        )
    colors = lighting.colors * color
    if not colors.any():
        raise ValueError("The lights have nothing of the colour; give a colour that they have a part of.")
    return colors


def check_picture(lighting, profile, width, height, color=(1.0, 1.0, 1.0)):
    """Raises ValueError for a colour that is none, and for more pixels than a machine can add up several
    lights in.
    """
    _colors_of(lighting, color)
    largest = profile.textures.max_texture_size
    if len(lighting.directions) > 1 and max(width, height) > largest:
        raise ValueError(
            f"The picture has {width}x{height} pixels, and the {profile.name} adds up several lights in a "
            f"texture of at most {largest}x{largest}; give a smaller --size, or one light."
        )


def _viewed(surface, width, height, eye):
    """(the Surface fitted into the view, its View)."""
    surface = fitted(surface, eye)
    radius = float(np.sqrt(dot(surface.positions, surface.positions).max()))
    panel = Panel(0, 0, width, height)
    return surface, perspective_view(panel, eye, field_of_view=FIELD_OF_VIEW, radius=1.05 * radius)


def commands(found, surface, lighting, profile, width, height, *, color=(1.0, 1.0, 1.0), eye=EYE):
    """Everything from factors to passes.

    found     a Factored
    surface   a Surface, fitted into the view; its tangents are the reflectance's first axis
    lighting  a Lighting
    color     RGB in [0, 1], not all zero: the factor of the reflectance

    Raises ValueError as ``check_picture``.
    """
    check_picture(lighting, profile, width, height, color)
    surface, view = _viewed(surface, width, height, eye)
    panel, colors = view.panel, _colors_of(lighting, color)
    brightest = float(colors.max())
    loading, loaded = factored_passes.load(found.factors, "reflectance", profile, intensity=brightest)
    several = len(colors) > 1
    room = (dependent_lookups.load_screen(panel),) if several else ()
    sum_so_far = replace(dependent_lookups.screen_unit(view, 0), environment=REPLACE)
    added = draw(
        "plus the lights so far", surface.mesh(surface.positions), view, None, (sum_so_far,), blending=ADD
    )
    out = [*loading, *room]
    for k, (toward, share) in enumerate(zip(lighting.directions, colors / brightest, strict=True)):
        last = k == len(colors) - 1
        out += _backdrop(lighting, view, profile) if last else (panel.clear((0.0, 0.0, 0.0)),)
        lit = replace(loaded, color=loaded.color * share)
        out += factored_passes.passes(surface, lit, view, Light(tuple(map(float, toward))))
        if k > 0:
            out.append(added)
        if not last:
            out.append(dependent_lookups.copy_screen(view))
    return tuple(out)


def meant(brdf, surface, lighting, width, height, *, color=(1.0, 1.0, 1.0), eye=EYE, threads=None):
    """The Drawing of a BRDF itself, with no factors: the ideal interpolates the surface's frame, and the BRDF
    is evaluated at each pixel, pi f_r (n.l)+ of every light. Arguments as for ``commands``.

    Raises ValueError for a colour that is none.
    """
    from fixedpipe.pipeline.ideal.evaluate import execute_ideal

    colors = _colors_of(lighting, color)
    surface, view = _viewed(surface, width, height, eye)
    reach = float(np.abs(surface.positions).max())

    def at_pixels(values):
        """A vertex's three numbers of [-1, 1] at each pixel, [h, w, 3], and where the mesh is, [h, w]."""
        shown = draw("a vertex's numbers", surface.mesh(colors=0.5 + 0.5 * values), view, None)
        frame = (
            view.panel.clear((0.0, 0.0, 0.0)),
            replace(shown, state=replace(shown.state, depth_test=FIRST_PASS)),
        )
        found = execute_ideal(frame, width, height, threads=threads).color
        return 2.0 * found[..., :3] - 1.0, found[..., 3] > 0.5

    normals, covered = at_pixels(surface.normals)
    normal = normalize(normals[covered])
    tangent = at_pixels(surface.tangents)[0][covered]
    tangent = normalize(tangent - dot(tangent, normal)[:, None] * normal)
    frame = tangent, cross(normal, tangent), normal
    positions = reach * at_pixels(surface.positions / reach)[0][covered]
    toward_eye = in_frame(view.view_vectors(positions), *frame)
    total = np.zeros((len(normal), 3))
    for toward, share in zip(lighting.directions, colors, strict=True):
        light = in_frame(np.broadcast_to(toward, normal.shape), *frame)
        lit = (light[:, 2] > 0.0) & (toward_eye[:, 2] > 0.0)
        total[lit] += math.pi * brdf.at(light[lit], toward_eye[lit]) * light[lit, 2:] * share
    backdrop = execute_ideal(_backdrop(lighting, view, IDEAL), width, height, threads=threads)
    image = backdrop.color.copy()
    image[covered] = np.concatenate([np.clip(total, 0.0, 1.0), np.ones((len(total), 1))], axis=1)
    return Drawing(image, np.rint(255.0 * image).astype(np.uint8), 0, "the reflectance itself at each pixel")


# Chosen: factors that err by more show another material. At 0.83 of the reflectance Phong's highlight of
# exponent 20 is a long ellipse; at 0.13 Blinn and Phong's looks as it should.
MOST_ERROR = 0.3


def doubt_of(name, found):
    """A warning sentence about factors whose error is too large; None: it is not."""
    if found.error <= MOST_ERROR:
        return None
    return (
        f"{name}: the factors err by {found.error:.2g} of the reflectance; above {MOST_ERROR:g} a picture "
        "shows another material. --profile IDEAL draws the reflectance itself. Products of textures hold "
        "highlights about the halfway vector well: try blinn_phong or ward."
    )


def passes_of(frame):
    """How many draws of the mesh and of the backdrop a frame has."""
    return sum(hasattr(command, "mesh") for command in frame)


def said_of(name, found):
    """How a Factored is drawn, and how far it is from its reflectance: a line."""
    terms = 1 if found.way is Factorisation.HOMOMORPHIC else found.factors.terms
    products = f"{terms} term{'s' * (terms > 1)}"
    if found.way is Factorisation.HOMOMORPHIC:
        products = "one product of three maps"
    return (
        f"{name}: {found.way.value}, {products}; RMS error of the factors {found.error:.3g} of the "
        "reflectance's"
    )


def way_of(profile):
    """How a machine draws factors, in words."""
    board = factored_passes.board_of(profile)
    return f"{board.means.value}, {board.storage.value}"


def check_machine(profile):
    """Raises ValueError, with the machines that can, for a machine that cannot draw factors."""
    if not can_draw(profile):
        able = ", ".join(key for key, each in PROFILES.items() if can_draw(each))
        raise ValueError(
            f"The {profile.name} cannot draw products of textures and add them up, which takes blending and "
            f"copies of the framebuffer. Give one of {able}."
        )


def can_draw(profile):
    """Whether a machine can draw factors under several lights: a small frame is validated."""
    size = 16
    maps = np.linspace(-0.5, 1.0, 2 * 4 * 4 * 3).reshape(2, 4, 4, 3)
    found = Factored(SeparableFactors(Halves.LIGHT_AND_VIEW, maps, maps), Factorisation.DIRECTIONS, 0.0)
    lighting = replace(directional(((0.0, 0.0, 1.0), (0.0, 1.0, 1.0))), behind=np.ones_like)
    try:
        validate(commands(found, surfaces.plane(), lighting, profile, size, size), profile, size, size)
    except ValueError:
        return False
    return True

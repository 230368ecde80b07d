"""Bump mapping of a height field on a mesh with an anisotropic material, from arrays to commands.

A photograph or an elevation model becomes a height field, and the height field local frames. The frames and a
material's parameters become a material. Machines with register combiners draw the mesh in two passes (K10,
then K07). Machines with the imaging subset draw it triangle by triangle (K08). Any other machine needs some
fifty passes, for a wide highlight (K22).

Machines with register combiners can antialias it. One way is mip-maps of the stored vectors. The other is
mip-maps whose highlight is as wide as the normals under a texel are rough (K18's ``covariance_fit``). There
Eq. 1's two vectors are the inverse root of alpha^2 + 6 K. K is the covariance (S16) of the normals that
filtering has averaged. So the highlight is a fixed function of |D^-1 d|^2 with D D^T = K + alpha^2 / 6, and a
board without a quotient can draw it (Schilling's appendix A, as erratum E001.6 corrects it).

Source: Kautz, Seidel 2000, sections 4.1, 4.2, 5 and 6 (K07, K08, K10, K18, K21, K22 of the catalogue);
Schilling 1997, section 8 and appendix A.
"""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from enum import StrEnum

import numpy as np

from fixedpipe.effects.bump_mapping import diffuse_bump
from fixedpipe.effects.geometry import height_fields, surfaces
from fixedpipe.effects.geometry.matrices import look_at, rotate, rotation
from fixedpipe.effects.geometry.vectors import dot, unit_vector
from fixedpipe.effects.geometry.views import BACKGROUND, Light, Panel, perspective_view
from fixedpipe.effects.passes.arguments import member_of
from fixedpipe.effects.passes.draws import ADD, MULTIPLY_DESTINATION, REPEATED, REPLACE, draw
from fixedpipe.effects.reflectance import (
    anisotropic_blinn_phong,
    dependent_lookups,
    imaging_subset,
    material_textures,
    plain_multitexturing,
)
from fixedpipe.effects.scenes.teapot import teapot
from fixedpipe.effects.texture_filtering import mipmapped_materials
from fixedpipe.pipeline.enums import TextureFilter
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.validation.validate import validate


class Antialiasing(StrEnum):
    """What takes the place of bumps that are smaller than a pixel.

    NONE       nothing: they flicker
    MIP        mip-maps of the stored vectors, as if they were colours: bumps and bumpiness vanish
    ROUGHNESS  mip-maps whose highlight is wide along the directions that bumps lean in
    """

    NONE = "none"
    MIP = "mip"
    ROUGHNESS = "roughness"


_FILTERS = {
    Antialiasing.MIP: mipmapped_materials.vectors,
    Antialiasing.ROUGHNESS: mipmapped_materials.covariance_fit,
}
_TRILINEAR = replace(REPEATED, min_filter=TextureFilter.LINEAR_MIPMAP_LINEAR)


@dataclass(frozen=True)
class MaterialParameters:
    """A homogeneous material under the bumps.

    ``alpha_x``, ``alpha_y`` in [0.25, 1]: how wide the highlight is along and across the tangents.
    ``diffuse``, ``specular``: RGB in [0, 1]. ``k_s`` in [0, 1]. ``relief``: from the lowest to the highest
    point, in units of the height field's width.
    """

    alpha_x: float
    alpha_y: float
    diffuse: tuple[float, float, float]
    specular: tuple[float, float, float]
    k_s: float
    relief: float

    def __post_init__(self):
        for field in fields(self):
            value, what = np.asarray(getattr(self, field.name), np.float64), f"The material's {field.name}"
            least = material_textures.SMALLEST_ALPHA if field.name.startswith("alpha") else 0.0
            if not (np.isfinite(value).all() and (value >= least).all() and (value <= 1.0).all()):
                raise ValueError(f"{what} is {getattr(self, field.name)}; give numbers from {least:g} to 1.")
            if field.name in ("diffuse", "specular") and value.shape != (3,):
                raise ValueError(f"{what} is {getattr(self, field.name)}; give red, green and blue.")


MATERIALS = {
    "gold": MaterialParameters(0.35, 0.45, (0.42, 0.26, 0.07), (1.0, 0.80, 0.38), 0.95, 0.04),
    "steel": MaterialParameters(0.30, 0.40, (0.28, 0.30, 0.34), (0.92, 0.96, 1.0), 0.90, 0.03),
    "brushed": MaterialParameters(0.25, 0.90, (0.24, 0.24, 0.25), (0.95, 0.95, 1.0), 0.80, 0.03),
    "stone": MaterialParameters(0.85, 0.85, (0.72, 0.68, 0.62), (1.0, 1.0, 1.0), 0.10, 0.05),
    "plastic": MaterialParameters(0.27, 0.27, (0.62, 0.08, 0.07), (1.0, 1.0, 1.0), 0.55, 0.04),
}

# How often the height field repeats along s and t: so that a repeat is about as wide as high on the mesh.
_REPEATS = {"plane": (1, 1), "sphere": (2, 1), "torus": (2, 1), "teapot": (1, 1)}
MESHES = tuple(_REPEATS)
# Where the viewer is; the mesh reaches one from the origin.
EYE = (0.0, 1.0, 3.6)


def mesh(name):
    """One of the built-in meshes by name, with the texture repeated so that bumps are about as wide as high.

    On the round ones the height field's edges meet at the sides, where they are seen least, and not in front.
    Raises ValueError for an unknown name.
    """
    if name not in _REPEATS:
        raise ValueError(
            f"There is no mesh {name!r}; give one of {', '.join(MESHES)}, or an OBJ or a PLY file."
        )
    if name == "plane":
        surface = surfaces.plane(32, 32)
    elif name == "sphere":
        surface = surfaces.sphere(96, 48)
    elif name == "teapot":
        surface = teapot(8)
    else:
        surface = surfaces.torus(96, 48).rotated(rotation("x", 40.0))
    surface = surface.with_repeats(*_REPEATS[name])
    if name in ("plane", "teapot"):
        return surface
    return replace(surface, texture_coordinates=surface.texture_coordinates + np.array([0.5, 0.0]))


def material(name):
    """One of ``MATERIALS`` by name. Raises ValueError for an unknown name."""
    if name not in MATERIALS:
        raise ValueError(f"There is no material {name!r}; give one of {', '.join(MATERIALS)}.")
    return MATERIALS[name]


def _power_of_two(edge, largest):
    return min(1 << max(edge - 1, 0).bit_length(), largest)


def map_edges(shape, profile, map_size=None):
    """Rows and columns of the map that heights of a shape [rows, columns] become, as for ``material_map``."""
    if map_size is None:
        largest = min(512, profile.textures.max_texture_size)
        return tuple(max(4, _power_of_two(edge, largest)) for edge in shape)
    if map_size < 4 or map_size & (map_size - 1) or map_size > profile.textures.max_texture_size:
        raise ValueError(
            f"The map's size is {map_size}; give a power of two from 4 to "
            f"{profile.textures.max_texture_size} "
            f"({profile.name} allows no larger texture)."
        )
    return map_size, map_size


def material_map(image, parameters, profile, map_size=None, *, repeated=True):
    """A photograph or elevation array as ``material_textures.Material``.

    Parameters
    ----------
    image
        [rows, columns(, components)], top row first, any numeric type (``height_fields.from_image``).
    parameters
        MaterialParameters.
    profile
        The machine: the map's edges are powers of two and at most its ``max_texture_size``.
    map_size
        Texels along both edges, a power of two from 4 on; None: the image's own size, rounded up, at most
        512.
    repeated
        Whether the map repeats on the surface; its edges are then faded into each other.
    """
    heights = height_fields.from_image(image)
    if repeated:
        heights = height_fields.tileable(heights)
    rows, columns = map_edges(heights.shape, profile, map_size)
    heights = height_fields.smooth(height_fields.resample(heights, columns, rows), periodic=repeated)
    slope_s, slope_t = height_fields.slopes(heights * parameters.relief, periodic=repeated)
    return material_textures.from_slopes(
        slope_s, slope_t, parameters.alpha_x, parameters.alpha_y, parameters.k_s
    )


def fitted(surface, eye):
    """The surface centred and scaled so that, seen from ``eye`` at a great distance, it fills [-1, 1].

    Raises ValueError when it has no extent.
    """
    low, high = surface.positions.min(axis=0), surface.positions.max(axis=0)
    centered = surface.positions - (low + high) / 2
    across = rotate(np.array(look_at(eye, (0.0, 0.0, 0.0)))[:2, :3], centered)
    reach = float(np.abs(across).max())
    if reach == 0.0:
        raise ValueError("The mesh has no extent across the view; all its vertices lie on one line of sight.")
    return replace(surface, positions=centered / reach)


def _by_combiners(surface, material, view, light, profile, parameters, ambient, antialias=Antialiasing.NONE):
    if antialias is Antialiasing.NONE:
        (loading, names), sampler = material_textures.load(material, "material", profile), REPEATED
    else:
        levels = _FILTERS[antialias](material)
        (loading, names), sampler = mipmapped_materials.load(levels, "material", profile), _TRILINEAR
    color, specular = parameters.diffuse, parameters.specular
    return (
        *loading,
        *diffuse_bump.diffuse_pass(
            surface, names.normal, view, light, profile, color=color, ambient=ambient, sampler=sampler
        ),
        *anisotropic_blinn_phong.specular_pass(
            surface, names, view, light, profile, specular=specular, sampler=sampler
        ),
    )


# Triangles that face the viewer. Assumed: each is loaded three times; so many take a minute or two.
_MOST_FLAT_TRIANGLES = 20_000


def _by_imaging_subset(surface, material, view, light, profile, parameters, ambient):
    faces = imaging_subset.polygons(surface)
    seen = int(imaging_subset.facing(faces, view).sum())
    if seen > _MOST_FLAT_TRIANGLES:
        raise ValueError(
            f"The mesh has {seen} triangles in front, and the {profile.name} loads each by itself, up to "
            f"{_MOST_FLAT_TRIANGLES}; make it coarser, or give a machine with register combiners: "
            f"{', '.join(machines_with(WAYS[0]))}."
        )
    return imaging_subset.commands(
        surface,
        material,
        view,
        light,
        profile,
        color=parameters.diffuse,
        ambient=ambient,
        specular=parameters.specular,
    )


# Sums of unsigned products are kept over 4 (``plain_multitexturing.signed_passes``).
_LARGEST_FORM = plain_multitexturing.LARGEST


def _by_unsigned_environments(surface, material, view, light, profile, parameters, ambient):
    """The highlight first, which is kept as a texture while the diffuse term needs the framebuffer."""
    largest = parameters.alpha_x**-2 + parameters.alpha_y**-2
    if largest > _LARGEST_FORM:
        raise ValueError(
            f"The highlight is too narrow for the {profile.name}, whose textures have no sign. Give "
            f"--alpha-x and --alpha-y of {(2.0 / _LARGEST_FORM) ** 0.5:.2f} or more, the material stone, or "
            f"one of {', '.join(machines_with(*WAYS[:2]))}."
        )
    loading, names = plain_multitexturing.load(material, "material", profile)
    loading_normals, normals = plain_multitexturing.load_normals(material.normals, "material", profile)
    lit = np.maximum(0.0, surface.to_local(light.light_vectors(surface.positions))[:, 2:])
    gate = surface.mesh(colors=np.repeat(np.minimum(1.0, 4.0 * lit), 3, axis=1))
    highlight = replace(dependent_lookups.screen_unit(view, 0), environment=REPLACE)
    passes = view, light, profile
    return (
        *loading,
        *loading_normals,
        dependent_lookups.load_screen(view.panel),
        *plain_multitexturing.signed_passes(surface, names, *passes, specular=parameters.specular),
        draw("times min(1, 4 (n.l)+) of the vertices", gate, view, None, blending=MULTIPLY_DESTINATION),
        dependent_lookups.copy_screen(view),
        *plain_multitexturing.bumped_diffuse_passes(
            surface, normals, *passes, color=parameters.diffuse, ambient=ambient
        ),
        draw("plus the highlight", surface.mesh(surface.positions), view, None, (highlight,), blending=ADD),
    )


@dataclass(frozen=True)
class BumpMapping:
    """One of the ways in which a machine draws a bumped mesh.

    title        in a few words, with the catalogue's ids
    draw         (surface, Material, view, light, profile, parameters, ambient) -> commands
    needs        the features that a machine needs, in words
    antialiased  whether ``draw`` takes ``antialias``, one of Antialiasing, as well
    """

    title: str
    draw: Callable
    needs: str
    antialiased: bool = False


# The best that a machine has is taken.
WAYS = (
    BumpMapping(
        "register combiners (K10, K07)",
        _by_combiners,
        "two general combiners and two texture units",
        antialiased=True,
    ),
    BumpMapping(
        "imaging subset, flat triangles (K08)", _by_imaging_subset, "a colour matrix with colour tables"
    ),
    BumpMapping(
        "plain multitexturing, unsigned halves of signed products (K22)",
        _by_unsigned_environments,
        "texture environments and copies of the framebuffer",
    ),
)


def can_draw(way, profile):
    """Whether a machine can draw by one of WAYS: its passes are validated for a small picture of a square."""
    size, hills = 16, np.arange(16.0).reshape(4, 4)
    try:
        frame = _commands(
            way, hills, surfaces.plane(), material("stone"), (0.0, 0.0, 1.0), profile, size, size
        )
        validate(frame, profile, size, size)
    except ValueError:
        return False
    return True


def machines_with(*ways):
    """Keys in ``fixedpipe.pipeline.profiles.PROFILES`` of the machines that can draw by these WAYS; none: by
    any.
    """
    return tuple(k for k, p in PROFILES.items() if any(can_draw(way, p) for way in ways or WAYS))


def way_of(profile):
    """The first of WAYS by which a machine can draw. Raises ValueError, with the machines that can, where it
    can by none.
    """
    for way in WAYS:
        if can_draw(way, profile):
            return way
    raise ValueError(
        f"The {profile.name} cannot draw bumps with a highlight, which takes "
        f"{', or '.join(way.needs for way in WAYS)}. Give one of {', '.join(machines_with())}."
    )


def commands(
    image,
    surface,
    parameters,
    light,
    profile,
    width,
    height,
    *,
    background=BACKGROUND,
    map_size=None,
    eye=EYE,
    antialias=Antialiasing.NONE,
):
    """Everything from the height field's picture to the passes, by the way of the machine (``way_of``).

    Parameters ---------- image The photograph or elevation array, top row first. surface A ``Surface``: of
    ``mesh``, ``triangle_meshes.read_obj`` or ``triangle_meshes.from_triangles``; fitted into the view.
    parameters MaterialParameters, or the name of one of ``MATERIALS``. light Direction to the light, three
    numbers: +x right, +y up, +z towards the viewer. profile, width, height The machine, and the framebuffer's
    size in pixels. background RGB in [0, 1]. map_size Texels along the material textures' edges, or None
    (``material_map``). eye The viewer's position; the surface lies round the origin and is about two units
    wide. antialias How bumps smaller than a pixel are filtered; all but NONE need register combiners.

    Raises ValueError for invalid arguments, and for a machine that can draw by none of WAYS, or not
    antialiased.
    """
    antialias = member_of(Antialiasing, antialias, "The antialiasing")
    way = way_of(profile)
    if antialias is not Antialiasing.NONE and not way.antialiased:
        able = machines_with(*(way for way in WAYS if way.antialiased))
        raise ValueError(
            f"The {profile.name} draws bumps by {way.title}, which has no mip-maps of a material. Leave "
            f"the antialiasing none, or give one of {', '.join(able)}."
        )
    return _commands(
        way, image, surface, parameters, light, profile, width, height,
        background=background, map_size=map_size, eye=eye, antialias=antialias,
    )  # fmt: skip


def _commands(
    way, image, surface, parameters, light, profile, width, height, *,
    background=BACKGROUND, map_size=None, eye=EYE, antialias=Antialiasing.NONE,
):  # fmt: skip
    parameters = material(parameters) if isinstance(parameters, str) else parameters
    panel = Panel(0, 0, width, height)
    toward = tuple(float(c) for c in unit_vector(light, "The light's direction"))
    lit = Light(toward)
    # The field of view is vertical; on a tall picture it grows so that the sides stay in view.
    field_of_view = 36.0 if width >= height else min(36.0 * height / width, 120.0)
    surface = fitted(surface, eye)
    radius = float(np.sqrt(dot(surface.positions, surface.positions).max()))
    view = perspective_view(panel, eye, field_of_view=field_of_view, radius=1.05 * radius)
    repeated = bool(np.ptp(surface.texture_coordinates, axis=0).max() > 1.0)
    maps = material_map(image, parameters, profile, map_size, repeated=repeated)
    ambient = tuple(0.12 * c for c in parameters.diffuse)
    told = {"antialias": antialias} if way.antialiased else {}
    drawn = way.draw(surface, maps, view, lit, profile, parameters, ambient, **told)
    return (panel.clear(background), *drawn)

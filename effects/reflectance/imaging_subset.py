"""K08, Eq. 1 by the imaging subset, and K10 by the same means: dot products while a texture is loaded.

Eq. 1: L_o = k_s (1 - (h.t/alpha_x)^2 - (h.b/alpha_y)^2)+. A colour matrix is constant while an image goes
through it, so one halfway vector serves a whole polygon. Polygons are flat and lights directional; the viewer
is orthographic, or taken as such over a polygon. In every frame the host loads, for every polygon, the part
of the material images that the polygon reads. Only sums remain to compute per fragment.

The paper's passes, for every polygon that faces the viewer:

1. The image of t/alpha_x is loaded through a colour matrix that undoes the image's scale and bias and gives
   h.t/alpha_x, and a colour table that squares. The polygon is drawn with it, REPLACE.
2. The same with b/alpha_y, added: blending ONE, ONE. The framebuffer's clamp at one does no harm.
3. A white polygon, FUNC_SUBTRACT with ONE, ONE: one minus the framebuffer.

The project's choices:

- A colour matrix keeps no signed results (the paper's section 5), so its output is (1 + d)/2 and the table
  holds (2 i - 1)^2 (erratum E004.9). |d| > 1 clamps to a square of one, where Eq. 1 is zero anyway.
- The host keeps its images as floats; the resulting texture has eight bits (erratum E004.10). So alpha has no
  smallest value here, except the one at which floats end.
- The halfway vector is the one at the polygon's centre, in the frame of the flat polygon.
- Passes that load nothing for a polygon are drawn once for all polygons. They are the white one; the maximum
  with black, which computes (.)+ and changes nothing in a framebuffer without negative numbers (as in K12);
  and k_s times the specular colour, a texture of its own, with DST_COLOR, ZERO.
- K10 comes last. Its colour table gives diffuse colour times (n.l)+ plus ambient in RGB and the gate min(1, 4
  (n.l)+) in alpha. With ONE, SRC_ALPHA the pass adds the RGB, and multiplies the specular passes' result by
  the gate. No pass needs a number above one or below zero, or a second destination. If a colour map
  multiplies the diffuse light, destination alpha stores (n.l)+ until then.

Here texels are squared before any filter; register combiners filter vectors and then square.

Source: Kautz, Seidel 2000, sections 4.2 and 5 (K08, K10 of the catalogue; pass sequence A-K08, and A-H45
for diffuse light); OpenGL 1.2.1 section 3.6.
"""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.geometry.vectors import cross, dot, in_frame, normalize
from fixedpipe.effects.geometry.views import View
from fixedpipe.effects.passes.arguments import checked_rgb
from fixedpipe.effects.passes.draws import (
    ADD,
    ADD_GATED,
    AT_LEAST_ZERO,
    FIRST_PASS,
    LATER_PASS,
    MODULATE,
    MULTIPLY_DESTINATION,
    REPEATED,
    REPLACE,
    SUBTRACT_FROM_SOURCE,
    draw,
)
from fixedpipe.effects.passes.encoding import factor_texels
from fixedpipe.effects.passes.host_images import HostImage, dot_product_transfer
from fixedpipe.effects.technique import Technique, Variant
from fixedpipe.pipeline.commands import Mesh, TexImage
from fixedpipe.pipeline.enums import BaseFormat, BlendFactor, InternalFormat, TextureFilter, WrapMode
from fixedpipe.pipeline.pixel_transfer import PixelImage
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import Blending, ColorMask, ColorTable, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d

TECHNIQUES = (
    Technique("K08", "Eq. 1 by the imaging subset: the colour matrix makes the dot products", "4.2"),
    Variant(("K10",), "by the imaging subset"),
)

# Assumed: entries of a colour table; any machine with one holds so many. 256 would cost |d| / 255 of accuracy
# in d^2, as much as the byte that it is stored in; the exact machine has its longest table.
TABLE_ENTRIES = 1024
# How far beyond a polygon's own coordinates its texels are loaded, in texels: iterated coordinates are not
# exact.  Assumed: a filter's smallest step.
_MARGIN = 1.0 / 256.0

# Source plus destination times the source's alpha: the diffuse term, and the gate for what is there.
ADD_AND_GATE = Blending(BlendFactor.ONE, BlendFactor.SRC_ALPHA)

# The destination times the source.
MULTIPLY_BY_SOURCE = Blending(BlendFactor.ZERO, BlendFactor.SRC_COLOR)


# ---------------------------------------------------------------------------------------- flat polygons


@dataclass(frozen=True, eq=False)
class Polygons:
    """A surface's flat polygons, each with one frame.

    corners              int64 [p, 3 m], the vertices of the m triangles of each
    centers              float64 [p, 3], the mean of a polygon's corners, world coordinates
    normals, tangents, binormals
                         float64 [p, 3], orthonormal: the normal is the polygon's plane's
    """

    corners: np.ndarray
    centers: np.ndarray
    normals: np.ndarray
    tangents: np.ndarray
    binormals: np.ndarray

    def part(self, which):
        """The polygons that a bool array or an array of numbers chooses."""
        return Polygons(**{name: array[which] for name, array in vars(self).items()})

    def to_local(self, vectors):
        """World vectors [p, 3] in the polygons' frames: float64 [p, 3]."""
        return in_frame(vectors, self.tangents, self.binormals, self.normals)


def _mean(values):
    """The mean over axis 1, added up in order."""
    total = values[:, 0]
    for k in range(1, values.shape[1]):
        total = total + values[:, k]
    return total / float(values.shape[1])


def polygons(surface, triangles=1):
    """Every ``triangles`` consecutive triangles of a surface as one flat polygon: Polygons.

    The normal is the first triangle's; the tangent is the mean of the vertices', made perpendicular to it.
    Triangles without an area are not polygons. Raises ValueError if the triangles do not divide evenly.
    """
    count = len(surface.triangles)
    if triangles < 1 or count % triangles:
        raise ValueError(
            f"Polygons of {triangles} triangles cannot be made of the surface's {count}; give a divisor of "
            f"{count}, 1 for instance."
        )
    corners = surface.triangles.reshape(-1, 3 * triangles)
    points = surface.positions[corners]
    across = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    kept = dot(across, across) > 0.0
    corners, normals = corners[kept], normalize(across[kept])
    tangents = _mean(surface.tangents[corners])
    tangents = normalize(tangents - dot(tangents, normals)[:, None] * normals)
    binormals = cross(normals, tangents)
    mirrored = dot(binormals, _mean(surface.binormals[corners])) < 0.0
    binormals = np.where(mirrored[:, None], -binormals, binormals)
    return Polygons(corners, _mean(points[kept]), normals, tangents, binormals)


def facing(faces, view):
    """The polygons whose front the viewer sees: bool [p]."""
    return dot(faces.normals, view.view_vectors(faces.centers)) > 0.0


def half_vectors(faces, view, light):
    """One halfway vector for each polygon, in its frame: float64 [p, 3]."""
    between = light.light_vectors(faces.centers) + view.view_vectors(faces.centers)
    return faces.to_local(normalize(between))


def light_vectors(faces, light):
    """One light vector for each polygon, in its frame: float64 [p, 3]."""
    return faces.to_local(light.light_vectors(faces.centers))


# ----------------------------------------------------------------------- windows of the host's images


@dataclass(frozen=True, eq=False)
class Windows:
    """The part of the material images that each polygon reads, all of one size, and its corners' places in
    it.

    rows, columns  int64 [p, height], [p, width]: texels of the images, repeated beyond their edges
    coordinates    float64 [p, corners, 2]
    sampler        REPEAT along an edge that is loaded whole, else CLAMP_TO_EDGE
    """

    rows: np.ndarray
    columns: np.ndarray
    coordinates: np.ndarray
    sampler: Sampler

    def part(self, image, number):
        """The image's part for polygon ``number``."""
        return image[self.rows[number][:, None], self.columns[number][None, :]]


def _window(coordinates, edge):
    """One axis of Windows, of images with ``edge`` texels: indices, coordinates, wrap mode."""
    texels = coordinates * float(edge) - 0.5
    first = np.floor(texels.min(axis=1) - _MARGIN)
    # Linear filters read the texel behind the last one as well.
    needed = np.floor(texels.max(axis=1) + _MARGIN) + 2.0 - first
    size = 1 << max(int(needed.max()) - 1, 0).bit_length()
    if size >= edge:
        return np.broadcast_to(np.arange(edge), (len(first), edge)), coordinates, WrapMode.REPEAT
    indices = (first.astype(np.int64)[:, None] + np.arange(size)) % edge
    return indices, (coordinates * float(edge) - first[:, None]) / float(size), WrapMode.CLAMP_TO_EDGE


def windows(surface, faces, rows, columns, magnification=TextureFilter.LINEAR):
    """The parts of ``rows`` x ``columns`` texels that polygons read, a border for the filter included, with
    edges that are powers of two.
    """
    coordinates = surface.texture_coordinates[faces.corners]
    across, s, wrap_s = _window(coordinates[..., 0], columns)
    along, t, wrap_t = _window(coordinates[..., 1], rows)
    return Windows(
        along, across, np.stack([s, t], axis=-1), Sampler(magnification, magnification, wrap_s, wrap_t)
    )


# ------------------------------------------------------------------------------ colour matrix and tables


def _entries(profile, count):
    return profile.pixels.max_color_table_size if profile.arithmetic.exact else count or TABLE_ENTRIES


def _signed(count, biased):
    """The dot products in [-1, 1] that a table's entries stand for; without a bias only those in [0, 1]."""
    index = np.arange(count) / float(count - 1)
    return 2.0 * index - 1.0 if biased else index


@lru_cache(maxsize=4)
def _squares(count, biased):
    """(2 i - 1)^2, or i^2 where the colour matrix gives d itself."""
    return ColorTable(
        tuple((d * d, 0.0, 0.0, 0.0) for d in _signed(count, biased).tolist()), BaseFormat.LUMINANCE
    )


@lru_cache(maxsize=16)
def _diffuse(count, color, ambient, gated):
    """Colour times (n.l)+ plus ambient, and min(1, 4 (n.l)+), or one, in alpha."""
    lit = np.maximum(0.0, _signed(count, True))
    rgb = [float(c) * lit + float(a) for c, a in zip(color, ambient, strict=True)]
    gate = np.minimum(1.0, 4.0 * lit) if gated else np.ones(count)
    return ColorTable(tuple(zip(*(column.tolist() for column in (*rgb, gate)), strict=True)))


@lru_cache(maxsize=4)
def _gate(count, gated):
    """min(1, 4 (n.l)+), or one, and (n.l)+ in alpha."""
    lit = np.maximum(0.0, _signed(count, True))
    gate = np.minimum(1.0, 4.0 * lit) if gated else np.ones(count)
    return ColorTable(tuple((g, g, g, a) for g, a in zip(gate.tolist(), lit.tolist(), strict=True)))


# --------------------------------------------------------------------------------------------- the passes


@dataclass(frozen=True, eq=False)
class Prepared:
    """The polygons of one surface that face the viewer, with what every pass over them shares: see
    ``prepare``.

    ``meshes``: one for each polygon; ``surface``: all of them at once.
    """

    name: str
    view: View
    profile: Profile
    faces: Polygons
    windows: Windows
    meshes: tuple[Mesh, ...]
    surface: Surface

    def load_and_draw(self, what, image, vectors, table, internal_format, biased=True, **tests):
        """For each polygon, the command that loads its part of a HostImage through the colour matrix, and
        the one that draws it: a list of pairs.
        """
        texture = f"{self.name}: {what}"
        unit = TextureUnit(texture, self.windows.sampler, environment=REPLACE)
        first = draw(f"draw the polygon with {what}", self.meshes[0], self.view, None, (unit,), **tests)
        pairs = []
        for number, (vector, mesh) in enumerate(zip(vectors, self.meshes, strict=True)):
            load = TexImage(
                label=f"load polygon {number}: {what}",
                texture=texture,
                pixels=PixelImage(self.windows.part(image.values, number), "RGB"),
                internal_format=internal_format,
                transfer=dot_product_transfer(vector, image.scale, table, biased),
            )
            pairs.append((load, replace(first, mesh=mesh)))
        return pairs

    def draw_all(self, label, blending, texture=None, color=(1.0, 1.0, 1.0)):
        """One pass over all polygons without loading anything for each, in a colour or a texture times it."""
        units = () if texture is None else (TextureUnit(texture, REPEATED, environment=MODULATE),)
        colors = np.tile(np.array(checked_rgb(color)), (len(self.surface.positions), 1))
        mesh = self.surface.mesh(colors=colors)
        return draw(label, mesh, self.view, None, units, blending=blending)


def prepare(surface, material, view, profile, *, name="material", triangles_per_polygon=1):
    """The input of the passes over a surface: its polygons that face the viewer, and the images that they
    read.

    ``name``: what the texture objects' names begin with. ``triangles_per_polygon``: how many consecutive
    triangles are one flat polygon, 2 for ``surfaces.plane``. Raises ValueError where none faces the viewer.
    """
    faces = polygons(surface, triangles_per_polygon)
    faces = faces.part(facing(faces, view))
    if not len(faces.corners):
        raise ValueError(f"No polygon of {name!r} faces the viewer; turn the surface round, or the viewer.")
    read = windows(surface, faces, *material.k_s.shape)
    meshes = tuple(
        Mesh(positions=surface.positions[corners], texture_coordinates=(coordinates,))
        for corners, coordinates in zip(faces.corners, read.coordinates, strict=True)
    )
    seen = replace(surface, triangles=faces.corners.reshape(-1, 3))
    return Prepared(name, view, profile, faces, read, meshes, seen)


def specular_passes(
    prepared,
    material,
    light,
    *,
    specular=(1.0, 1.0, 1.0),
    internal_format=InternalFormat.LUMINANCE8,
    table_entries=None,
    biased=True,
):
    """Eq. 1 into the framebuffer: a load and a draw for each of two squares and each polygon, then three
    draws.

    prepared         the surface (``prepare``)
    material         ``material_textures.Material``; alpha may be as small as floats allow
    specular         RGB in [0, 1] by which k_s is multiplied
    internal_format  of the squares' textures, one with luminance
    table_entries    of the colour table, a power of two; None: TABLE_ENTRIES. The exact machine has its
                     longest
    biased           False: the colour matrix gives d and not (1 + d)/2: negative products become zero (P15)
    """
    profile = prepared.profile
    halves = half_vectors(prepared.faces, prepared.view, light)
    table = _squares(_entries(profile, table_entries), biased)
    tangents, binormals = (
        prepared.load_and_draw(what, HostImage.of(vectors / alpha[..., None], profile), halves, table,
                               internal_format, biased, depth_test=depth_test, blending=blending)
        for what, vectors, alpha, depth_test, blending in (
            ("(h.t/ax)^2", material.tangents, material.alpha_x, FIRST_PASS, None),
            ("(h.b/ay)^2", material.binormals, material.alpha_y, LATER_PASS, ADD),
        )
    )  # fmt: skip
    squares = [
        command for pairs in zip(tangents, binormals, strict=True) for pair in pairs for command in pair
    ]
    k_s = f"{prepared.name}: k_s"
    image = texture_2d(factor_texels(material.k_s, profile)[..., None], InternalFormat.LUMINANCE8)
    return (
        *squares,
        prepared.draw_all("white polygons: one minus the framebuffer", SUBTRACT_FROM_SOURCE),
        prepared.draw_all("black polygons: keep (.)+", AT_LEAST_ZERO, color=(0.0, 0.0, 0.0)),
        TexImage(label=f"load k_s of {prepared.name}", texture=k_s, image=image),
        prepared.draw_all(
            "multiply by k_s",
            MULTIPLY_DESTINATION,
            k_s,
            specular,
        ),
    )


def diffuse_pass(
    prepared,
    material,
    light,
    *,
    color,
    ambient=(0.0, 0.0, 0.0),
    color_map=None,
    gated=True,
    table_entries=None,
):
    """K10 over the specular passes' result: framebuffer = colour (n.l)+ + ambient + gate framebuffer.

    ``gated``: True: the gate is min(1, 4 (n.l)+); False: it is one. ``color_map``: the name of a texture
    whose colours multiply both colour and ambient. Colours are RGB in [0, 1]; otherwise as for
    ``specular_passes``.
    """
    entries, black = _entries(prepared.profile, table_entries), (0.0, 0.0, 0.0)
    color, ambient = checked_rgb(color), checked_rgb(ambient, "The ambient light's colour")
    before, after = (), ()
    if color_map is None:
        what, table, blending = "colour (n.l)+, gate", _diffuse(entries, color, ambient, gated), ADD_AND_GATE
    else:
        what, table, blending = "gate, (n.l)+", _gate(entries, gated), MULTIPLY_BY_SOURCE
        white = prepared.draw_all("white polygons: alpha becomes one", None)
        alpha_only = replace(white.state, color_mask=ColorMask(False, False, False, True))
        before = (replace(white, state=alpha_only),)
        after = (prepared.draw_all("add colour map times (n.l)+", ADD_GATED, color_map, color),)
        if ambient != black:
            after += (prepared.draw_all("add colour map times ambient light", ADD, color_map, ambient),)
    pairs = prepared.load_and_draw(
        what,
        HostImage.of(material.normals, prepared.profile),
        light_vectors(prepared.faces, light),
        table,
        InternalFormat.RGBA8,
        depth_test=LATER_PASS,
        blending=blending,
    )
    return (*before, *(command for pair in pairs for command in pair), *after)


def commands(
    surface,
    material,
    view,
    light,
    profile,
    *,
    color,
    ambient=(0.0, 0.0, 0.0),
    color_map=None,
    specular=(1.0, 1.0, 1.0),
    gated=True,
    name="material",
    triangles_per_polygon=1,
):
    """K08 and K10: every load and every draw of one surface in one frame, with parameters as above."""
    prepared = prepare(
        surface, material, view, profile, name=name, triangles_per_polygon=triangles_per_polygon
    )
    return (
        *specular_passes(prepared, material, light, specular=specular),
        *diffuse_pass(
            prepared, material, light, color=color, ambient=ambient, color_map=color_map, gated=gated
        ),
    )

"""Parameters by which a figure shows a height field, a photograph, a material or a mesh of a user's own.

Without them a figure is unchanged: ``height_field``, ``photograph``, ``material`` and ``mesh`` are then None,
and ``height_scale`` has no effect.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from fixedpipe.effects.figures.parameters import Maybe, Number, Parameter, Unfit, Word
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.reflectance.material_textures import Material
from fixedpipe.effects.user_pictures import maps, probes
from fixedpipe.effects.user_pictures.bumped_mesh import MaterialParameters
from fixedpipe.effects.user_pictures.inputs import read_mesh


@dataclass(frozen=True)
class Own:
    """What ``read`` takes, which raises ValueError with a sentence for all else.

    allowed   what that is, in words
    called    (what ``read`` gave) -> the text that it was
    """

    read: Callable[[Any], Any]
    allowed: str
    called: Callable[[Any], str]

    def accept(self, value: Any) -> Any:
        """As scenes take it."""
        try:
            return self.read(value)
        except ValueError as error:
            raise Unfit(str(error)) from error

    def parse(self, text: str) -> Any:
        """The same, of a file's name, a sample's or a material's."""
        return self.accept(text)

    def show(self, value: Any) -> str:
        """The name, or a description in words."""
        return self.called(value)


_FILE = "a PNG, TIFF, JPEG or NPY file, or sample:gravel; in Python also an array or a Pillow image"
_NONE = "the figure's own"
_HEIGHTS = Maybe(Own(maps.height_field, _FILE, lambda value: value.called), _NONE)
_PROBE = Maybe(
    Own(
        lambda value: value if isinstance(value, probes.Probe) else probes.probe(str(value)),
        "a Radiance, OpenEXR, PNG, TIFF, JPEG or NPY file, twice as wide as high or square; in Python also a "
        "Probe",
        lambda value: value.called,
    ),
    _NONE,
)
_PHOTOGRAPH = Maybe(Own(maps.photograph, _FILE, lambda value: value.called), _NONE)


@dataclass(frozen=True, eq=False)
class OwnMesh:
    """A mesh of a user's own; ``called``: where it comes from, in words."""

    surface: Surface
    called: str


# What is taken as a mesh beside a file's name, by its class.
_AS_MESH: Mapping[type, Callable[[Any], OwnMesh]] = {
    OwnMesh: lambda taken: taken,
    Surface: lambda surface: OwnMesh(surface, f"a surface of {len(surface.triangles)} triangles"),
}


def _mesh(value: Any) -> OwnMesh:
    """Of a file's name or a Surface. Raises ValueError."""
    read = _AS_MESH.get(type(value), lambda name: OwnMesh(read_mesh(str(name)), str(name)))
    return read(value)


_MESH = Maybe(Own(_mesh, "an OBJ or a PLY file; in Python also a Surface", lambda value: value.called), _NONE)
_MATERIAL = Maybe(
    Own(
        maps.material,
        "gold, steel, brushed, stone or plastic; in Python also a Material",
        maps.material_name,
    ),
    _NONE,
)

_ROWS = "its top row is the top of what is drawn"
HEIGHT_SCALE = Word(
    Number(0.0, 1.0),
    "How far the highest point of height_field stands above the lowest, in widths of it.",
    of="height_field",
)


def height_field(instead: str, repeats: bool = True) -> Parameter:
    """A Parameter: heights that replace what ``instead`` names. ``repeats``: on the surface."""
    faded = "; as it repeats, its edges are faded into each other" if repeats else ""
    return Parameter(
        None,
        _HEIGHTS,
        f"A height field in the place of {instead}: light is high, dark is low, {_ROWS}{faded}.",
    )


def photograph(instead: str, repeats: bool = True) -> Parameter:
    """A Parameter: a photograph that replaces what ``instead`` names. ``repeats``: on the surface."""
    faded = "; as it repeats, its edges are faded into each other" if repeats else ""
    return Parameter(None, _PHOTOGRAPH, f"A photograph in the place of {instead}: {_ROWS}{faded}.")


def mesh(instead: str) -> Parameter:
    """A Parameter: a mesh that replaces what ``instead`` names."""
    return Parameter(
        None,
        _MESH,
        f"A mesh in the place of {instead}, with its own texture coordinates where it has some; it is "
        "centred and scaled to the panel.",
    )


PANORAMA = Parameter(
    None,
    _PHOTOGRAPH,
    "A panorama in the place of environment, all around from left to right and from straight down to "
    "straight up: its middle is what the viewer looks at, its top row is above.",
)


PROBE = Parameter(
    None,
    _PROBE,
    "An environment in the place of the figure's, of high dynamic range too: a panorama, whose middle is -z "
    "and whose top row is above, or a square light probe.",
)


def _of_material(material: object) -> Mapping[str, Any]:
    """What a material that is given by name brings for other parameters."""
    if not isinstance(material, MaterialParameters):
        return {}
    own: dict[str, Any] = {
        "alpha_x": material.alpha_x,
        "alpha_y": material.alpha_y,
        "k_s": (material.k_s, material.k_s),
        "diffuse": material.diffuse,
        "ambient": tuple(0.12 * c for c in material.diffuse),
    }
    return own | dict.fromkeys(("specular", "banks", "blinn_phong", "ward"), material.specular)


MATERIAL = Parameter(
    None,
    _MATERIAL,
    "A material in the place of the figure's. A name gives the figure's surface that material's widths of "
    "the highlight, strength and colours, where these are not given too; a Material of Python brings its own "
    "surface, bottom row first.",
    brings=_of_material,
)


def material_or(made: Callable[[], Material], material: object, height_field: object) -> Material:
    """The user's Material, or what ``made`` makes. Raises ValueError where a height field is given too."""
    if not isinstance(material, Material):
        return made()
    if height_field is not None:
        raise ValueError(
            "A Material has a surface of its own, so height_field would be ignored: give one of them, or "
            "the material by a name."
        )
    return material

"""A mesh of one material under a light, with a camera, for ``fixedpipe view MESH --material NAME``."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from fixedpipe.effects.figures import parameters as word
from fixedpipe.effects.figures.parameters import DIRECTION_KIND, Number, Parameter, Several
from fixedpipe.effects.geometry.surfaces import Surface
from fixedpipe.effects.reflectance.brdfs import BRDFS
from fixedpipe.effects.refusal import Refusal, no_such, refusals
from fixedpipe.effects.user_pictures import shown_material
from fixedpipe.effects.user_pictures.factored_brdf import Factored
from fixedpipe.effects.user_pictures.inputs import MESH_KINDS, read_mesh
from fixedpipe.effects.viewer.controls import control
from fixedpipe.effects.viewer.views import View, machine_of, machines
from fixedpipe.pipeline.commands import Command
from fixedpipe.pipeline.profiles.profile import Profile

_SIZE = 512
# The parameters of the scene, in addition to those of the reflectance.
_SCENE = {
    "view": word.of(
        DIRECTION_KIND,
        shown_material.EYE,
        "The direction to the eye: x to the right, y up, z towards the viewer.",
    ),
    "light": word.LIGHT((-1.0, 1.0, 1.0)),
    "color": word.COLOR((1.0, 1.0, 1.0), "By what the reflectance is multiplied."),
    "exposure": word.of(Number(0.0, 64.0, above=True), 1.0, "What all light is multiplied by."),
}


def is_mesh(what: str) -> bool:
    """Whether a word names a mesh: one of the package's, or an OBJ or PLY file."""
    return what in shown_material.MESHES or what.lower().endswith(MESH_KINDS)


@dataclass(frozen=True, eq=False)
class MeshSubject:
    """A mesh of one material.

    mesh      the mesh's name, or the name of its file
    material  a name in ``BRDFS``, or a file
    surface   the mesh's Surface
    """

    mesh: str
    material: str
    surface: Surface
    size: int = 0
    panels: tuple[str, ...] = ("",)

    @property
    def id(self) -> str:
        """The mesh's name."""
        return self.mesh

    @property
    def title(self) -> str:
        """The mesh's name and the material's."""
        row = BRDFS.get(self.material)
        return f"{self.mesh}, {self.material if row is None else row.title}"

    @property
    def machines(self) -> tuple[str, ...]:
        """The keys of the machines that can draw products of textures."""
        return _able()

    def _parameters(self) -> dict[str, Parameter]:
        return _SCENE | _of_material(self.material)

    def about(self, machine: str) -> dict[str, Any]:
        """The data for a page, with controls for the camera, the light and the reflectance's parameters."""
        profile = machine_of(machine)
        shown_material.check_machine(profile)
        return {
            "caption": self.title,
            "must_see": "",
            "method": shown_material.way_of(profile),
            "size": self.size or _SIZE,
            "sizable": True,
            "reference": False,
            "controls": [
                control(name, parameter, parameter.kind.show(parameter.default))
                for name, parameter in self._parameters().items()
            ],
        }

    def dimensions(self, view: View) -> tuple[int, int]:
        """Width and height in pixels: those of a square."""
        size = view.size or self.size or _SIZE
        return size, size

    def _values(self, view: View) -> dict[str, Any]:
        known = self._parameters()
        found = {name: parameter.default for name, parameter in known.items()}
        for name, text in view.values:
            if name not in known:
                raise Refusal(no_such("parameter", name, known))
            with refusals():
                found[name] = known[name].parse(text, f"{self.id}'s {name}")
        return found

    def _settings(self, view: View) -> dict[str, str]:
        """The values, as texts, of the reflectance's parameters that are set."""
        return {name: text for name, text in view.values if name not in _SCENE}

    def commands(self, view: View, profile: Profile) -> tuple[Command, ...]:
        """The commands that define the factors' textures and draw the passes. Raises Refusal."""
        values = self._values(view)
        with refusals():
            lighting = shown_material.directional([values["light"]], values["exposure"])
            found = _factored(self.material, tuple(sorted(self._settings(view).items())))
            return shown_material.commands(
                found,
                self.surface,
                lighting,
                profile,
                *self.dimensions(view),
                color=values["color"],
                eye=_eye(values["view"]),
            )

    def reference(self, view: View) -> None:
        """None: there is no reference. The ideal evaluates the same passes."""

    def script(self, view: View) -> tuple[list[str], list[str]]:
        """Lines of Python that draw by ``shown_material``."""
        values, (width, height) = self._values(view), self.dimensions(view)
        imports = ["from fixedpipe.effects.user_pictures import shown_material"]
        surface = f"shown_material.mesh({self.mesh!r})"
        if self.mesh not in shown_material.MESHES:
            imports.append("from fixedpipe.effects.user_pictures.inputs import read_mesh")
            surface = f"read_mesh({self.mesh!r})"
        return imports, [
            f"surface = {surface}",
            f"reflectance = shown_material.reflectance({self.material!r}, {self._settings(view)!r})",
            "factored = shown_material.factored(reflectance)",
            f"lighting = shown_material.directional([{values['light']!r}], {values['exposure']!r})",
            f"width, height = {width}, {height}",
            "",
            "",
            "def commands_of(machine):",
            '    """The frame for a machine, or for IDEAL."""',
            "    return shown_material.commands(",
            "        factored, surface, lighting, machine, width, height,",
            f"        color={values['color']!r}, eye={_eye(values['view'])!r},",
            "    )",
        ]

    def spoken(self, view: View) -> str:
        """Empty, because ``fixedpipe material`` has other options and another window."""
        return ""


def mesh_subject(mesh: str, material: str, size: int = 0) -> MeshSubject:
    """The MeshSubject of names or files. Raises Refusal for a word that is neither."""
    with refusals():
        _factored(material, ())
        surface = read_mesh(mesh) if mesh.lower().endswith(MESH_KINDS) else shown_material.mesh(mesh)
    return MeshSubject(mesh, material, surface, size)


def _eye(direction):
    """The eye's place, as far from the origin as the usual one. Raises Refusal for the direction y (up)."""
    x, y, z = direction
    length, far = (sum(c * c for c in one) ** 0.5 for one in (direction, shown_material.EYE))
    if (x * x + z * z) ** 0.5 < 1e-3 * length:
        raise Refusal("The eye looks along y, which is up; turn it a little aside.")
    return tuple(c * (far / length) for c in (x, y, z))


@lru_cache(maxsize=1)
def _able():
    able = (key for key, profile in machines().items() if shown_material.can_draw(profile))
    return tuple(sorted(able, key=lambda key: key != "GEFORCE_256"))


@lru_cache(maxsize=8)
def _factored(material: str, settings: tuple[tuple[str, str], ...]) -> Factored:
    return shown_material.factored(shown_material.reflectance(material, dict(settings)))


def _of_material(material: str) -> dict[str, Parameter]:
    """The reflectance's parameters as Parameters, as figures have them."""
    row, found = BRDFS.get(material), {}
    for each in row.parameters if row is not None else ():
        low, high = each.low, each.high
        if isinstance(each.default, tuple):
            kind: Any = Several(tuple(Number(a, b) for a, b in zip(low, high, strict=True)))  # type: ignore[arg-type]
        else:
            kind = Number(low, high)  # type: ignore[arg-type]
        found[each.name] = Parameter(each.default, kind, f"{each.meaning[:1].upper()}{each.meaning[1:]}.")
    return found

"""The Walk: what validation knows when it reaches a command, and how it refuses one."""

import sys
import warnings
from collections.abc import Callable, Hashable, Iterable, Mapping
from types import FrameType
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn
from weakref import WeakKeyDictionary

from fixedpipe.pipeline.commands import Clear, Command, Draw, Mesh
from fixedpipe.pipeline.enums import ColorFormat, InternalFormat, PrimitiveType, TextureTarget
from fixedpipe.pipeline.interned_states import interned
from fixedpipe.pipeline.messages import depth_words, surface_words
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.textures.images import Texture
from fixedpipe.pipeline.validation.meshes import has_infinite_fog, is_usable
from fixedpipe.pipeline.validation.remembered import Remembered

if TYPE_CHECKING:  # For annotations alone: validation calls no framebuffer.
    from fixedpipe.pipeline.framebuffers.framebuffer import Framebuffer
    from fixedpipe.pipeline.framebuffers.transfer import PixelStatistics


class UnsupportedState(ValueError):  # noqa: N818 (it names what was asked for)
    """A command that the machine could not execute. The message says what is wrong and what to do."""


class DisabledTexture(UserWarning):
    """A pass reads the texture of a unit that it does not enable; the message says what it gets instead.

    This is a warning and no error, because machines draw such passes. In NV_register_combiners the register
    is undefined. On the NV2A it was measured to be opaque black (docs/numbers.md, section 7; captures of the
    suites Combiner, Depth_buffer and Texture_format). For a texture environment, NV_texture_env_combine4 or
    ARB_texture_env_crossbar defines the value. Most authors of such a pass meant to enable a texture.
    """


class KnownSurface(NamedTuple):
    """What validation remembers of a pbuffer: the properties that its first MakeCurrent fixes."""

    width: int
    height: int
    color_format: ColorFormat
    depth_bits: int
    samples: int = 1
    shares_depth: bool = False
    depth_of: str | None = None

    def __str__(self):
        depth = depth_words(self.depth_bits)
        several = "" if self.samples == 1 else f" and {self.samples} samples in each pixel"
        shared = f", those of {surface_words(self.depth_of)}" if self.shares_depth else ""
        return f"{self.width}x{self.height} {self.color_format.name} with {depth}{shared}{several}"


class KnownTexture(NamedTuple):
    """What validation remembers of a texture object.

    - ``sizes``: (width, height) of every level, without the border.
    - ``faces``: the number of faces or layers of every level, without the border.
    - ``border``: its width in texels.
    """

    target: TextureTarget
    internal_format: InternalFormat
    sizes: tuple[tuple[int, int], ...]
    faces: tuple[int, ...]
    border: int = 0

    @classmethod
    def of(cls, image: Texture) -> "KnownTexture":
        """What validation remembers of a Texture."""
        s, t, r = (2 * texels for texels in image.borders)
        sizes = tuple((level.shape[2] - s, level.shape[1] - t) for level in image.levels)
        faces = tuple(len(level) - r for level in image.levels)
        return cls(image.target, image.internal_format, sizes, faces, image.border)


class Taken:
    """What a profile was found to take.

    - ``parts``: parts of states.
    - ``states``, ``kinds``: whole states and their kinds, each with the mesh and textures that it was checked
      with.
    - ``transfers``: PixelTransfers.
    - ``textures``: the KnownTexture of each Texture.
    """

    def __init__(self):
        self.parts, self.states, self.kinds = Remembered(), Remembered(), Remembered()
        self.transfers = Remembered()
        self.textures: WeakKeyDictionary[Texture, KnownTexture] = WeakKeyDictionary()


_taken = Remembered(16)


def taken_by(profile: Profile) -> Taken:
    """The Taken of a profile."""
    _, found = _taken.get(id(profile), (None, None))
    if found is None:
        found = Taken()
        _taken.add(profile, finding=found)
    return found


class _Beside(NamedTuple):
    """The properties of mesh and textures that the finding on a Draw's state depends on."""

    names: tuple[str, ...]
    textures: tuple[KnownTexture | None, ...]
    primitive: PrimitiveType
    infinite_fog: bool


class Known(NamedTuple):
    """A copy of what a Walk knows between two commands.

    Walks of one profile with equal copies take the same later commands.
    """

    target: tuple[int, int, int, bool]
    surfaces: dict[str, KnownSurface]
    textures: dict[str, KnownTexture]
    names: tuple[frozenset[str], ...]


class Walk:
    """What is known while validation goes through the commands, in order.

    - ``where``: the words by which messages name the current command.
    - ``taken``: what the profile was found to take.
    - ``width``, ``height``, ``depth_bits``: of the draw target: the window, or a pbuffer where ``in_window``
      is False.
    - ``surfaces``: {name: KnownSurface}.
    - ``textures``: {name: KnownTexture}.
    - ``warned``: whether the current command has caused a warning.
    - ``read``: names that ReadPixels or GetTexImage gave.
    - ``given``: those of ``read`` whose pixels no histogram or minmax with a sink took.
    - ``histograms``, ``minmaxes``: names of those that pixel transfers have used.
    """

    where: str

    def __init__(
        self,
        profile: Profile,
        width: int,
        height: int,
        depth_bits: int,
        surfaces: "Mapping[str, Framebuffer]",
        statistics: "PixelStatistics | None",
        read: Iterable[str] = (),
        *,
        samples: int = 1,
    ):
        self.profile, self.width, self.height, self.depth_bits = profile, width, height, depth_bits
        self.taken = taken_by(profile)
        self.window = KnownSurface(width, height, ColorFormat.A8R8G8B8, depth_bits, samples)
        self.in_window, self.warned = True, False
        self.surfaces = {
            name: KnownSurface(
                f.width, f.height, f.color_format, f.depth_format, f.samples, f.shares_depth, f.depth_of
            )
            for name, f in surfaces.items()
        }
        self.textures: dict[str, KnownTexture] = {}
        self.read, self.given = set(read), set(read)  # Earlier reads gave all of their pixels.
        self.histograms = set() if statistics is None else set(statistics.histograms)
        self.minmaxes = set() if statistics is None else set(statistics.minmaxes)

    @classmethod
    def of(cls, profile: Profile, known: Known) -> "Walk":
        """A Walk of another machine that knows what a Walk knew at a place of the frame."""
        width, height, depth_bits, in_window = known.target
        walk = cls(profile, width, height, depth_bits, {}, None)
        walk.in_window = in_window
        walk.surfaces, walk.textures = dict(known.surfaces), dict(known.textures)
        walk.read, walk.given, walk.histograms, walk.minmaxes = map(set, known.names)
        return walk

    def known(self) -> Known:
        """A copy of what is known here."""
        names = self.read, self.given, self.histograms, self.minmaxes
        target = self.width, self.height, self.depth_bits, self.in_window
        return Known(target, dict(self.surfaces), dict(self.textures), tuple(map(frozenset, names)))

    def refuse(self, sentence: str) -> NoReturn:
        """Raise UnsupportedState for the current command."""
        raise UnsupportedState(f"{self.where}: {sentence}")

    def warn(self, sentence: str) -> None:
        """Warn that the current command reads a DisabledTexture, at the caller's line outside the project."""
        self.warned = True
        frame: FrameType | None = sys._getframe(1)
        level = 2
        while frame is not None and frame.f_globals.get("__name__", "").startswith("fixedpipe."):
            frame, level = frame.f_back, level + 1
        warnings.warn(f"{self.where}: {sentence}", DisabledTexture, stacklevel=level)

    def once(self, check: Callable[..., None], value: Any, *beside: Hashable) -> None:
        """Call ``check(self, value, *beside)`` unless this machine already passed the same check."""
        key = (id(value), check, *beside)
        if key not in self.taken.parts:
            check(self, value, *beside)
            self.taken.parts.add(value, *key[1:])

    def takes(self, command: Command) -> bool:
        """Whether the command is known to be right here.

        It is a Clear that was checked before, or a Draw whose state was checked with the same textures, the
        same primitive type and a usable mesh.
        """
        if type(command) is Clear:
            return id(command) in self.taken.states
        if type(command) is not Draw or not self.is_whole(command):
            return False
        found = self.taken.states.get(id(interned(command.state)))
        return found is not None and found[1] == self.beside(command.mesh, found[1].names)

    def is_whole(self, command: Draw) -> bool:
        """Whether a Draw has a label and a Mesh."""
        return type(command.label) is str and bool(command.label.strip()) and type(command.mesh) is Mesh

    def beside(self, mesh: Mesh, names: tuple[str, ...]) -> _Beside | None:
        """What the finding on a state that names these textures depends on; None: the mesh is not usable."""
        if not is_usable(mesh):
            return None
        textures = tuple([self.textures.get(name) for name in names])
        return _Beside(names, textures, mesh.primitive, has_infinite_fog(mesh))

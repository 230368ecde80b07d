"""A file of a small state: a window, textures, polygons, and the requested pixel."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.pixel_states.textures import read_texture
from fixedpipe.effects.pixel_states.values import read_json, read_list, read_object, read_value, wrong
from fixedpipe.effects.refusal import Refusal, choose, refusals
from fixedpipe.pipeline.commands import Clear, Command, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import DepthFormat, PrimitiveType
from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import Color, PassState
from fixedpipe.pipeline.textures.images import Texture

FORMAT = 1
MOST_CHARACTERS = 8_000_000  # of a file: a texture of 512 by 512 texels with four components has 4 million
MOST_EDGE, MOST_DRAWS, MOST_VERTICES, MOST_TEXTURES = 512, 64, 4096, 16
KEYS = (
    *("format", "machine", "width", "height", "pixel", "depth_bits", "color_bits"),
    *("clear", "textures", "draws"),
)
CLEAR_KEYS, DRAW_KEYS = ("color", "depth", "stencil"), ("label", "mesh", "program", "state")
# Arrays of a mesh, and how many components a vertex may have in each; None: one number a vertex.
POSITIONS = {"positions": (2, 3, 4), "window": (2, 3, 4)}
ARRAYS = {
    "colors": (3, 4),
    "secondary_colors": (3, 4),
    "normals": (3,),
    "fog_coordinates": None,
    "back_colors": (3, 4),
    "back_secondary_colors": (3, 4),
    "point_sizes": None,
    "weights": None,
}
MESH_KEYS = ("primitive", *POSITIONS, *ARRAYS, "texture_coordinates")
_COORDINATES = (1, 2, 3, 4)
# A triangle over the whole window, in clip coordinates.
_WHOLE = ((-1.0, -1.0), (3.0, -1.0), (-1.0, 3.0))


@dataclass(frozen=True, eq=False)
class PixelState:
    """A small state, as its file has it.

    - ``machine``: the profile's key; None: the file names none.
    - ``pixel``: (x, y) from the top left of the window of ``width`` by ``height`` pixels, y downwards.
    - ``window``: depth_bits and color_bits where the file gives them, as ``execute`` takes them.
    - ``draws``: the objects of the file. ``commands`` makes meshes and states of them.
    """

    machine: str | None
    width: int
    height: int
    pixel: tuple[int, int]
    window: dict[str, int]
    clear: Clear
    textures: dict[str, Texture]
    draws: tuple[dict[str, Any], ...]

    def commands(self, profile: Profile) -> tuple[Command, ...]:
        """The frame for a machine: one Clear, the textures, the Draws. Raises Refusal."""
        targets = {name: texture.target for name, texture in self.textures.items()}
        images = [TexImage(label=name, texture=name, image=image) for name, image in self.textures.items()]
        drawn = [
            _draw(given, f"draws[{n}]", n, (self.width, self.height), targets, profile)
            for n, given in enumerate(self.draws)
        ]
        return (self.clear, *images, *drawn)


def read_state(text: str, name: str) -> PixelState:
    """The PixelState of a file's text. ``name``: of the file, for sentences. Raises Refusal."""
    if len(text) > MOST_CHARACTERS:
        raise Refusal(f"{name} has {len(text)} characters; a small state has at most {MOST_CHARACTERS}.")
    given = read_object(read_json(text, name), name, KEYS, ("draws",))
    if given.get("format", FORMAT) != FORMAT or isinstance(given.get("format"), bool):
        wrong(f"{name}'s format", given["format"], f"this version reads format {FORMAT}")
    machine = given.get("machine")
    if machine is not None:
        choose("profile", read_value(str, machine, "machine"), PROFILES)
    width, height = (_edge(given, key) for key in ("width", "height"))
    return PixelState(
        machine,
        width,
        height,
        _pixel(given.get("pixel", [0, 0]), width, height),
        _window(given),
        _clear(given.get("clear", {})),
        _textures(given.get("textures", {})),
        tuple(read_list(given["draws"], "draws", MOST_DRAWS)),
    )


def _edge(given, key):
    edge = read_value(int, given.get(key, 1), key)
    if not 1 <= edge <= MOST_EDGE:
        raise Refusal(f"{key} is {edge}; a small state's window has 1 to {MOST_EDGE} pixels.")
    return edge


def _pixel(given, width, height):
    x, y = read_value(tuple[int, int], given, "pixel")
    if not (0 <= x < width and 0 <= y < height):
        raise Refusal(
            f"pixel is [{x}, {y}], outside the window of {width}x{height}; give [0, 0] to "
            f"[{width - 1}, {height - 1}]."
        )
    return x, y


def _window(given):
    found = {}
    if (depth := given.get("depth_bits")) is not None:
        named = isinstance(depth, str)
        found["depth_bits"] = read_value(DepthFormat if named else int, depth, "depth_bits")
    if (color := given.get("color_bits")) is not None:
        found["color_bits"] = read_value(int, color, "color_bits")
    return found


def _clear(given):
    given = read_object(given, "clear", CLEAR_KEYS)
    return Clear(
        label="clear",
        color=read_value(Color, given.get("color", [0, 0, 0, 0]), "clear.color"),
        depth=read_value(float, given.get("depth", 1), "clear.depth"),
        stencil=read_value(int, given.get("stencil", 0), "clear.stencil"),
    )


def _textures(given):
    if not isinstance(given, dict):
        wrong("textures", given, "give an object with a texture under each name")
    if len(given) > MOST_TEXTURES:
        raise Refusal(f"There are {len(given)} textures; a small state has at most {MOST_TEXTURES}.")
    return {
        read_value(str, name, "A texture's name"): read_texture(texture, f"textures.{name}")
        for name, texture in given.items()
    }


# ------------------------------------------------------------------------------------------------- draws


def _draw(given, path, number, size, targets, profile):
    given = read_object(given, path, DRAW_KEYS)
    with refusals():
        state = read_value(PassState, given.get("state", {}), f"{path}.state")
        if "program" in given:
            state = _programmed(state, given["program"], f"{path}.program", targets, profile)
        return Draw(
            label=read_value(str, given.get("label", f"draw {number}"), f"{path}.label"),
            mesh=_mesh(given.get("mesh", {}), f"{path}.mesh", size),
            state=state,
        )


def _programmed(state, given, path, targets, profile):
    """The state with the combiners and texture shaders of a program's text, or of its lines."""
    lines = given if isinstance(given, list) else [given]
    text = "\n".join(read_value(str, line, path) for line in lines)
    bound = {
        unit: targets[of.texture]
        for unit, of in enumerate(state.texture_units)
        if of is not None and of.texture in targets
    }
    combiners = profile.combiners
    own = combiners.per_stage_constants or not combiners.max_general_combiners
    try:
        program = parse_program(text, bound, None, own)
    except ProgramTextError as error:
        raise Refusal(f"{path}, {error}") from error
    changed = {"texture_shader": program.texture_shader, "register_combiners": program.combiners}
    for field, value in changed.items():
        if value is not None and getattr(state, field) is not None:
            raise Refusal(f"{path} sets {field}, and so does the state; leave one of them out.")
    return replace(state, **{field: value for field, value in changed.items() if value is not None})


def _mesh(given, path, size):
    given = read_object(given, path, MESH_KEYS)
    both = [key for key in POSITIONS if key in given]
    if len(both) > 1:
        raise Refusal(f"{path} has {' and '.join(both)}; give one of them.")
    primitive = read_value(PrimitiveType, given.get("primitive", "TRIANGLES"), f"{path}.primitive")
    if not both:
        if primitive is not PrimitiveType.TRIANGLES:
            raise Refusal(
                f"{path} has no positions, so it is a triangle over the window; leave primitive out."
            )
        positions = np.array(_WHOLE)
    else:
        (key,) = both
        positions = _rows(given[key], f"{path}.{key}", POSITIONS[key])
        if key == "window":
            positions = _clip(positions, *size)
    count = len(positions)
    arrays = {
        name: _attribute(given[name], f"{path}.{name}", components, count)
        for name, components in ARRAYS.items()
        if name in given
    }
    sets = read_list(given.get("texture_coordinates", []), f"{path}.texture_coordinates", 8)
    coordinates = tuple(
        _attribute(of, f"{path}.texture_coordinates[{n}]", _COORDINATES, count) for n, of in enumerate(sets)
    )
    return Mesh(positions, primitive, texture_coordinates=coordinates, **arrays)


def _rows(given: Any, path: str, components: tuple[int, ...] | None) -> NDArray[np.float64]:
    """Rows of numbers, float64 [n, components], or [n] where there are no components."""
    rows = read_list(given, path, MOST_VERTICES)
    if not rows:
        raise Refusal(f"{path} is empty; give a row for each vertex.")
    if components is None:
        return np.array([read_value(float, value, f"{path}[{n}]") for n, value in enumerate(rows)])
    read = [read_value(tuple[float, ...], row, f"{path}[{n}]") for n, row in enumerate(rows)]
    lengths = {len(row) for row in read}
    if len(lengths) > 1 or not lengths <= set(components):
        wanted = " or ".join(map(str, components))
        raise Refusal(
            f"{path} has rows of {' and '.join(map(str, sorted(lengths)))} numbers; give {wanted} in each."
        )
    return np.array(read)


def _attribute(given, path, components, count):
    """An attribute of every vertex. One row is every vertex's."""
    rows = _rows(given, path, components)
    if len(rows) not in (1, count):
        raise Refusal(f"{path} has {len(rows)} rows and the polygon {count} vertices; give {count}, or one.")
    return np.repeat(rows, count, axis=0) if len(rows) == 1 else rows


def _clip(window, width, height):
    """Clip coordinates of window coordinates [n, 2..4]: x and y in pixels from the top left, z from 0 to 1
    (0), w (1). They are exact where width and height are powers of two.
    """
    full = np.zeros((len(window), 4))
    full[:, 3] = 1.0
    full[:, : window.shape[1]] = window
    x, y, z, w = full.T
    return np.stack([(2 * x / width - 1) * w, (1 - 2 * y / height) * w, (2 * z - 1) * w, w], axis=1)

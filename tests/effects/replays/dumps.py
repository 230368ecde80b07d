"""State dumps of glretrace beside a Context's state, number by number."""

import re
from contextlib import contextmanager

import numpy as np

from fixedpipe.effects.replays.replay import Replay
from fixedpipe.effects.replays.targets import Target
from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.queries import agrees, answer, is_computed
from fixedpipe.pipeline.traces.calls import Trace

# Names that a dump has, and ours, where these are others and more than a vendor's suffix is missing.
_OLDER = (
    (r"CLIP_DISTANCE(\d)", r"CLIP_PLANE\1"),
    (r"SRC(\d)_(RGB|ALPHA)", r"SOURCE\1_\2"),
    (r"(.*)FOG_COORD\b(.*)", r"\1FOG_COORDINATE\2"),
    (r"(.*)FOG_COORD_(.*)", r"\1FOG_COORDINATE_\2"),
)
_SUFFIXES = ("", "_NV", "_EXT", "_ARB", "_SGIS", "_SGI")
# Of each target the query of its parameters, and what it is asked with.
_ENVIRONMENTS = {
    "GL_TEXTURE_ENV": tokens.TEXTURE_ENV,
    "GL_TEXTURE_FILTER_CONTROL": tokens.TEXTURE_FILTER_CONTROL,
    "GL_POINT_SPRITE": tokens.POINT_SPRITE_NV,
}
_TEXTURES = {
    "GL_TEXTURE_1D": tokens.TEXTURE_1D,
    "GL_TEXTURE_2D": tokens.TEXTURE_2D,
    "GL_TEXTURE_3D": tokens.TEXTURE_3D,
    "GL_TEXTURE_CUBE_MAP": tokens.TEXTURE_CUBE_MAP,
}
_COORDINATES = {f"GL_TEXTURE_GEN_{c}": getattr(tokens, c) for c in "STRQ"}


# What a driver may choose, and llvmpipe does: masks keep the bits of its stencil planes alone.
_MASKS = {"GL_STENCIL_VALUE_MASK", "GL_STENCIL_WRITEMASK", "GL_STENCIL_BACK_VALUE_MASK", "GL_INDEX_WRITEMASK"}
_PLANES = 0xFF
# glretrace gives objects names of its own, so that no more than "none" can be compared.
_NAMES = re.compile(
    r"GL_TEXTURE_BINDING_\w+|GL_\w+_BUFFER_BINDING|GL_(DRAW_|READ_)?FRAMEBUFFER_BINDING|GL_LIST_BASE"
)
# NV_texture_env_combine4's fourth term begins as ZERO and ONE_MINUS_SRC_COLOR or _ALPHA; Mesa's does not.
_FOURTH = re.compile(r"GL_(SOURCE|OPERAND)3_(RGB|ALPHA)_NV")


def _printed(value):
    """A number as a dump has it: floats are in single precision, and have seven decimal digits."""
    return float(f"{np.float32(value):.7g}") if isinstance(value, float) else value


class _Idle(Target):
    """Draws nothing."""

    def _start(self):
        pass

    def _execute(self, commands):
        return commands


def context_after(path, number, profile):
    """The Context that is current behind a call of a trace."""
    replay = Replay(profile, target=_Idle)
    with Trace(path) as trace:
        for call in trace:
            replay.take(call)
            if call.number >= number:
                return replay.windows.current(call.thread).gl
    raise AssertionError(f"{path} has no call {number}")


def token_of(name):
    """A token by a dump's name of it; None where it is unknown here."""
    name = name.removeprefix("GL_")
    for stem in (name, *(re.sub(f"^{new}$", old, name) for new, old in _OLDER)):
        for suffix in _SUFFIXES:
            found = getattr(tokens, stem + suffix, None)
            if isinstance(found, int):
                return found
    return None


def numbers_of(value):
    """A dump's value as numbers; None where a name is unknown, or it is no number."""
    if isinstance(value, list):
        found = [numbers_of(each) for each in value]
        return None if None in found else found
    if isinstance(value, str):
        return {"GL_TRUE": True, "GL_FALSE": False, "GL_ZERO": 0, "GL_NONE": 0}.get(value, token_of(value))
    return value if isinstance(value, int | float) else None


class Comparison:
    """``compared``: how many; ``differing``: (name, ours, the dump's); ``asked``: the names."""

    def __init__(self, gl, dump):
        self.gl, self.compared, self.differing, self.asked = gl, 0, [], set()
        parameters = dump["parameters"]
        self._ask("", "glGetFloatv", (), parameters)
        for name, inner in parameters.items():
            if re.fullmatch(r"GL_LIGHT\d", name):
                self._ask(name, "glGetLightfv", (token_of(name),), inner)
            elif name in ("GL_FRONT", "GL_BACK"):
                self._ask(name, "glGetMaterialfv", (token_of(name),), inner)
        for unit in range(gl.profile.textures.max_texture_units):
            if (inner := parameters.get(f"GL_TEXTURE{unit}")) is not None:
                with self._active(unit):
                    self._unit(f"GL_TEXTURE{unit}", inner)

    @contextmanager
    def _active(self, unit):
        values = self.gl.values
        before, client = values["active_texture"], self.gl.arrays.unit
        values.set("active_texture", unit)
        try:
            yield
        finally:
            values.set("active_texture", before)
            self.gl.arrays.unit = client

    def _unit(self, where, inner):
        self._ask(where, "glGetFloatv", (), inner)
        for name, parameters in inner.items():
            if not isinstance(parameters, dict):
                continue
            for query, targets in (
                ("glGetTexEnvfv", _ENVIRONMENTS),
                ("glGetTexParameterfv", _TEXTURES),
                ("glGetTexGenfv", _COORDINATES),
            ):
                if name in targets:
                    self._ask(f"{where} {name}", query, (targets[name],), parameters)

    def _ask(self, where, query, given, parameters):
        for name, value in parameters.items():
            token, numbers = token_of(name), numbers_of(value)
            if token is None or numbers is None:
                continue
            ours = answer(self.gl, query, [*given, token, None])
            if ours is None:
                continue
            if _FOURTH.fullmatch(name):
                continue
            if name in _MASKS:
                ours, numbers = (int(ours[0]) & _PLANES,), int(numbers) & _PLANES
            elif _NAMES.fullmatch(name):
                ours, numbers = (bool(ours[0]),), bool(numbers)
            ours = tuple(_printed(value) for value in ours)
            self.compared += 1
            self.asked.add(name)
            if not agrees(ours, numbers, is_computed(query, [token])):
                self.differing.append((f"{where} {name}".strip(), ours, value))

"""What a Context draws, in a form in which equal pictures are equal."""

import importlib
import pkgutil

import numpy as np

import fixedpipe.pipeline.opengl
from fixedpipe.pipeline.commands import Draw
from fixedpipe.pipeline.opengl import tokens as gl_tokens
from fixedpipe.pipeline.opengl.context import Context
from fixedpipe.pipeline.profiles import PROFILES

# Every module of the package registers its entry points.
for _module in pkgutil.iter_modules(fixedpipe.pipeline.opengl.__path__):
    importlib.import_module(f"fixedpipe.pipeline.opengl.{_module.name}")

_DEFAULTS = {
    "positions": (0.0, 0.0, 0.0, 1.0),
    "colors": (1.0, 1.0, 1.0, 1.0),
    "secondary_colors": (0.0, 0.0, 0.0, 0.0),
    "normals": (0.0, 0.0, 1.0),
}


def context(profile="GEFORCE_3", width=64, height=64):
    return Context(PROFILES[profile], width, height)


def textured(gl, *units):
    """Enable a complete 2D texture in units, so that their coordinates are read."""
    for unit in units:
        gl.ActiveTexture(gl_tokens.TEXTURE0 + unit)
        gl.BindTexture(gl_tokens.TEXTURE_2D, 1 + unit)
        gl.TexParameteri(gl_tokens.TEXTURE_2D, gl_tokens.TEXTURE_MIN_FILTER, gl_tokens.NEAREST)
        gl.TexImage2D(
            *(gl_tokens.TEXTURE_2D, 0, gl_tokens.RGBA, 1, 1, 0, gl_tokens.RGBA, gl_tokens.UNSIGNED_BYTE),
            bytes((1, 2, 3, 4)),
        )
        gl.Enable(gl_tokens.TEXTURE_2D)
    gl.ActiveTexture(gl_tokens.TEXTURE0)
    gl.take_commands()


def _filled(array, count, default):
    if array is None:
        return np.broadcast_to(default, (count, len(default)))
    rest = np.broadcast_to(default[array.shape[1] :], (count, len(default) - array.shape[1]))
    return np.concatenate([array, rest], axis=1)


def vertices(mesh):
    """{column: its numbers, of each vertex in the order in which it is drawn}."""
    count = len(mesh.positions)
    columns = {name: _filled(getattr(mesh, name), count, default) for name, default in _DEFAULTS.items()}
    for unit, array in enumerate(mesh.texture_coordinates):
        columns[f"texture {unit}"] = _filled(array, count, (0.0, 0.0, 0.0, 1.0))
    for name, default in (("fog_coordinates", 0.0), ("weights", 1.0), ("edge_flags", True)):
        array = getattr(mesh, name)
        columns[name] = np.full(count, default) if array is None else array
    order = np.arange(count) if mesh.indices is None else mesh.indices
    return {name: column[order].tolist() for name, column in columns.items()}


def draws(gl):
    """[(primitive, counts, vertices, state)] of the Draws since the last call."""
    commands = [command for command in gl.take_commands() if isinstance(command, Draw)]
    return [(c.mesh.primitive, c.mesh.counts, vertices(c.mesh), c.state) for c in commands]


def meshes(gl):
    """The meshes of the Draws since the last call."""
    return [command.mesh for command in gl.take_commands() if isinstance(command, Draw)]


def counted(gl, kind):
    """[(sentence, how often)] of a kind of outcomes."""
    return [(outcome.what, outcome.count) for outcome in gl.tally.of(kind)]


def refusals(gl):
    """All that did not go well."""
    return [outcome for kind in ("refused", "left out", "error", "unknown") for outcome in counted(gl, kind)]

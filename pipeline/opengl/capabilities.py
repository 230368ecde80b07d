"""Enable, Disable and IsEnabled: the capabilities (OpenGL 1.2.1 tables 6.5 to 6.28).

A capability's value has the key ("enabled", token). For a texture unit it is ("enabled", token, unit).
"""

from fixedpipe.pipeline.opengl import tokens
from fixedpipe.pipeline.opengl.current import COORDINATE_SETS
from fixedpipe.pipeline.opengl.entry_points import entry
from fixedpipe.pipeline.opengl.outcomes import GLError
from fixedpipe.pipeline.opengl.values import VALUES, declare

_OF_UNITS: set[int] = set()
# By a value's key: a function to call with the Context and the new value, before the value is set.
NOTIFIED = {}


def capability(token: int, groups: int = 0, *, initial: bool = False, notify=None) -> None:
    """Declare a capability. ``notify(gl, enabled)`` is called before it changes."""
    declare(("enabled", token), initial, groups | tokens.ENABLE_BIT)
    if notify is not None:
        NOTIFIED["enabled", token] = notify


def unit_capability(token: int) -> None:
    """Declare a capability that each texture unit has."""
    _OF_UNITS.add(token)
    for unit in range(COORDINATE_SETS):
        declare(("enabled", token, unit), False, tokens.TEXTURE_BIT | tokens.ENABLE_BIT)


def key_of(gl, token):
    """The key of a capability. Raises GLError."""
    key = ("enabled", token, gl.values["active_texture"]) if token in _OF_UNITS else ("enabled", token)
    if key not in VALUES:
        raise GLError(tokens.INVALID_ENUM, f"{tokens.name_of(token)} is no capability here")
    return key


def _set(gl, token, enabled):
    from fixedpipe.pipeline.opengl.arrays import ARRAYS, set_array_enabled

    if token in ARRAYS:  # programs for NVIDIA's extensions and EXT_vertex_array enable arrays by Enable
        set_array_enabled(gl, token, enabled)
        return
    key = key_of(gl, token)
    if gl.values[key] is not enabled:
        if key in NOTIFIED:
            NOTIFIED[key](gl, enabled)
        gl.values.set(key, enabled)


@entry("Enable")
def enable(gl, token):
    """Enable a capability."""
    _set(gl, token, True)


@entry("Disable")
def disable(gl, token):
    """Disable a capability."""
    _set(gl, token, False)


@entry("IsEnabled", compiled=False)
def is_enabled(gl, token):
    """Whether a capability is enabled."""
    from fixedpipe.pipeline.opengl.arrays import ARRAYS, is_array_enabled

    if token in ARRAYS:
        return is_array_enabled(gl, token)
    return gl.values[key_of(gl, token)]

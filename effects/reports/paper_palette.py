"""A diagram's colours on white paper: hue and saturation stay, and lightness is reversed.

A diagram's background is dark, as a gallery's page is. On paper that takes ink, and thin light lines blur.
"""

from dataclasses import replace

import numpy as np

from fixedpipe.effects.geometry.views import BACKGROUND
from fixedpipe.effects.reports.letters import is_label
from fixedpipe.pipeline.commands import Clear, Draw

_DARKEST = (max(BACKGROUND) + min(BACKGROUND)) / 2.0


def on_paper(colors):
    """Colours of a diagram on white paper: RGB, float64 [..., 3] in [0, 1], of the same.

    Lightness is that of HSL, the mean of the largest and the least component. The BACKGROUND's becomes 1, and
    white's 0.
    """
    colors = np.asarray(colors, np.float64)
    lightness = 0.5 * (colors.max(axis=-1, keepdims=True) + colors.min(axis=-1, keepdims=True))
    reversed_ = np.clip((1.0 - lightness) / (1.0 - _DARKEST), 0.0, 1.0)
    most, most_now = (1.0 - np.abs(2.0 * each - 1.0) for each in (lightness, reversed_))
    stretched = most_now / np.where(most > 0.0, most, 1.0)
    return np.clip(reversed_ + stretched * (colors - lightness), 0.0, 1.0)


def with_paper_palette(method):
    """The Method in the colours of ``on_paper``: what is cleared, and Draws of one colour and labels.

    A Draw of several colours or with a texture is a shaded picture in the diagram, and stays as it is.
    """

    def scene(*given, **values):
        commands = method.scene(*given, **values)
        return tuple(_ON_PAPER.get(type(command), _as_it_is)(command) for command in commands)

    return replace(method, scene=scene)


def _as_it_is(command):
    return command


def _clear(command):
    return command if command.color is None else replace(command, color=_changed(np.array(command.color)))


def _draw(command):
    if not (is_label(command) or _is_plain(command)):
        return command
    mesh = command.mesh
    return replace(command, mesh=replace(mesh, colors=_changed(np.array(mesh.colors))))


def _is_plain(command):
    colors = command.mesh.colors
    return colors is not None and (colors == colors[0]).all() and not any(command.state.texture_units)


def _changed(colors):
    """RGB or RGBA with other RGB; of a Clear's color a tuple."""
    colors[..., :3] = on_paper(colors[..., :3])
    return tuple(colors.tolist()) if colors.ndim == 1 else colors


_ON_PAPER = {Clear: _clear, Draw: _draw}

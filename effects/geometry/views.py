"""The view of a pass: camera, viewport and scissor, in world coordinates."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from operator import add
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fixedpipe.effects.geometry.matrices import look_at, orthographic, perspective
from fixedpipe.effects.geometry.vectors import normalize, unit_vector
from fixedpipe.pipeline.commands import Clear
from fixedpipe.pipeline.state import Matrix, Scissor, VertexState, Viewport

# What figures and users' pictures are cleared to.
BACKGROUND = (0.07, 0.075, 0.09)


@dataclass(frozen=True)
class Panel:
    """A rectangle of the framebuffer in window coordinates (origin lower left), pixels."""

    x: int
    y: int
    width: int
    height: int

    def __post_init__(self):
        if self.width < 1 or self.height < 1:
            raise ValueError(
                f"A panel of {self.width}x{self.height} pixels shows nothing; give it one or more."
            )

    @property
    def viewport(self) -> Viewport:
        """The viewport that the panel is."""
        return Viewport(self.x, self.y, self.width, self.height)

    @property
    def scissor(self) -> Scissor:
        """The panel as a scissor box for commands without a viewport: Clear, Accum, rectangles of pixels."""
        return Scissor(self.x, self.y, self.width, self.height)

    def clear(self, color: tuple[float, float, float], label: str = "clear colour and depth") -> Clear:
        """Clear the panel's colour (RGB in [0, 1]), destination alpha and depth."""
        return Clear(label=label, color=(*color, 0.0), depth=1.0, scissor=self.scissor)


def panel_width(size: int, aspect: tuple[int, int]) -> int:
    """The width of a panel ``size`` pixels high, by its ``aspect``, width to height: whole pixels, from 1."""
    wide, high = aspect
    return max(1, (2 * size * wide + high) // (2 * high))


def row_of_panels(columns: int, size: int, aspect: tuple[int, int] = (1, 1)) -> tuple[Panel, ...]:
    """Panels side by side, each ``size`` pixels high; ``aspect``: width to height, square ones by default."""
    width = panel_width(size, aspect)
    return tuple(Panel(i * width, 0, width, size) for i in range(columns))


@dataclass(frozen=True)
class View:
    """A camera on a panel.

    ``modelview`` and ``projection`` as in VertexState. ``eye``: the eye's position in world coordinates, or
    the direction to it when ``infinite_viewer``.
    """

    panel: Panel
    modelview: Matrix
    projection: Matrix
    eye: tuple[float, float, float]
    infinite_viewer: bool

    @property
    def vertex(self) -> VertexState:
        """The vertex state of every pass of this view: equal states, so that depths are equal too."""
        return VertexState(self.modelview, self.projection, self.panel.viewport)

    def vertex_with(self, **settings: Any) -> VertexState:
        """The same with more of VertexState: lighting, clip planes."""
        return replace(self.vertex, **settings)

    def view_vectors(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Unit vectors from positions [n, 3] to the eye."""
        if self.infinite_viewer:
            return np.broadcast_to(normalize(np.array(self.eye)), positions.shape)
        return normalize(np.array(self.eye) - positions)


def orthographic_view(panel: Panel, half_height: float = 1.0, depth: float = 4.0) -> View:
    """The world seen along -z by an infinite viewer; ``half_height`` world units above and below the
    centre.
    """
    half_width = half_height * panel.width / panel.height
    projection = orthographic(-half_width, half_width, -half_height, half_height, -depth, depth)
    return View(panel, orthographic(-1, 1, -1, 1, 1, -1), projection, (0.0, 0.0, 1.0), True)


def perspective_view(
    panel: Panel,
    eye: Sequence[float] | NDArray[np.float64],
    center: Sequence[float] | NDArray[np.float64] = (0.0, 0.0, 0.0),
    field_of_view: float = 30.0,
    radius: float = 2.0,
) -> View:
    """A camera at ``eye`` that looks at ``center``; nothing within ``radius`` of the centre is clipped."""
    distance = float(np.sqrt(reduce(add, ((e - c) ** 2 for e, c in zip(eye, center, strict=True)))))
    near, far = max(distance - radius, distance / 64.0), distance + radius
    projection = perspective(field_of_view, panel.width / panel.height, near, far)
    x, y, z = (float(e) for e in eye)
    return View(panel, look_at(eye, center), projection, (x, y, z), False)


@dataclass(frozen=True)
class Light:
    """A white light of intensity one. ``vector``: direction to it, or its position when ``point``; world
    coordinates.
    """

    vector: tuple[float, float, float]
    point: bool = False

    def light_vectors(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Unit vectors from positions [n, 3] to the light."""
        if self.point:
            return normalize(np.array(self.vector) - positions)
        return np.broadcast_to(unit_vector(self.vector, "The light's direction"), positions.shape)


def panel_of(image: NDArray[Any], number: int) -> NDArray[Any]:
    """Panel ``number`` of a row of square panels: [size, size, ...], in the image's order of rows."""
    size = image.shape[0]
    return image[:, number * size : (number + 1) * size]

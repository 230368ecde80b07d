"""Every figure as data: what it shows, where it comes from, what must be seen in it, and checks of it as
code.

A figure's scene is one tuple of commands that draws a row of square panels, so that it can be printed,
validated, rendered on any machine and compared. Document 004's figures F004-2 to F004-4, and demonstrations
of single techniques under their catalogue ids.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from effects import acceptance, scenes
from effects.acceptance import Check, Renderer

__all__ = ["DIFFERENCE_GAIN", "FIGURES", "VIEWS", "Check", "Figure", "Renderer", "difference"]

BACKGROUND = (0.07, 0.075, 0.09)
# Each figure is made three times; "difference" is (machine - ideal) of the same fragments, made visible.
VIEWS = ("machine", "ideal", "difference")
DIFFERENCE_GAIN = 8.0


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure as data.

    id           the catalogue's: F<document>-<number>, or a technique's
    title        what it is, in a few words
    caption      what is shown
    must_see     what must be visible for the figure to be right
    source       key in docs/bibliography.bib
    techniques   the catalogue's ids of the techniques used
    columns      how many square panels side by side
    size         default edge of a panel, pixels
    parameters   the scene's numbers; any may be given to ``scene`` again
    scene        (profile, size, **parameters) -> tuple of commands for a framebuffer of ``dimensions(size)``
    acceptance   (figure, Renderer) -> tuple of Check
    """

    id: str
    title: str
    caption: str
    must_see: str
    source: str
    techniques: tuple[str, ...]
    columns: int
    size: int = 512
    parameters: Mapping = field(default_factory=dict)
    scene: Callable
    acceptance: Callable

    def __post_init__(self):
        object.__setattr__(self, "parameters", MappingProxyType(dict(self.parameters)))

    def dimensions(self, size=None):
        """Width and height of the framebuffer in pixels for panels of ``size``."""
        edge = self.size if size is None else size
        return self.columns * edge, edge

    def commands(self, profile, size=None, **parameters):
        """The scene with the figure's own parameters, some replaced."""
        return self.scene(profile, self.size if size is None else size, **{**self.parameters, **parameters})

    def checks(self, renderer):
        """The figure's acceptance checks, rendered by a ``Renderer``: a tuple of Check."""
        return self.acceptance(self, renderer)


def difference(machine, ideal, gain=DIFFERENCE_GAIN):
    """(machine - ideal) made visible: uint8 RGBA, middle grey where equal, lighter where the machine is
    lighter.

    ``machine``: uint8 [h, w, 4]; ``ideal``: float64 [h, w, 4], 1.0 = full. A difference of one byte is
    ``gain`` bytes.
    """
    delta = np.asarray(machine[..., :3], np.float64) - 255.0 * np.clip(ideal[..., :3], 0.0, 1.0)
    out = np.full(machine.shape, 255, np.uint8)
    out[..., :3] = np.clip(np.floor(128.0 + gain * delta + 0.5), 0, 255)
    return out


_FIGURES = (
    Figure(
        id="F004-2",
        title="Rings from interpolating tangents before they are used",
        caption=(
            "Domes with a crease at their rim, in the anisotropic Blinn-Phong model. Left: evaluated at the "
            "texels and interpolated afterwards, in float. Right: register combiners, which interpolate "
            "tangents and binormals first."
        ),
        must_see=(
            "The highlights on the domes are alike left and right; only on the right do bright rings follow "
            "the rims on the side of the light."
        ),
        source="KautzSeidel2000",
        techniques=("K07", "K10", "K16"),
        columns=2,
        parameters={
            "map_size": 64,
            "alpha_x": 0.25,
            "alpha_y": 1.0,
            "domes": 2,
            "extent": 0.9,
            "diffuse": (0.36, 0.40, 0.50),
            "ambient": (0.04, 0.045, 0.06),
            "specular": (0.9, 0.9, 0.85),
            "background": BACKGROUND,
        },
        scene=scenes.domes_scene,
        acceptance=acceptance.domes_checks,
    ),
    Figure(
        id="F004-3",
        title="One square with scratches along both axes, three lights",
        caption=(
            "A single square whose material textures hold scratches along both axes, lit from +x (left), "
            "from +y (middle) and from the top (right)."
        ),
        must_see=(
            "Lit from one side, only the scratches across the light's direction are seen; lit from the top, "
            "both sets are."
        ),
        source="KautzSeidel2000",
        techniques=("K07", "K10", "K21"),
        columns=3,
        parameters={
            "seed": 7,
            "count": 30,
            "elevation": 20.0,
            "extent": 0.9,
            "diffuse": (0.28, 0.32, 0.38),
            "ambient": (0.05, 0.055, 0.07),
            "specular": (1.0, 0.97, 0.90),
            "background": BACKGROUND,
        },
        scene=scenes.scratches_scene,
        acceptance=acceptance.scratches_checks,
    ),
    Figure(
        id="F004-4",
        title="Two spheres brushed in different directions",
        caption=(
            "A sphere brushed along its meridians and one brushed along its parallels, 2500 triangles each."
        ),
        must_see=(
            "The highlight of either sphere is drawn out across its strokes; the two highlights lie at right "
            "angles, and single strokes are seen in both."
        ),
        source="KautzSeidel2000",
        techniques=("K07", "K10", "K21"),
        columns=2,
        parameters={
            "slices": 50,
            "stacks": 26,
            "map_columns": 512,
            "map_rows": 256,
            "spread": 8.0,
            "depth": 0.25,
            "k_s": (0.5, 1.0),
            "alpha_x": 0.25,
            "alpha_y": 1.0,
            "tilt": 6.0,
            "light": (0.40, 0.30, 0.87),
            "radius": 0.92,
            "diffuse": (0.30, 0.33, 0.40),
            "ambient": (0.03, 0.03, 0.04),
            "specular": (0.85, 0.85, 0.82),
            "background": BACKGROUND,
        },
        scene=scenes.brushed_spheres_scene,
        acceptance=acceptance.brushed_spheres_checks,
    ),
    Figure(
        id="K02",
        title="Gloss map",
        caption=(
            "A bumpy sphere with k_s constant (left) and from a checkered gloss map (right); one exponent."
        ),
        must_see=(
            "The same highlight, cut out by the checks on the right; the sharpness is the same everywhere."
        ),
        source="KautzSeidel2000",
        techniques=("K02", "K14"),
        columns=2,
        parameters={
            "cells": 12,
            "depth": 0.25,
            "dull": 0.1,
            "polished": 1.0,
            "light": (0.6, 0.5, 0.5),
            "diffuse": (0.12, 0.22, 0.24),
            "ambient": (0.02, 0.03, 0.04),
            "background": BACKGROUND,
        },
        scene=scenes.gloss_scene,
        acceptance=acceptance.gloss_checks,
    ),
    Figure(
        id="K11",
        title="Local and global frame",
        caption=(
            "A sphere brushed along its parallels, its material textures in the local frame (left) and baked "
            "in world coordinates (right)."
        ),
        must_see="The same picture twice.",
        source="KautzSeidel2000",
        techniques=("K11", "K07", "K10"),
        columns=2,
        parameters={
            "spread": 8.0,
            "alpha_x": 0.3,
            "alpha_y": 1.0,
            "slices": 50,
            "stacks": 26,
            "light": (0.35, 0.45, 0.82),
            "diffuse": (0.30, 0.17, 0.10),
            "ambient": (0.04, 0.02, 0.02),
            "specular": (1.0, 0.82, 0.68),
            "background": BACKGROUND,
        },
        scene=scenes.frames_scene,
        acceptance=acceptance.frames_checks,
    ),
    Figure(
        id="K12",
        title="Normalization cube map",
        caption=(
            "A single bumpy square under a light close above it. Left: light and halfway vectors as vertex "
            "colours, which lose length in the middle. Right: vectors from the normalization cube map."
        ),
        must_see=(
            "On the right a bright pool of light below the lamp; on the left the square is dull there."
        ),
        source="KautzSeidel2000",
        techniques=("K12", "K07", "K10"),
        columns=2,
        parameters={
            "cube_map_size": 64,
            "light": (0.0, 0.0, 0.7),
            "cells": 10,
            "depth": 0.15,
            "alpha_x": 0.4,
            "alpha_y": 0.4,
            "diffuse": (0.55, 0.42, 0.28),
            "ambient": (0.03, 0.03, 0.03),
            "specular": (0.5, 0.5, 0.5),
            "background": BACKGROUND,
        },
        scene=scenes.normalization_scene,
        acceptance=acceptance.normalization_checks,
    ),
    Figure(
        id="K14",
        title="Dot-product bump mapping",
        caption=(
            "A pebbled torus with a diffuse pass and a Blinn-Phong highlight of exponent 8, squared three "
            "times."
        ),
        must_see=(
            "Pebbles lit from the upper right with soft highlights; no seams round the tube or the axis."
        ),
        source="Kilgard2000",
        techniques=("K14", "K10"),
        columns=1,
        parameters={
            "cells": 6,
            "depth": 0.8,
            "tilt": 50.0,
            "light": (0.6, 0.6, 0.5),
            "diffuse": (0.42, 0.28, 0.17),
            "ambient": (0.04, 0.03, 0.03),
            "background": BACKGROUND,
        },
        scene=scenes.dot_product_scene,
        acceptance=acceptance.dot_product_checks,
    ),
)

# By id, in the catalogue's order.
FIGURES = MappingProxyType({figure.id: figure for figure in _FIGURES})

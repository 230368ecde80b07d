"""F001-10 to F001-13: a bumpy mirror in a row of panels, each antialiased in another way.

Two methods draw them. One computes them in floats, as the paper did, and shows them as a picture. The other
uses texture shaders, in passes (``rough_mirror_passes``).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fixedpipe.effects.environment_maps import rough_mirror_passes
from fixedpipe.effects.environment_maps.rough_mirrors import Antialiasing
from fixedpipe.effects.figures.figure import Method
from fixedpipe.effects.geometry.views import Panel, View, panel_width, row_of_panels
from fixedpipe.effects.passes.draws import REPEATED

SOFTWARE, PASSES = "computed, shown as a picture", "texture shaders, a pass for each roughness"


@dataclass(frozen=True)
class Subject:
    """What the panels show.

    values      (**parameters) -> what the other functions take as ``values``
    parameters  a figure's
    aspect      a panel's width to its height
    camera      (panel) -> its View
    truth       (values, view) -> 256 samples a pixel: float64 [height, width, 3]
    answer      (values, view, Antialiasing) -> the same, antialiased in that way
    shown       (picture, panel, name, profile) -> commands that show a picture on a panel
    load        (values, height, profile) -> commands for texture shaders, and what they store
    drawn       (values, panel, stored, Antialiasing) -> commands that draw a panel by texture shaders
    """

    values: Callable[..., Any]
    parameters: dict[str, Any]
    aspect: tuple[int, int]
    camera: Callable[[Panel], View]
    truth: Callable[..., Any]
    answer: Callable[..., Any]
    shown: Callable[..., Any]
    load: Callable[..., Any]
    drawn: Callable[..., Any]

    def row(self, ways, passes=PASSES):
        """The arguments of a Figure: panels, aspect, parameters, methods and the reference.

        ways    the name and the Antialiasing of each panel; None: 256 samples a pixel, computed by the host
        passes  the name of the method by texture shaders
        """

        def panels(size):
            return zip(row_of_panels(len(ways), size, self.aspect), ways.items(), strict=True)

        def software(profile, size, **parameters):
            """Computed in floats, and shown."""
            values, view, out = self.values(**parameters), self.at_origin(size), []
            for panel, (name, way) in panels(size):
                picture = self.truth(values, view) if way is None else self.answer(values, view, way)
                out += self.shown(picture, panel, name, profile)
            return tuple(out)

        def by_passes(profile, size, **parameters):
            """By texture shaders; what they are compared with is computed."""
            values = self.values(**parameters)
            loading, stored = self.load(values, size, profile)
            out = [*loading]
            for panel, (name, way) in panels(size):
                if way is None:
                    out += self.shown(self.truth(values, self.at_origin(size)), panel, name, profile)
                else:
                    out += self.drawn(values, panel, stored, way)
            return tuple(out)

        def reference(size, **parameters):
            """256 samples a pixel, in every panel."""
            return with_panels(self.truth(self.values(**parameters), self.at_origin(size)), len(ways))

        return {
            "panels": tuple(ways),
            "aspect": self.aspect,
            "parameters": self.parameters,
            "methods": (
                Method(SOFTWARE, software, ("GEFORCE_256",)),
                Method(passes, by_passes, ("GEFORCE_3", "NV2A")),
            ),
            "reference": reference,
        }

    def at_origin(self, height):
        """The camera of a panel alone, ``height`` pixels high."""
        return self.camera(Panel(0, 0, panel_width(height, self.aspect), height))

    def panel(self, image, number):
        """Panel ``number`` of a row: [height, width, 3]."""
        width = panel_width(image.shape[0], self.aspect)
        return image[:, number * width : (number + 1) * width]


def with_panels(picture, count):
    """A picture [height, width, 3], bottom row first, in each of so many panels, as a figure's reference."""
    rgba = np.concatenate([picture, np.ones_like(picture[..., :1])], axis=-1)
    return np.tile(rgba[::-1], (1, count, 1))


def draws(surface, stored, view, antialiasing, bias=0.0):
    """A surface by texture shaders; ``bias``: of the bump map's level, where its roughness is drawn."""
    if antialiasing is Antialiasing.ANISOTROPIC:
        return rough_mirror_passes.rough_passes(surface, stored, view, bias=bias)
    sampler = () if antialiasing is Antialiasing.MIP else (REPEATED,)
    return (rough_mirror_passes.plain_pass(surface, stored, view, *sampler),)

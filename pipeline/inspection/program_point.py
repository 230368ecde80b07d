"""The commands that draw one fragment with given inputs by register combiners."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fixedpipe.pipeline.commands import Clear, Command, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import PrimitiveType, TextureFilter
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.state import PassState, RegisterCombiners, Sampler, TextureUnit
from fixedpipe.pipeline.textures.images import texture_2d


def program_point(
    combiners: RegisterCombiners, machine: Profile, values: Mapping[str, Any]
) -> tuple[Command, ...]:
    """The commands that draw a point of one pixel; each of its texture units holds one texel.

    values  {register: four bytes} for t0 to t3, v0 and v1, the primary and the secondary color. Texture units
            that the machine lacks are left out
    """
    units = [f"t{unit}" for unit in range(min(4, machine.textures.max_texture_units))]
    nearest = Sampler(TextureFilter.NEAREST, TextureFilter.NEAREST)
    mesh = Mesh(
        np.zeros((1, 3)),
        PrimitiveType.POINTS,
        colors=np.array([values["v0"]]) / 255,
        secondary_colors=np.array([values["v1"]]) / 255,
        texture_coordinates=(np.zeros((1, 2)),) * len(units),
    )
    state = PassState(
        texture_units=tuple(TextureUnit(name, nearest) for name in units), register_combiners=combiners
    )
    textures = [
        TexImage(label=name, texture=name, image=texture_2d(np.array([[values[name]]], np.uint8)))
        for name in units
    ]
    return Clear(label="clear"), *textures, Draw(label="point", mesh=mesh, state=state)

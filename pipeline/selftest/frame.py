"""A frame of the self-test, and a window of patches, one for each state."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from fixedpipe.pipeline.commands import Clear, Command, Draw, Mesh, TexImage
from fixedpipe.pipeline.enums import ComparisonFunction
from fixedpipe.pipeline.profiles.profile import Profile
from fixedpipe.pipeline.selftest.shapes import ACROSS, PATCH, patch
from fixedpipe.pipeline.state import DepthTest, PassState
from fixedpipe.pipeline.textures.images import Texture

# The size of most frames: two bands of rows and part of a third, so that up to three threads share them.
WIDTH, HEIGHT = ACROSS * PATCH, 66
SIZE = WIDTH, HEIGHT
# The number of patches in a window.
PATCHES = ACROSS * (HEIGHT // PATCH)


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """A frame of the self-test.

    - ``name``: its name among the accepted digests.
    - ``profile``: the machine.
    - ``commands``: the commands that are drawn.
    - ``size``: (width, height) of the framebuffer, in pixels.
    - ``window``: other arguments of ``Machine``: ``depth_bits``, ``samples``, ``color_bits``.
    """

    name: str
    profile: Profile
    commands: tuple[Command, ...]
    size: tuple[int, int] = SIZE
    window: dict[str, Any] = field(default_factory=dict)


def stores(**textures: Texture) -> tuple[TexImage, ...]:
    """The textures as texture objects, named by their keywords."""
    return tuple(TexImage(label="store", texture=name, image=image) for name, image in textures.items())


def background(depth_test: DepthTest | None = None) -> tuple[Command, ...]:
    """A cleared window with contents in all of its buffers; colours and depths differ from pixel to pixel."""
    corners = [[-1.0, -1.0, 0.9], [3.0, -1.0, -0.7], [-1.0, 3.0, 0.4]]
    colors = [[0.9, 0.2, 0.1, 1.0], [0.1, 0.8, 0.3, 0.1], [0.2, 0.3, 0.9, 0.6]]
    mesh = Mesh(corners, colors=colors)
    state = PassState(depth_test=depth_test or DepthTest(ComparisonFunction.ALWAYS))
    return (
        Clear(label="clear", color=(0.25, 0.5, 0.75, 0.5), depth=1.0, stencil=5),
        Draw(label="background", mesh=mesh, state=state),
    )


def patched(states: Iterable[PassState]) -> tuple[Draw, ...]:
    """A Draw for each state, in the window's patches one after the other, then over them again."""
    return tuple(
        Draw(label=f"patch {number}", mesh=patch(number % PATCHES, SIZE), state=state)
        for number, state in enumerate(states)
    )

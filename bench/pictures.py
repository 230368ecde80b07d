"""Whether both parties draw the same picture, to within what their arithmetic explains."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image


@dataclass(frozen=True)
class Difference:
    """How two pictures of a scene differ.

    color          largest difference of a component, in levels of 255
    beyond         pixels with a component further apart than the scene's ``levels``
    depth          largest difference, in units of the 24-bit buffer, where both or neither is covered
    stencil        largest difference
    coverage       pixels that only one party drew, as the depth buffer tells
    pixels         pixels of the picture
    """

    color: int
    beyond: int
    depth: int
    stencil: int
    coverage: int
    pixels: int

    def as_expected(self, scene):
        """Whether the two drew the same, to within what ``scene`` says of colours."""
        return self.beyond <= scene.outside * self.pixels and self.stencil == 0


def difference(ours, theirs, levels):
    """Compare two parties' ``picture()``; ``levels`` is what the scene expects at most."""
    color = np.abs(ours["color"].astype(np.int64) - theirs["color"]).max(-1)
    depth = np.abs(ours["depth"].astype(np.int64) - theirs["depth"])
    stencil = np.abs(ours["stencil"].astype(np.int64) - theirs["stencil"])
    far = 2**24 - 1
    same_coverage = (ours["depth"] == far) == (theirs["depth"] == far)
    return Difference(
        color=int(color.max()),
        beyond=int((color > levels).sum()),
        depth=int(depth[same_coverage].max(initial=0)),
        stencil=int(stencil.max()),
        coverage=int((~same_coverage).sum()),
        pixels=color.size,
    )


def save(folder, scene, pictures):
    """Write ``{party: picture}`` as ``<scene>-<party>.png`` and, for two, eight times their difference.

    A scene that writes no colour is shown by its stencil buffer. Raises OSError if it cannot write.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    images = {}
    for party, picture in pictures.items():
        mask = scene.draw(scene.size).state.color_mask
        writes_color = mask.red or mask.green or mask.blue
        images[party] = picture["color"][..., :3] if writes_color else picture["stencil"]
    if len(images) == 2:
        one, other = images.values()
        apart = np.abs(one.astype(np.int64) - other)
        images["difference-x8"] = np.minimum(8 * apart, 255).astype(np.uint8)
    for party, image in images.items():
        Image.fromarray(np.ascontiguousarray(image)).save(folder / f"{scene.name}-{party}.png")

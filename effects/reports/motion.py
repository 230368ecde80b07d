"""A figure in motion, for the gallery: a small animation with losses.

``fixedpipe animate`` writes it without losses, in any size.
"""

import hashlib
import io

from PIL import Image

from fixedpipe.effects.presentation.animations import ANIMATIONS
from fixedpipe.effects.presentation.variation import frames_of, pictures_of
from fixedpipe.pipeline.profiles import PROFILES

# Height of a panel at most, pixels, and frames at most: what shows the motion in some 200 kB.
_PANEL, _FRAMES = 160, 24
# Quality of WebP. Assumed: enough to see what moves.
_QUALITY = 50


def in_motion(figure, machine, size, threads=None):
    """(the bytes of an animated WebP file, its entry in the record) for a figure's declared animation.

    figure   a Figure whose id is in ANIMATIONS
    machine  a key in PROFILES that can draw it
    size     the height of the panels of its still pictures; the animation's are no larger
    threads  as for ``Figure.render``

    Raises Refusal or ValueError as ``Figure.render`` does.
    """
    declared, method = ANIMATIONS[figure.id], figure.method(machine)
    count = min(_FRAMES, declared.count or _FRAMES) if declared.tracks else None
    frames = frames_of(figure, method, declared.tracks, declared.bits, count)
    given = figure, PROFILES[machine], frames, min(size, _PANEL)
    images = [Image.fromarray(one) for one in pictures_of(*given, method=method, threads=threads)]
    rate = declared.frames_a_second
    if count and declared.count:  # fewer frames in the same time
        rate *= count / declared.count
    buffer = io.BytesIO()
    images[0].save(
        buffer, "WEBP", save_all=True, append_images=images[1:], duration=round(1000 / rate), loop=0,
        quality=_QUALITY, method=4,
    )  # fmt: skip
    data = buffer.getvalue()
    width, height = images[0].size
    said = {"digest": hashlib.sha256(data).hexdigest()[:16], "does": declared.does, "frames": len(images)}
    return data, said | {"width": width, "height": height, "bytes": len(data), "profile": machine}

"""One figure, rendered three times, as the bytes of its files."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass

import numpy as np

from effects.cli.files import png
from effects.cli.refusal import refusals
from effects.figures import DIFFERENCE_GAIN, Renderer, difference
from pipeline.execute import execute
from pipeline.golden import digest
from pipeline.ideal import execute_ideal
from pipeline.profiles import IDEAL
from pipeline.provenance import provenance

# What each of the three pictures is, in the words of its caption.
PICTURES = {
    "machine": "{profile}, bit for bit",
    "ideal": "the same fragments in float64",
    "difference": f"(machine - ideal) x {DIFFERENCE_GAIN:g} about middle grey",
}


@dataclass(frozen=True)
class Rendered:
    """What a figure writes: ``files``, file name to bytes, and ``record``, the content of its JSON file."""

    files: Mapping[str, bytes]
    record: dict


def render(figure, profile_key, profile, size, threads, with_checks, step):
    """Render a figure.

    Parameters
    ----------
    figure : effects.figures.Figure
    profile_key, profile
        The machine and its key in ``pipeline.profiles.PROFILES``.
    size : int or None
        Edge of a panel in pixels; None: the figure's own.
    threads : int or None
    with_checks : bool
        Run the acceptance checks as well.
    step
        Called with a line of text at the beginning of each step.

    Raises Refusal for what the machine cannot hold.
    """
    size = size or figure.size
    width, height = figure.dimensions(size)
    step(f"{figure.id}: on the {profile.name}, {width}x{height}")
    with refusals():
        commands = figure.commands(profile, size)
        # The run that records what the ideal is guided by draws the picture as well.
        guide = execute(commands, profile, width, height, threads=threads, record=True)
        color = guide.framebuffer.color
        step(f"{figure.id}: on the ideal")
        ideal = execute_ideal(figure.commands(IDEAL, size), width, height, guide=guide, threads=threads)
    images = {"machine": color, "ideal": ideal.image(), "difference": difference(color, ideal.color)}
    checks = ()
    if with_checks:
        step(f"{figure.id}: acceptance checks")
        checks = figure.checks(Renderer(profile, execute, execute_ideal))
    step(f"{figure.id}: writing")
    error = color[..., :3] / 255.0 - np.clip(ideal.color[..., :3], 0.0, 1.0)
    pictures = {name: f"{figure.id}-{name}.png" for name in images}
    record = {
        "id": figure.id,
        "title": figure.title,
        "caption": figure.caption,
        "must_see": figure.must_see,
        "source": figure.source,
        "techniques": list(figure.techniques),
        "parameters": dict(figure.parameters),
        "profile": profile_key,
        "size": size,
        "width": width,
        "height": height,
        "sha256": digest(color),
        "difference_gain": DIFFERENCE_GAIN,
        "difference_rms": float(np.sqrt((error * error).mean())),
        "difference_max": float(np.abs(error).max()),
        "pictures": {
            name: {"file": file, "caption": PICTURES[name].format(profile=profile.name)}
            for name, file in pictures.items()
        },
        "checks": [asdict(c) | {"value": float(c.value), "passed": bool(c.passed)} for c in checks],
        "provenance": provenance(profile),
    }
    files = {pictures[name]: png(image) for name, image in images.items()}
    files[f"{figure.id}.json"] = (json.dumps(record, indent=2) + "\n").encode()
    return Rendered(files, record)

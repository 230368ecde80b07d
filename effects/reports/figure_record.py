"""One figure on its machines, rendered three times on each, as the bytes of its files."""

import hashlib
import json
import re
from collections.abc import Mapping
from dataclasses import dataclass

from fixedpipe.effects.acceptance.check import Answer, Check
from fixedpipe.effects.figures import Renderer
from fixedpipe.effects.refusal import refusals
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.framebuffers.pictures import png
from fixedpipe.pipeline.golden.digests import digest
from fixedpipe.pipeline.golden.provenance import provenance
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import PROFILES

# What each of the three pictures is, in the words of its caption.
PICTURES = {
    "machine": "{profile}, {method}, bit for bit",
    "ideal": "the same fragments in float64",
    "difference": "{difference}",
}


@dataclass(frozen=True)
class Rendered:
    """What a figure writes: ``files``, file name to bytes, and ``record``, the content of its JSON file."""

    files: Mapping[str, bytes]
    record: dict


def variant_name(figure, changes):
    """What a figure is called with other values of parameters: F004-4+alpha_x=0.15+light=1,1,1; its id where
    nothing is changed. Its files begin with it, so long or odd values are a digest there.
    """
    if not changes:
        return figure.id
    said = "+".join(f"{name}={text}" for name, text in _texts(figure, changes).items())
    if len(said) > 100 or re.search(r"[^\w.,=+-]", said):
        said = hashlib.sha256(said.encode()).hexdigest()[:16]
    return f"{figure.id}+{said}"


_PLAIN = (bool, int, float, str, tuple)


def _texts(figure, changes):
    """Changed values as the command line takes them, by name."""
    known = {name: p for method in figure.methods for name, p in figure.parameters_of(method).items()}
    return {name: known[name].kind.show(value) for name, value in changes.items()}


def picture_name(name, machine, view):
    """The file name of a picture: F004-4-OCTANE.png, F004-4-OCTANE-ideal.png ..."""
    return f"{name}-{machine}{'' if view == 'machine' else f'-{view}'}.png"


def steps(machines, with_checks):
    """How many steps ``render`` takes for so many machines."""
    return (3 + with_checks) * machines


def render(figure, machines, size, threads, with_checks, step, changes=None):
    """Render a figure.

    Parameters
    ----------
    figure : fixedpipe.effects.figures.Figure
    machines : tuple of str
        Keys in ``fixedpipe.pipeline.profiles.PROFILES``, of those that can draw it.
    size : int or None
        Edge of a panel in pixels; None: the figure's own.
    threads : int or None
    with_checks : bool
        Run the acceptance checks as well.
    step
        Called with a line of text at the beginning of each step.
    changes : dict, optional
        Other values of parameters, by name: a variant, whose files and record have a name of their own and
        say what was changed. Its acceptance is nobody's: checks hold for the figure's own values.

    Raises Refusal for what a machine cannot hold.
    """
    size = size or figure.size
    width, height = figure.dimensions(size)
    files, drawn, kept, checked, changes = {}, [], {}, set(), changes or {}
    name = variant_name(figure, changes)
    for machine in machines:
        pictures, record = _on_machine(figure, machine, size, threads, step, changes)
        files |= {picture_name(name, machine, view): png(image) for view, image in pictures.items()}
        if with_checks:
            step(f"{figure.id}: acceptance checks on the {PROFILES[machine].name}")
            method = figure.method(machine)
            checks = _checks(figure, Renderer(PROFILES[machine], method, execute, execute_ideal, kept))
            record["checks"] = [c.record() for c in checks if c.on is Answer.MACHINE or method not in checked]
            checked.add(method)
        drawn.append(record)
    record = {
        "id": name,
        "title": figure.title,
        "caption": figure.caption,
        "must_see": figure.must_see,
        "source": figure.source,
        "techniques": list(figure.techniques),
        "parameters": dict(figure.values),
        "size": size,
        "width": width,
        "height": height,
        "machines": drawn,
    }
    if changes:
        # What must be seen is of the figure's own values.
        del record["must_see"]
        texts = _texts(figure, changes)
        # Numbers as numbers; what JSON has no form for, a height field, as the command line takes it.
        plain = {n: v if isinstance(v, _PLAIN) else texts[n] for n, v in changes.items()}
        record |= {"figure": figure.id, "set": plain}
    files[f"{name}.json"] = (json.dumps(record, indent=2) + "\n").encode()
    return Rendered(files, record)


def _checks(figure, renderer):
    """The figure's acceptance checks; where they end in an error, one that failed and has it as its reason:
    the other machines and figures are drawn all the same.
    """
    try:
        return figure.checks(renderer)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        return (Check("errors of the checks themselves", 1.0, at_most=0.0, on=Answer.MACHINE, reason=reason),)


def _on_machine(figure, machine, size, threads, step, changes):
    """Its three pictures by view, and what the record says of them."""
    profile, (width, height) = PROFILES[machine], figure.dimensions(size)
    name, texts = variant_name(figure, changes), _texts(figure, changes)
    changed = "".join(f"; {key} = {text}" for key, text in texts.items())
    if profile.arithmetic.exact:
        return _by_the_ideal(figure, machine, size, threads, step, changes)
    step(f"{name}: on the {profile.name}, {width}x{height}")
    with refusals():
        drawn = figure.render(machine, size, threads=threads, **changes)
        step(f"{name}: the same on the ideal")
        pictures = {"machine": drawn.image(), "ideal": drawn.ideal.image()}
    step(f"{name}: writing")
    pictures["difference"] = drawn.difference.image()
    difference = f"(machine - ideal) x {drawn.gain} about middle grey"
    if drawn.difference.identical:
        difference = "identical: no code of the machine differs from the ideal's, rounded"
    record = {
        "profile": machine,
        "method": drawn.method.name,
        "parameters": _own_values(drawn.method),
        "sha256": digest(pictures["machine"]),
        "difference_rms": drawn.difference.rms,
        "difference_max": drawn.difference.largest,
        "pictures": {
            view: {
                "file": picture_name(name, machine, view),
                "caption": caption.format(
                    profile=profile.name, method=drawn.method.name, difference=difference
                )
                + changed,
            }
            for view, caption in PICTURES.items()
        },
        "checks": [],
        "provenance": provenance(profile),
    }
    return pictures, record


def _by_the_ideal(figure, machine, size, threads, step, changes):
    """The one picture of the ideal by itself, with its own tests of depth and stencil, and its record."""
    profile, (width, height) = PROFILES[machine], figure.dimensions(size)
    name, texts = variant_name(figure, changes), _texts(figure, changes)
    step(f"{name}: by the ideal, {width}x{height}")
    with refusals():
        drawn = figure.render(machine, size, threads=threads, **changes)
    step(f"{name}: rounding to bytes")
    image = drawn.image()
    step(f"{name}: writing")
    caption = f"{profile.name}, {drawn.method.name}: float64, rounded to bytes at the end"
    caption += "".join(f"; {key} = {text}" for key, text in texts.items())
    record = {
        "profile": machine,
        "method": drawn.method.name,
        "parameters": _own_values(drawn.method),
        "sha256": digest(image),
        "difference_rms": 0.0,
        "difference_max": 0.0,
        "pictures": {"ideal": {"file": picture_name(name, machine, "machine"), "caption": caption}},
        "checks": [],
        "provenance": provenance(profile),
    }
    return {"machine": image}, record


def _own_values(method):
    """What of the parameters' values is the method's, by name."""
    return {**method.values, **{name: p.default for name, p in method.parameters.items()}}

"""Wrong pictures of figures, which their checks must refuse: ``python -m tests.wrong_pictures ID ...``.

Each Mutation changes one thing of what a figure draws: its commands, as its scenes return them, or its
window. All that the figure's checks draw by ``Figure.commands`` is changed alike, for the machine and for the
ideal, at any size and with any parameters. What checks draw without the figure, their references, stays
right. The first check that fails catches the mutation. A mutation that no check fails survives.

A mutation counts as a wrong picture where it changes the picture that is displayed, the figure's own on its
first machine, by more than LEAST somewhere. What it draws may also be no picture: then it is caught.

Commands that a HostStep returns, and images of client memory (``TexImage.pixels``), are not changed.
"""

import argparse
import sys
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import wraps

import numpy as np

from fixedpipe.effects.figures import FIGURES, Figure, Renderer
from fixedpipe.effects.figures.figure import _REFERENCES
from fixedpipe.effects.figures.heidrich_2000 import f002_01_with_and_without_scattering as f002_01
from fixedpipe.effects.figures.heidrich_2000 import f002_10_three_spheres as f002_10
from fixedpipe.effects.figures.heidrich_2000 import f002_13_terrain as f002_13
from fixedpipe.effects.figures.heidrich_2000.shared import backyard
from fixedpipe.effects.figures.heidrich_2001 import f000_05_fresnel_mirrors as f000_05
from fixedpipe.effects.figures.heidrich_2001 import f000_09_bump_map_with_shadows as f000_09
from fixedpipe.effects.scattering import turning_sun
from fixedpipe.effects.tasks.executors import opened
from fixedpipe.effects.tasks.manifest import Manifest
from fixedpipe.effects.tasks.ordered import in_order
from fixedpipe.effects.tasks.task import Task
from fixedpipe.pipeline.commands import Draw, TexImage
from fixedpipe.pipeline.enums import InternalFormat, TextureTarget
from fixedpipe.pipeline.execution.machine import execute
from fixedpipe.pipeline.ideal.evaluate import execute_ideal
from fixedpipe.pipeline.profiles import PROFILES
from tests.support.inputs import inputs_here

# A change of the picture from which it is wrong, 1 = full.  Inferred: a byte's rounding, which a highlight's
# eighth power multiplies by eight (effects/acceptance/measures.py), moves a right picture as far.
LEAST = 8.0 / 255.0
# With more passes than these, those of one label are left out together.  Assumed: a figure's checks take
# seconds, and are run for each.
MOST_PASSES = 24
# Texels that are no components to take the mean of: depths, and words of two bytes.
_WORDS = ("DEPTH_COMPONENT", "HILO", "SIGNED_HILO")


def _same(given):
    return given


@dataclass(frozen=True)
class Mutation:
    """One thing that is wrong.

    name      what it is, in words
    commands  a scene's commands to the wrong ones
    window    a window, RGB float64 [height, width, 3], to the wrong one
    """

    name: str
    commands: Callable = _same
    window: Callable = _same


class _WrongWindows(Renderer):
    """A Renderer whose windows a Mutation changes."""

    def __init__(self, wrong, *values):
        super().__init__(*values)
        object.__setattr__(self, "wrong", wrong)

    def machine_window(self, figure, size, /, **changes):
        return self.wrong(super().machine_window(figure, size, **changes))

    def ideal_window(self, figure, size, /, **changes):
        return self.wrong(super().ideal_window(figure, size, **changes))


def wrong_figure(figure: Figure, mutation: Mutation) -> Figure:
    """The figure whose scenes draw what the mutation makes of them."""

    def wrong(scene):
        @wraps(scene)
        def changed(*values, **parameters):
            return mutation.commands(scene(*values, **parameters))

        return changed

    return replace(figure, methods=tuple(replace(m, scene=wrong(m.scene)) for m in figure.methods))


def _renderer(figure, machine, mutation):
    return _WrongWindows(mutation.window, PROFILES[machine], figure.method(machine), execute, execute_ideal)


# ------------------------------------------------------------------------------------------- mutations


def _numbered(commands):
    """Each command with how many Draws of its label stand before it."""
    before: Counter[str] = Counter()
    for command in commands:
        yield command, before[command.label]
        before[command.label] += isinstance(command, Draw)


def _without(label, number):
    def left_out(commands):
        return tuple(
            c for c, n in _numbered(commands)
            if not (isinstance(c, Draw) and c.label == label and number in (None, n))
        )  # fmt: skip

    return left_out


def _textures(change, names=None):
    """Commands whose textures, those of some names, are changed level by level: ``change`` takes a level
    [faces, height, width, 4] and the texture's target.
    """

    def changed(levels, target):
        return None if levels is None else tuple(change(level, target) for level in levels)

    def texture(command):
        if not isinstance(command, TexImage) or command.image is None:
            return command
        if names is not None and command.texture not in names:
            return command
        image = command.image
        image = replace(
            image, levels=changed(image.levels, image.target), ideal=changed(image.ideal, image.target)
        )
        return replace(command, image=image)

    return lambda commands: tuple(map(texture, commands))


def _flat(level, target):
    mean = level.mean(axis=(0, 1, 2))
    mean = np.floor(mean + 0.5) if level.dtype.kind == "u" else mean
    return np.broadcast_to(mean.astype(level.dtype), level.shape).copy()


def _upside_down(level, target):
    opposite = [1, 0, 3, 2, 5, 4]
    return level[opposite] if target is TextureTarget.TEXTURE_CUBE_MAP else level[:, ::-1].copy()


def _meshes(change):
    def changed(command):
        return replace(command, mesh=change(command)) if isinstance(command, Draw) else command

    return lambda commands: tuple(map(changed, commands))


def _transposed(draw):
    def swapped(coordinates):
        if coordinates.shape[1] < 2:
            return coordinates
        return np.concatenate([coordinates[:, 1::-1], coordinates[:, 2:]], axis=1)

    return replace(draw.mesh, texture_coordinates=tuple(map(swapped, draw.mesh.texture_coordinates)))


def _inward(draw):
    mesh = draw.mesh
    if draw.state.vertex.lighting is None or mesh.normals is None:
        return mesh
    return replace(mesh, normals=-mesh.normals)


def _lights_behind(commands):
    def changed(command):
        if not isinstance(command, Draw) or command.state.vertex.lighting is None:
            return command
        vertex, lighting = command.state.vertex, command.state.vertex.lighting
        lights = tuple(
            replace(light, position=(*(-c for c in light.position[:3]), light.position[3]))
            for light in lighting.lights
        )
        vertex = replace(vertex, lighting=replace(lighting, lights=lights))
        return replace(command, state=replace(command.state, vertex=vertex))

    return tuple(map(changed, commands))


def _exchanged(columns, first, second):
    """A window with two of its panels exchanged."""

    def exchanged(window):
        width = window.shape[1] // columns
        out = np.array(window)
        a, b = (slice(k * width, (k + 1) * width) for k in (first, second))
        out[:, a], out[:, b] = window[:, b], window[:, a]
        return out

    return exchanged


def mutations_of(figure: Figure, machine: str) -> Iterator[Mutation]:
    """What may be wrong with any figure, by what its commands have."""
    commands = figure.commands(machine)
    draws = [(c.label, n) for c, n in _numbered(commands) if isinstance(c, Draw)]
    if len(draws) > MOST_PASSES:
        draws = [(label, None) for label in dict.fromkeys(label for label, _ in draws)]
    repeated = Counter(label for label, _ in draws)
    for label, number in draws:
        which = "" if repeated[label] == 1 else f", number {number + 1}"
        yield Mutation(f"left out: {label}{which}", _without(label, number))
    loaded: dict[str, InternalFormat] = {}
    for command in commands:
        if isinstance(command, TexImage) and command.image is not None:
            loaded.setdefault(command.texture, command.image.internal_format)
    for name, internal_format in loaded.items():
        if not internal_format.name.startswith(_WORDS):
            yield Mutation(f"flat: {name}", _textures(_flat, {name}))
        yield Mutation(f"upside down: {name}", _textures(_upside_down, {name}))
    yield Mutation("texture coordinates transposed", _meshes(_transposed))
    yield Mutation("normals of what is lit negated", _meshes(_inward))
    yield Mutation("lights negated", _lights_behind)
    for first in range(figure.columns):
        for second in range(first + 1, figure.columns):
            yield Mutation(
                f"panels {first + 1} and {second + 1} exchanged",
                window=_exchanged(figure.columns, first, second),
            )


# --------------------------------------------------------------------------------- the strangers' own


@contextmanager
def _patched(module, name, function, *kept):
    """Another function under a module's name while the block runs. ``kept``: caches of what it made."""

    def forget():
        _REFERENCES.clear()
        for cache in kept:
            cache.cache_clear()

    right = getattr(module, name)
    try:
        setattr(module, name, function)
        forget()
        yield
    finally:
        setattr(module, name, right)
        forget()


def _turned_room():
    right = f000_05.maps

    def maps(seen, edge, roughness):
        _, glossy, cosine = right(seen, edge, roughness)
        turned = f000_05.environments.faces(edge, lambda toward: seen(toward * np.array((-1.0, -1.0, 1.0))))
        return np.minimum(turned, 1.0), glossy, cosine

    return _patched(f000_05, "maps", maps)


def _flat_normals():
    right = f000_09.vector_texels
    return _patched(
        f000_09,
        "vector_texels",
        lambda vectors, profile: right(np.broadcast_to((0.0, 0.0, 1.0), vectors.shape), profile),
    )


def _no_heights():
    right = f002_01.relief

    def relief(field, **border):
        surface = right(field, **border)
        return replace(surface, positions=surface.positions * np.array((1.0, 1.0, 0.0)))

    return _patched(f002_01, "relief", relief)


def _other_sky(sky):
    return _patched(f002_10, "SKY", sky, f002_10.lights)


def _no_bump_s_shadow():
    right = turning_sun.prepared

    def prepared(field, visibility):
        known = right(field, visibility)
        return replace(known, field=replace(field, heights=np.zeros(field.heights.shape)))

    return _patched(turning_sun, "prepared", prepared, backyard._known, backyard.radiance)


def _no_terrain_left():
    right = f002_13._with_combiners

    def passes(*values, shadows, **settings):
        return right(*values, shadows=shadows, **settings) if shadows else ()

    return _patched(f002_13, "_with_combiners", passes)


# What strangers drew of figures while all their checks passed: by id and name, what draws it.
NAMED: dict[tuple[str, str], Callable] = {
    ("F000-5", "rows 1 to 3 mirror the room upside down, left and right exchanged"): _turned_room,
    ("F000-9", "a flat normal map"): _flat_normals,
    ("F002-1", "the relief has no heights"): _no_heights,
    ("F002-10", "brown from above and blue from below"): lambda: _other_sky(f002_10.SKY[::-1].copy()),
    ("F002-10", "a green world"): lambda: _other_sky(f002_10.SKY * 0.0 + np.array((0.1, 0.6, 0.1))),
    ("F002-12", "no bump throws a shadow"): _no_bump_s_shadow,
    ("F002-13", "no terrain on the left"): _no_terrain_left,
}


# ------------------------------------------------------------------------------------------- measuring


def first_failed(figure: Figure, machine: str, mutation: Mutation | None = None) -> str | None:
    """The name of the first check of a figure that fails on a machine; None where all pass. What stops the
    checks is caught too, in its own words.
    """
    mutation = mutation or Mutation("right")
    wrong = wrong_figure(figure, mutation)
    try:
        # What is measured of a wrong picture may be no number, which fails a check.
        with np.errstate(all="ignore"), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for check in wrong.each_check(_renderer(wrong, machine, mutation)):
                if not check.passed:
                    kept = f"{check.value:.3g}, not {check.relation} {check.bound:.3g}"
                    return f"{check.name} ({check.on.value}: {kept})"
    except Exception as error:
        return f"the checks stop: {type(error).__name__}: {error}"
    return None


def named_failed(figure_id: str, name: str) -> str | None:
    """``first_failed`` of one of NAMED, on the figure's first machine."""
    figure = FIGURES[figure_id]
    with NAMED[figure_id, name]():
        # A figure made anew has no scene that is kept.
        return first_failed(figure, figure.machines[0])


def _displayed(figure, machine, mutation):
    wrong = wrong_figure(figure, mutation)
    return np.clip(_renderer(wrong, machine, mutation).machine_window(wrong, figure.size), 0.0, 1.0)


def results_of(figure_id: str) -> Iterator[tuple[str, str | None]]:
    """Each mutation of a figure that makes a wrong picture on its first machine, and the first check that
    failed, or None.
    """
    figure = FIGURES[figure_id]
    machine = figure.machines[0]
    right = _displayed(figure, machine, Mutation("right"))
    for mutation in mutations_of(figure, machine):
        try:
            apart = np.abs(_displayed(figure, machine, mutation) - right).max()
        except ValueError as error:
            yield mutation.name, f"no picture: {error}"
            continue
        if apart > LEAST:
            yield mutation.name, first_failed(figure, machine, mutation)


def main() -> int:
    """Print each wrong picture of some figures, the check that refuses it, and the share that is refused."""
    parser = argparse.ArgumentParser(description="wrong pictures of figures, and the checks that refuse them")
    parser.add_argument(
        "figures", nargs="+", choices=tuple(FIGURES), metavar="ID", help="figures by their ids"
    )
    parser.add_argument("--named", action="store_true", help="the strangers' own alone")
    parser.add_argument("--executor", help="where: processes:N, dask:..., mpi (docs/scale.md)")
    parser.add_argument("--manifest", help="a file: figures that are done are not done again")
    options = parser.parse_args()
    if not (options.executor or options.manifest):
        return bool(sum(_printed(f, _results(f, options.named)) for f in options.figures))
    survived, about = 0, "wrong pictures"
    with Manifest(options.manifest, about) as manifest, opened(options.executor) as workers:
        tasks = [_task(figure_id, options.named) for figure_id in options.figures]
        for figure_id, done in zip(options.figures, in_order(tasks, workers, manifest), strict=True):
            survived += _printed(figure_id, done.value)
    return bool(survived)


def _task(figure_id, named):
    parameters = {"figure_id": figure_id, "named": named}
    return Task(results_there, parameters, f"wrong pictures of {figure_id}", inputs_here())


def _results(figure_id, named):
    if named:
        return ((name, named_failed(of, name)) for of, name in NAMED if of == figure_id)
    return results_of(figure_id)


def results_there(figure_id: str, named: bool) -> list[tuple[str, str | None]]:
    """In a worker: what ``results_of`` yields, or the named ones."""
    return list(_results(figure_id, named))


def _printed(figure_id, results):
    """Print a figure's results as they come; returns how many survived."""
    caught = total = 0
    for name, failed in results:
        total, caught = total + 1, caught + (failed is not None)
        print(f"{figure_id}: {name}: {failed or 'SURVIVED'}", flush=True)
    print(f"{figure_id}: {caught} of {total} wrong pictures are refused", flush=True)
    return total - caught


if __name__ == "__main__":
    sys.exit(main())

"""``fixedpipe compare``: find the command and stage where two frames, or two pixel histories, diverge."""

import click

from fixedpipe.effects.cli.frames import check_files, check_plots, frame_asked, write_file
from fixedpipe.effects.cli.options import set_option


@click.command(short_help="Find where two machines' pictures diverge: command, pixel, stage.")
@click.argument("what", metavar="ID|SCRIPT.py|TRACE#N|HISTORY.json")
@click.argument("other", metavar="[SCRIPT.py|TRACE#N|HISTORY.json]", required=False)
@click.option("--machines", nargs=2, metavar="A B", help="The two machines. A script may name its own.")
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Height of a figure's panel in pixels.")
@click.option(
    "--out", metavar="FILE", help="Write the difference after the first command that differs, as a picture."
)
@set_option
def compare(what, other, machines, size, out, settings):
    """Draw figure ID on two machines, or the frames of two scripts or recorded programs, and say where they
    diverge. Or compare two histories of a pixel that `fixedpipe inspect --json` wrote, of two machines or
    versions.

    Both machines must draw the figure by the same commands; fixedpipe passes ID --profile NAME prints them.

    The frames are compared after each of their commands. For the first command that leaves different
    framebuffers, this prints how many pixels differ, by how much and where. For the pixel that differs most,
    it prints the first stage with other values. Exit status: 0 if all framebuffers are equal, 1 if not.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.inspection.compare import Run
    from fixedpipe.pipeline.inspection.compare import compare as compared

    if what.endswith(".json") or (other or "").endswith(".json"):
        if other is None:
            raise Refusal(f"{what} is one history; give another one to compare it with.")
        _compare_histories(what, other)
        return
    if not machines and other is None:
        raise Refusal("Give two machines, as --machines GEFORCE_256 GEFORCE_3, or two scripts.")
    names = machines or (None, None)
    frames = [
        frame_asked(each, name, size, settings)
        for each, name in zip((what, other or what), names, strict=True)
    ]
    if frames[0].size != frames[1].size:
        sizes = " and ".join("x".join(map(str, frame.size)) for frame in frames)
        raise Refusal(f"The frames have {sizes} pixels; give both the same size.")
    check_plots("--out", out)
    check_files(out)
    announce_compiling()
    for frame in frames:  # first, because the titles name the methods by which the machines draw it
        click.echo(frame.title)
    with refusals():
        runs = [Run(tuple(frame.commands), frame.machine) for frame in frames]
        found = compared(runs, *frames[0].size)
    if found is None:
        click.echo("Every command leaves equal colours, depths and stencil values.")
        return
    x0, y0, x1, y1 = found.box
    click.echo(f"They first differ after command {found.command}: {found.label}")
    scale, unit = _SCALES[found.plane]
    click.echo(
        f"  {found.plane}: {found.count} pixels differ, by at most {scale * found.largest:.4g}{unit}, from "
        f"({x0}, {y0}) to ({x1 - 1}, {y1 - 1}); most at {found.pixel}"
    )
    made = [_made(stage) for stage in found.stages]
    for frame, stage, own, others in zip(frames, found.stages, made, made[::-1], strict=True):
        click.echo(f"  on {frame.machine.name}: {_title(stage)}")
        for text in own:
            if text not in others:
                click.echo(f"    = {text}")
    if out is not None:
        from fixedpipe.effects.reports.map_picture import maps_png

        size_of = abs(found.first - found.second)
        values = scale * (size_of.max(axis=2) if size_of.ndim == 3 else size_of)
        maps = [(f"{found.command}: {found.label}", values)]
        write_file(out, maps_png(maps, found.plane, f"difference{unit and ', 1' + unit}"))
    click.get_current_context().exit(1)


def _compare_histories(*paths):
    """Compare two files of ``fixedpipe inspect --json``."""
    from fixedpipe.effects.cli.options import refuse_ignored
    from fixedpipe.effects.refusal import Refusal

    context = click.get_current_context()
    refuse_ignored(context, ("machines", "size", "out", "settings"), "what is compared is in the files")
    found = [_history(path) for path in paths]
    pixels = [tuple(each[name] for name in ("width", "height", "x", "y", "surface")) for each in found]
    if pixels[0] != pixels[1]:
        texts = [f"({x}, {y}) of {width}x{height}" for width, height, x, y, _ in pixels]
        raise Refusal(f"The histories are of pixels {' and '.join(texts)}; give two of the same pixel.")
    parted = _where_histories_part(*found)
    if parted is None:
        click.echo("The histories are the same.")
        return
    where, values = parted
    click.echo(f"They first differ at {where}")
    for path, value in zip(paths, values, strict=True):
        click.echo(f"  {path}: {value}")
    context.exit(1)


def _history(path):
    """The JSON value of a history. Raises Refusal if the file holds no history."""
    import json

    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.user_pictures.inputs import read_text

    text = read_text(path)
    try:
        found = json.loads(text)
        found["touched"], found["width"], found["height"], found["x"], found["y"], found["surface"]
    except (ValueError, KeyError, TypeError):
        raise Refusal(
            f"{path} is no history of a pixel; fixedpipe inspect ID --pixel X,Y --json writes one."
        ) from None
    return found


def _where_histories_part(first, second):
    """(place in words, the values there) of the first number or word that differs; None if none differs."""
    leaves = [dict(_leaves(history, ())) for history in (first, second)]
    for place in {**leaves[0], **leaves[1]}:
        values = [each.get(place, "nothing") for each in leaves]
        if repr(values[0]) != repr(values[1]):
            return ", ".join(place), values
    return None


def _leaves(value, place):
    """(place in words, number or word) of each value in a history, in the order of the computation."""
    parts = next((of(value) for kind, of in _PARTS if isinstance(value, kind)), ())
    if not parts:
        yield place, value
    for key, part in parts:
        if key not in _NOT_COMPARED:
            yield from _leaves(part, (*place, *_step(key, part)))


def _step(key, part):
    """A step on the way to a number: for an item of a list its title and place, otherwise the name."""
    if key in _GROUPS:
        return ()
    if not isinstance(key, int):
        return (key,)
    titled = part if isinstance(part, dict) else {}
    title = next((titled[name] for name in ("label", "title", "name") if name in titled), "")
    return (f"{title} [{key}]".strip(),)


_PARTS = ((dict, dict.items), (list, lambda items: tuple(enumerate(items))))
# Lists whose items have titles of their own; and fields that may differ, such as the machine.
_GROUPS, _NOT_COMPARED = ("touched", "stages"), ("profile", "label")


_SCALES = {"color": (255, "/255"), "depth": (1, ""), "stencil": (1, "")}


def _title(stage):
    """A stage's name and what it computes, in a line."""
    if stage is None:
        return "no such stage"
    return f"{stage.title}{': ' + stage.says if stage.says else ''}"


def _made(stage):
    """The values that a stage made, each as a text."""
    from fixedpipe.pipeline.inspection.words import cells

    made = () if stage is None else stage.made
    return [f"{quantity.name} {' '.join(filter(None, cells(quantity)[:2]))}" for quantity in made]

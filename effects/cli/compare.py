"""``fixedpipe compare``: where two frames part, at which command, pixel and stage."""

import click

from fixedpipe.effects.cli.frames import frame_asked, write_file
from fixedpipe.effects.cli.options import set_option


@click.command(short_help="Where two machines' pictures part: command, pixel, stage.")
@click.argument("what", metavar="ID|SCRIPT.py")
@click.argument("other", metavar="[SCRIPT.py]", required=False)
@click.option("--machines", nargs=2, metavar="A B", help="The machines; a script may have its own.")
@click.option("--size", type=click.IntRange(min=1), metavar="N", help="Pixels an edge of a figure's panel.")
@click.option("--out", metavar="FILE", help="A picture of the difference after the command where they part.")
@set_option
def compare(what, other, machines, size, out, settings):
    """Draw figure ID on two machines, or two scripts' frames, and say where they part.

    Commands are compared one after the other. Of the first after which the framebuffers differ it is told how
    many pixels do, by how much and where; of the pixel that differs most, which stage first made other
    values. Exit status: 0 where every command leaves the same, 1 where not.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.inspection.compare import Run
    from fixedpipe.pipeline.inspection.compare import compare as compared

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
    announce_compiling()
    with refusals():
        runs = [Run(tuple(frame.commands), frame.machine) for frame in frames]
        found = compared(runs, *frames[0].size)
    for frame in frames:
        click.echo(frame.title)
    if found is None:
        click.echo("Every command leaves the same.")
        return
    x0, y0, x1, y1 = found.box
    click.echo(f"They part at command {found.command}: {found.label}")
    scale, unit = _SCALES[found.plane]
    click.echo(
        f"  {found.plane}: {found.count} pixels differ, by at most {scale * found.largest:.4g}{unit}, from "
        f"({x0}, {y0}) to ({x1 - 1}, {y1 - 1}); most at {found.pixel}"
    )
    for frame, stage in zip(frames, found.stages, strict=True):
        click.echo(f"  on {frame.machine.name}: {_stage(stage)}")
    if out is not None:
        from fixedpipe.effects.reports.map_picture import maps_png

        size_of = abs(found.first - found.second)
        values = scale * (size_of.max(axis=2) if size_of.ndim == 3 else size_of)
        maps = [(f"{found.command}: {found.label}", values)]
        picture = maps_png(maps, found.plane, f"difference{unit and ', 1' + unit}")
        if picture is None:
            raise Refusal("The picture needs matplotlib; install fixedpipe[plots], or leave --out out.")
        write_file(out, picture)
    click.get_current_context().exit(1)


_SCALES = {"color": (255, "/255"), "depth": (1, ""), "stencil": (1, "")}


def _stage(stage):
    """A stage and what it made, in a line."""
    from fixedpipe.pipeline.inspection.words import cells

    if stage is None:
        return "no such stage"
    made = ", ".join(
        f"{quantity.name} {' '.join(filter(None, cells(quantity)[:2]))}" for quantity in stage.made
    )
    return f"{stage.title}{': ' + stage.says if stage.says else ''}  = {made}"

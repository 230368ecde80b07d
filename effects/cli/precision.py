"""``fixedpipe precision``: a figure's error by the width of the numbers and by each clamp."""

import click

from fixedpipe.effects.cli.frames import write_rows
from fixedpipe.effects.cli.options import changes_of, machine_of, set_option


@click.command(short_help="Was it the clamp or the bits? A figure's error by each.")
@click.argument("figure_id", metavar="ID", default="F004-4")
@click.option("--profile", metavar="NAME", help="Machine; otherwise the figure's own.")
@click.option(
    "--size",
    type=click.IntRange(min=1),
    metavar="N",
    default=96,
    show_default=True,
    help="Pixels an edge of a panel.",
)
@click.option(
    "--bits", metavar="N,N,...", default="4,6,8,10,12,16", show_default=True, help="Widths, 4 to 16."
)
@click.option(
    "--of",
    "parts",
    metavar="PART,...",
    default="all",
    show_default=True,
    help="What has these widths: combiner, texture, framebuffer, filter_fraction, subpixel; all: the first "
    "four.",
)
@click.option("--json", "json_file", metavar="FILE", help="Write the numbers as JSON.")
@click.option("--csv", "csv_file", metavar="FILE", help="Write the numbers as CSV.")
@set_option
def precision(figure_id, profile, size, bits, parts, json_file, csv_file, settings):
    """Render figure ID on the same machine with numbers of several widths, with and without its clamps.

    Printed are root mean squares of (machine - ideal) in units of 1/255, of the same fragments: "shown" as
    the picture is seen, both clamped to [0, 1]; "computed" of the colours as they were computed. "Its own"
    clamps are those that the ideal evaluation has not: what they cost shows where the two pairs of columns
    part, and what the bits cost where a row differs from the next.
    """
    from fixedpipe.effects.acceptance import precision as measured
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.figures import FIGURES
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.rows import precision_rows

    if figure_id.endswith(".py"):
        raise Refusal(
            f"{figure_id} is a script, and precision takes figures by their ids. fixedpipe inspect "
            f"{figure_id} --bits combiner=N draws a script's frame with other widths."
        )
    figure = choose("figure", figure_id, FIGURES)
    key = profile or figure.machines[0]
    machine = machine_of(key)
    check_size(figure.id, figure.dimensions(size), machine)
    widths, of = _widths(bits), _parts(parts, measured.PARTS)
    announce_compiling("portable")  # which records what the ideal is guided by
    with refusals():
        method = figure.method(key)
        changes = changes_of(settings, figure, (method,))
        rows = measured.table(figure, machine, size, widths, of, method, changes)
        single = measured.clamps(figure, machine, size, method, changes)
    changed = f", with {figure.said(method, changes)}" if changes else ""
    click.echo(f"{figure.id}: {figure.title}, on {machine.name}, panels of {size} pixels{changed}")
    click.echo("Root mean square of (machine - ideal), 1/255 of full intensity\n")
    click.echo(f"Bits of {', '.join(part.removesuffix('_bits').replace('_', ' ') for part in of)}:")
    click.echo(f"{'':22}{'with clamps':>20}{'without its own':>23}")
    click.echo(f"{'':22}{'shown':>9}{'computed':>11}{'shown':>12}{'computed':>11}")
    for width, clamped, free in rows:
        click.echo(f"{width:>22}{_numbers(clamped)}   {_numbers(free)}")
    click.echo(f"\nAt its own widths, without one clamp:\n{'':22}{'shown':>9}{'computed':>11}")
    for clamp, found in single:
        click.echo(f"{clamp.name:>22}{_numbers(found)}")
    write_rows(precision_rows(rows, single), json_file, csv_file)


def _numbers(measured):
    return f"{255 * measured.shown:9.3f}{255 * measured.computed:11.3f}"


def _widths(text):
    from fixedpipe.effects.refusal import Refusal

    try:
        return tuple(int(word) for word in text.split(","))
    except ValueError:
        raise Refusal(f"--bits is {text!r}; give whole numbers from 4 to 16, as in 4,8,12.") from None


def _parts(text, usual):
    from fixedpipe.effects.refusal import Refusal

    if text == "all":
        return usual
    known = {name.removesuffix("_bits"): name for name in (*usual, "subpixel_bits")}
    names = [word.strip() for word in text.split(",")]
    for name in names:
        if name not in known:
            raise Refusal(f"--of names {name!r}; there are: {', '.join(known)}, or all.")
    return tuple(known[name] for name in names)

"""``fixedpipe precision``: draw a frame with numbers of several widths, with and without its clamps."""

import click

from fixedpipe.effects.cli.frames import check_files, frame_asked, is_own_frame, sign_beside, write_rows
from fixedpipe.effects.cli.options import set_option

_SIZE = 96  # height of a figure's panel in pixels, without --size


@click.command(short_help="Separate the error of clamps from the error of short numbers.")
@click.argument("what", metavar="ID|SCRIPT.py|TRACE#N", default="F004-4")
@click.option("--profile", metavar="NAME", help="The machine. Default: the figure's own, or the script's.")
@click.option(
    "--size",
    type=click.IntRange(min=1),
    metavar="N",
    help=f"Height of a figure's panel in pixels. Default: {_SIZE}.",
)
@click.option(
    "--bits",
    metavar="N,N,...",
    default="4,6,8,10,12,16",
    show_default=True,
    help="The widths to draw with, 4 to 16.",
)
@click.option(
    "--of",
    "parts",
    metavar="PART,...",
    default="all",
    show_default=True,
    help="Which numbers have these widths: combiner (the sign is not counted), texture, framebuffer, "
    "filter_fraction, subpixel. all means the first four.",
)
@click.option("--json", "json_file", metavar="FILE", help="Write the numbers as JSON.")
@click.option("--csv", "csv_file", metavar="FILE", help="Write the numbers as CSV.")
@set_option
def precision(what, profile, size, bits, parts, json_file, csv_file, settings):
    """Draw figure ID, the frame that SCRIPT.py makes, or frame N of a recorded program, on the same machine
    with numbers of several widths, with and without its clamps.

    The command prints the root mean square of (machine - ideal), in 1/255 of full intensity, over the same
    fragments. The column "shown" compares the pictures as they are seen, clamped to [0, 1]. The column
    "computed" does not clamp the ideal's colours. The columns "without its clamps" leave out the clamps that
    the ideal does not have. Compare the columns of a row to see the error of clamps. Compare the rows to see
    the error of short numbers.

    A script defines `commands`, `profile` (a Profile or its name), `width` and `height`. Its commands do not
    change with the width, so an image that it gives in bytes stays in bytes.
    """
    from fixedpipe.effects.acceptance import precision as measured
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.progress import progress_of_long
    from fixedpipe.effects.refusal import refusals
    from fixedpipe.effects.reports.rows import precision_rows

    widths, parts = _widths(bits), _parts(parts, measured.PARTS)
    of = frame_asked(what, profile, size or (None if is_own_frame(what) else _SIZE), settings)
    check_files(json_file, csv_file)
    announce_compiling("portable")  # the column engine takes coverage from this engine
    steps = 2 * len(widths) + 1 + len(measured.clamps_of(of.machine))
    with progress_of_long(steps) as step, refusals():
        rows = measured.table(of.commands_of, of.machine, *of.size, widths, parts, step)
        single = measured.clamps(of.commands_of, of.machine, *of.size, step)
    click.echo(f"{of.title}\n{of.size[0]}x{of.size[1]} pixels; {_UNIT}\n")
    click.echo(f"Bits of {', '.join(part.removesuffix('_bits').replace('_', ' ') for part in parts)}:")
    click.echo(f"{'':22}{'with clamps':>20}{'without its clamps':>23}")
    click.echo(f"{'':22}{'shown':>9}{'computed':>11}{'shown':>12}{'computed':>11}")
    for width, clamped, free in rows:
        click.echo(f"{width:>22}{_numbers(clamped)}   {_numbers(free)}")
    click.echo(f"\n{_COLUMNS}")
    if "combiner_bits" in parts:
        click.echo(sign_beside(of.machine))
    click.echo(f"\nAt its own widths, without one clamp:\n{'':22}{'shown':>9}{'computed':>11}")
    (_, own), *_ = single
    for clamp, found in single:
        name, does = ("none left out", "") if clamp is None else (clamp.name, CLAMPS[clamp.name])
        says = f"{does}{'; changes nothing' * (found == own)}" if does else ""
        click.echo(f"{name:>22}{_numbers(found)}   {says}".rstrip())
    write_rows(precision_rows(rows, single), json_file, csv_file)


_UNIT = "root mean square of (machine - ideal), 1/255 of full intensity"
_COLUMNS = """\
shown: of the pictures as they are seen, both clamped to [0, 1].
computed: of the colours as they were computed; the ideal's are not clamped.
without its clamps: the machine without the clamps that the ideal does not have."""
# The values that each Clamp clamps, by the Clamp's name.
CLAMPS = {
    "VERTEX_COLOR": "colours of vertices",
    "MAPPING": "inputs of combiners",
    "GENERAL_COMBINER": "outputs of general combiners",
    "TEXTURE_ENVIRONMENT": "results of texture environments",
    "COLOR_SUM": "the sum with the secondary colour",
    "FINAL_COMBINER": "fragments' colours in the end",
    "BLENDING": "what blending writes",
}


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

"""``fixedpipe volume``: draw an iso-surface of a user's volume, with shadows."""

from pathlib import Path

import click

from fixedpipe.effects.cli.options import limit_option, refuse_ignored, threads_option, three_numbers

TYPES = {"uint8": "u1", "int8": "i1", "uint16": "u2", "int16": "i2", "float32": "f4", "float64": "f8"}
_WITH_HEADERS = (".nrrd", ".nhdr")
ENDIANS = {"little": "<", "big": ">"}


@click.command(short_help="Draw an iso-surface of a volume, with shadows.")
@click.argument("file")
@click.option(
    "--iso",
    type=float,
    metavar="V",
    help="The surface's value. Default: halfway between the least and the greatest.",
)
@click.option("--out", metavar="FILE.png", required=True, help="Write the picture to this file.")
@click.option(
    "--dims",
    metavar="X,Y,Z",
    help="For a raw file: how many voxels along x (which changes fastest), y and z.",
)
@click.option(
    "--type",
    "type_name",
    metavar="TYPE",
    default="uint8",
    show_default=True,
    help=f"For a raw file: the type of its values, {', '.join(TYPES)}.",
)
@click.option(
    "--endian", metavar="E", default="little", show_default=True, help="For a raw file: little or big."
)
@click.option(
    "--skip",
    type=click.IntRange(min=0),
    metavar="BYTES",
    default=0,
    help="For a raw file: how many bytes to skip before its values.",
)
@click.option(
    "--spacing", metavar="X,Y,Z", help="Distances between voxels. Default: an NRRD file's own, or equal."
)
@click.option(
    "--view", metavar="X,Y,Z", default="4.3,3.3,4.6", show_default=True, help="Direction to the eye."
)
@click.option(
    "--up",
    metavar="X,Y,Z",
    default="0,1,0",
    show_default=True,
    help="The direction that is up in the picture.",
)
@click.option(
    "--light", metavar="X,Y,Z", default="-1.5,3.1,4.1", show_default=True, help="Direction to the light."
)
@click.option(
    "--shadows/--no-shadows", default=True, show_default=True, help="Shadows by an alpha-coded shadow map."
)
@click.option(
    "--slices",
    type=click.IntRange(32, 2048),
    metavar="N",
    default=256,
    show_default=True,
    help="How many slices cut the volume. If they are voxels apart, surfaces have steps and dark gaps.",
)
@click.option(
    "--size",
    type=click.IntRange(min=8),
    metavar="N",
    default=512,
    show_default=True,
    help="Width and height of the picture in pixels.",
)
@click.option("--profile", metavar="NAME", default="OCTANE", show_default=True, help="The machine, or IDEAL.")
@limit_option
@threads_option
def volume(
    file, iso, out, dims, type_name, endian, skip, spacing, view, up, light, shadows, slices, size, profile,
    threads,
):  # fmt: skip
    """Draw an iso-surface of a volume: FILE is raw values, an NRRD file (.nrrd, .nhdr) or sample:engine.

    The machine draws slices of a 3D texture with the alpha test. Phong's model lights them by the volume's
    gradients, as in figure F000-7. Values are stored as bytes, and edges as powers of two; the command prints
    what it changed. Directions are in the volume's axes.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.effects.reports.files import writable_picture, write_whole
    from fixedpipe.effects.user_pictures.drawing import drawn
    from fixedpipe.effects.user_pictures.volume import method_for, picture_of, volume_of
    from fixedpipe.effects.user_pictures.volume_files import data_file_of
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.profiles import PROFILES

    machine = choose("profile", profile, PROFILES)
    _check_raw_options(file)
    path = writable_picture(out, (file, data_file_of(Path(file)) or file))
    check_size("The picture", (size, size), machine)
    directions = [three_numbers(text, what) for text, what in (
        (view, "The direction to the eye"), (up, "What is up"), (light, "The direction to the light"),
    )]  # fmt: skip
    with refusals():
        method = method_for(machine)
        values, own_spacing = _read(file, dims, type_name, endian, skip)
        steps = own_spacing if spacing is None else three_numbers(spacing, "The spacing")
        found = volume_of(values, file, machine, iso, steps)
        picture = picture_of(found, *directions, machine, size, slices, shadows)
        frame = method(picture, machine)
        announce_compiling()
        drawing = drawn(frame, machine, size, size, threads)
    write_whole(path, png(drawing.image))
    low, high = float(values.min()), float(values.max())
    given, kept = ("x".join(map(str, a.shape[::-1])) for a in (values, found.density))
    changed = "" if given == kept else f" resampled from {given}"
    click.echo(
        f"{file}: {kept} voxels{changed}, {low:g} to {high:g} as bytes, surface at "
        f"{low + found.iso * (high - low):g}"
    )
    click.echo(f"{path}: {slices} slices, {drawing.summary}")


def _check_raw_options(name):
    """Raise Refusal if options for a raw file are given for another kind of file."""
    sample, header = name.startswith("sample:"), Path(name).suffix.lower() in _WITH_HEADERS
    if sample or header:
        why = "a sample is no raw file" if sample else f"the header of {name} says what its values are"
        refuse_ignored(
            click.get_current_context(), ("dims", "type_name", "endian", "skip"), f"{why}; draw it without"
        )


def _read(name, dims, type_name, endian, skip):
    """(values [layers, rows, columns], spacing of the voxels along x, y and z). Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal, choose
    from fixedpipe.effects.user_pictures.volume_files import read_nrrd, read_raw_volume

    equal = (1.0, 1.0, 1.0)
    if name.startswith("sample:"):
        from fixedpipe.effects.volumes.engine_block import engine_block

        return choose("sample", name.removeprefix("sample:"), {"engine": engine_block})(), equal
    path = Path(name)
    if not path.is_file():
        problem = f"{name} is no file" if name and path.exists() else f"There is no file {name!r}"
        raise Refusal(f"{problem}. Give raw values with --dims, an NRRD file, or sample:engine.")
    if path.suffix.lower() in _WITH_HEADERS:
        return read_nrrd(path)
    if dims is None:
        raise Refusal(f"{name} is read as raw values; say how many along each edge with --dims X,Y,Z.")
    kind, order = choose("type", type_name, TYPES), choose("endian", endian, ENDIANS)
    return read_raw_volume(path, dims, order + kind, skip), equal

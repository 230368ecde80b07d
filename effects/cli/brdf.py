"""``fixedpipe brdf``: the BRDF of a user's height field, simulated with scattered light."""

from pathlib import Path

import click

from fixedpipe.effects.cli.executors import executor_option, workers_of
from fixedpipe.effects.cli.options import fill_option, limit_option, profile_option, three_numbers

FORMATS = ("merl", "npz")


@click.command(short_help="Simulate the BRDF of a height field.")
@click.argument("heights")
@click.option("--out", metavar="FILE", required=True, help="Write the BRDF: FILE.binary (MERL) or FILE.npz.")
@click.option(
    "--format",
    "form",
    type=click.Choice(FORMATS),
    help="merl: MERL's binary table, isotropic. npz: a dense grid and harmonics. Default: as FILE ends.",
)
@click.option("--picture", metavar="FILE.png", help="Also draw the BRDF on a ball.")
@click.option(
    "--albedo", metavar="A or R,G,B", default="0.8", show_default=True, help="Albedo of the heights, 0 to 1."
)
@click.option(
    "--relief",
    type=click.FloatRange(0.0, 10.0),
    metavar="H",
    default=0.25,
    show_default=True,
    help="Height from the lowest to the highest point, in widths of the field.",
)
@click.option(
    "--texels",
    type=click.IntRange(2, 256),
    metavar="N",
    default=32,
    show_default=True,
    help="Width and height of the field in texels.",
)
@click.option(
    "--directions",
    type=click.IntRange(1, 10000),
    metavar="N",
    default=100,
    show_default=True,
    help="How many directions, over the whole sphere, gather light.",
)
@click.option(
    "--bounces",
    type=click.IntRange(0, 64),
    metavar="N",
    default=3,
    show_default=True,
    help="How many reflections after the first.",
)
@click.option(
    "--grid",
    type=click.IntRange(2, 64),
    metavar="N",
    default=16,
    show_default=True,
    help="Steps along each angle of light and view: N^4 samples.",
)
@click.option(
    "--samples",
    type=click.IntRange(1, 100000),
    metavar="N",
    default=512,
    show_default=True,
    help="How many random samples the harmonics of NPZ are fitted to.",
)
@click.option(
    "--light",
    metavar="X,Y,Z",
    default="-1,1,1.5",
    show_default=True,
    help="Direction to the light of --picture.",
)
@click.option(
    "--size",
    type=click.IntRange(min=1),
    metavar="N",
    default=512,
    show_default=True,
    help="Width and height of --picture in pixels.",
)
@profile_option
@click.option(
    "--resume",
    metavar="FOLDER",
    help="Keep finished work in FOLDER. If you give the same command again, it goes on from there.",
)
@limit_option
@fill_option
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    metavar="N",
    help="Short for --executor processes:N.",
)
@executor_option
def brdf(
    heights,
    out,
    form,
    picture,
    albedo,
    relief,
    texels,
    directions,
    bounces,
    grid,
    samples,
    light,
    size,
    profile,
    resume,
    jobs,
    executor,
):
    """Simulate the BRDF of HEIGHTS, with shadows, masking and scattered light.

    HEIGHTS is a PNG, TIFF (its first page), JPEG or NPY file, or a sample: sample:gravel, sample:brick,
    sample:grass, sample:coins, sample:moon, sample:jacksboro. Light texels are high, dark ones low. The field
    repeats.

    MERL's table is isotropic: it has the mean over all rotations of the field about its normal. An NPZ file
    keeps the anisotropy: samples over (z, angle) of light and view, and coefficients of spherical harmonics.
    --picture shows a ball with the BRDF computed at its vertices. A machine draws it, or IDEAL without
    rounding.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.files import writable_file, writable_folder, writable_picture, write_whole
    from fixedpipe.effects.user_pictures import simulated_brdf
    from fixedpipe.effects.user_pictures.drawing import drawn
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.profiles import PROFILES

    form = form or _form_of(out)
    machine = choose("profile", profile, PROFILES)
    toward = three_numbers(light, "The light's direction")
    reflected = _albedo(albedo)
    path = writable_file(out)
    _refuse_same(path, heights, "of which the BRDF is made")
    if picture is not None:
        check_size("The picture", (size, size), machine)
        picture = writable_picture(picture, (heights,))
        _refuse_same(picture, out, "the BRDF")
    if resume is not None:
        writable_folder(resume)
    if jobs and executor:
        raise Refusal("--jobs and --executor both say who computes; give one of them.")
    executor = f"processes:{jobs}" if jobs and jobs > 1 else executor
    announce_compiling()
    with refusals():
        field = simulated_brdf.field_of(heights, texels, relief, reflected)
        found = _simulated(field, directions, bounces, grid, resume, executor)
        if form == "merl":
            data = simulated_brdf.merl_file(found)
        else:
            harmonic = simulated_brdf.by_harmonics(
                field, directions=directions, bounces=bounces, samples=samples
            )
            description = (
                f"f_r of {heights}: {texels} x {texels} texels, relief {relief:g}, albedo {albedo}, "
                f"{directions} directions, {bounces} bounces, {samples} samples for the harmonics"
            )
            data = simulated_brdf.npz(found, harmonic, description)
        drawing = picture and drawn(simulated_brdf.ball(found, machine, size, toward), machine, size, size)
    write_whole(path, data)
    said = "isotropic, the mean over rotations" if form == "merl" else f"{samples} samples for harmonics"
    click.echo(f"{path}: {grid}^4 samples, {said}")
    if drawing:
        write_whole(picture, png(drawing.image))
        click.echo(f"{picture}: the BRDF at vertices, {drawing.summary}")


def _form_of(out):
    """The format that a file's ending names. Raises Refusal for any other ending."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.user_pictures.simulated_brdf import ENDINGS

    ending = Path(out).suffix.lower()
    for form, endings in ENDINGS.items():
        if ending in endings:
            return form
    raise Refusal(
        f"{out} ends in neither .binary (MERL) nor .npz; name it so, or say --format merl or --format npz."
    )


def _albedo(text):
    """One number or three, from ``A`` or ``R,G,B``. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in (1, 3) or not all(0.0 <= number <= 1.0 for number in numbers):
        raise Refusal(f"The albedo is {text!r}; give a number from 0 to 1, or three, as 0.8,0.5,0.3.")
    return numbers[0] if len(numbers) == 1 else numbers


def _refuse_same(path, other, what):
    """Raise Refusal if both names are of the same file."""
    import os

    from fixedpipe.effects.refusal import Refusal

    try:
        one = os.path.samefile(path, other)
    except (OSError, ValueError):  # one of the files does not exist
        one = Path(path) == Path(other)
    if one:
        raise Refusal(f"{path} is {other}, {what}; give another name.")


def _simulated(field, directions, bounces, grid, folder, executor):
    """The dense BRDF. A progress bar shows how much of it is simulated."""
    from fixedpipe.effects.cli.progress import progress
    from fixedpipe.effects.user_pictures import simulated_brdf

    with workers_of(executor) as workers, progress(grid) as step:
        begun = 0

        def came(done):
            nonlocal begun
            while begun < min(done + 1, grid):
                begun += 1
                step(f"lights, row {begun}")

        return simulated_brdf.simulated(
            field,
            directions=directions,
            bounces=bounces,
            grid=grid,
            folder=folder,
            executor=workers,
            progress=came,
        )

"""``fixedpipe scatter``: draw the light that the bumps of a user's heights scatter onto each other."""

import click

from fixedpipe.effects.cli.options import (
    fill_option,
    limit_option,
    profile_option,
    threads_option,
    three_numbers,
)


@click.command(short_help="Scatter light between the bumps of a height field.")
@click.argument("heights")
@click.option(
    "--light", metavar="X,Y,Z", default="-1,0.5,1", show_default=True, help="Direction to the light."
)
@click.option("--out", metavar="FILE.png", required=True, help="Write the picture to this file.")
@click.option(
    "--paths",
    type=int,
    metavar="N",
    default=100,
    show_default=True,
    help="How many paths of directions are summed.",
)
@click.option(
    "--bounces",
    type=int,
    metavar="N",
    default=1,
    show_default=True,
    help="How many reflections after the first, 1 to 4.",
)
@click.option(
    "--directions",
    type=int,
    metavar="N",
    default=100,
    show_default=True,
    help="How many directions over the sphere.",
)
@click.option(
    "--size",
    type=click.IntRange(min=4),
    metavar="N",
    default=512,
    show_default=True,
    help="Width and height of a panel in pixels.",
)
@profile_option
@click.option(
    "--height-scale",
    type=float,
    metavar="H",
    default=0.1,
    show_default=True,
    help="Height from the lowest to the highest point, in edges of the field.",
)
@click.option(
    "--albedo", type=float, metavar="A", help="The share of light that is scattered, 0 to 1. Default: 0.8."
)
@click.option("--colors", metavar="PHOTO", help="A photograph whose colours are the albedo.")
@click.option(
    "--texels", type=int, metavar="N", help="Width and height of the field in texels, a power of two."
)
@click.option(
    "--exposure",
    type=float,
    metavar="E",
    default=1.0,
    show_default=True,
    help="A number that multiplies the light.",
)
@click.option(
    "--seed",
    type=int,
    metavar="N",
    default=0,
    show_default=True,
    help="Seed of the directions after a path's first. It has no effect if --bounces is 1 and there are no "
    "more paths than directions.",
)
@click.option(
    "--accumulation",
    metavar="WHERE",
    default="accumulation-buffer",
    show_default=True,
    help="Where the paths are summed: framebuffer, accumulation-buffer or host.",
)
@limit_option
@fill_option
@threads_option
def scatter(
    heights,
    light,
    out,
    paths,
    bounces,
    directions,
    size,
    profile,
    height_scale,
    albedo,
    colors,
    texels,
    exposure,
    seed,
    accumulation,
    threads,
):
    """Light HEIGHTS, a PNG, TIFF, JPEG or NPY file or a sample, without and with scattered light.

    The heights become a square of texels that repeats. An edge has at most 128 texels, or 64 on the G400. The
    left half of the picture has direct light and its shadows. The right half also has the light that bumps
    scatter onto each other. The machine computes it in its own way: by pixel textures, texture shaders,
    lookups by the host, or offset textures.

    With more bounces the terms are smaller, and a machine's bytes lose some of them in a dark field. IDEAL
    loses none.

    For --light, +x is right, +y up in the picture and +z out of it. The samples are those of fixedpipe bump;
    sample:jacksboro is an elevation model.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.progress import progress
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.files import writable_picture, write_whole
    from fixedpipe.effects.scattering.dependent_tests import Accumulation
    from fixedpipe.effects.scattering.height_field import check_light
    from fixedpipe.effects.user_pictures import maps, scattering
    from fixedpipe.effects.user_pictures.drawing import drawn
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.profiles import PROFILES

    machine = choose("profile", profile, PROFILES)
    path = writable_picture(out, (heights, *([colors] if colors else [])))
    check_size("The picture", (2 * size, size), machine)
    towards = three_numbers(light, "The light's direction")
    for name, count, most in (
        ("paths", paths, 1000),
        ("bounces", bounces, 4),
        ("directions", directions, 1000),
    ):
        if not 1 <= count <= most:
            raise Refusal(f"--{name} is {count}; give a whole number from 1 to {most}.")
    if albedo is not None and colors is not None:
        raise Refusal("--albedo and --colors both say what is scattered; leave one of them out.")
    if not 0 <= seed < 1 << 31:
        raise Refusal(f"--seed is {seed}; give a whole number from 0 to {(1 << 31) - 1}.")
    summed = choose("accumulation", accumulation, {a.value.replace(" ", "-"): a for a in Accumulation})
    with refusals():
        check_light(towards)
        found = scattering.way_of(machine)
        share = maps.photograph(colors) if colors else 0.8 if albedo is None else albedo
        field = scattering.field_of(maps.height_field(heights), found, texels, height_scale, share)
        # The size is checked first, because casting the rays takes minutes.
        scattering.check_panel(field, size)
        announce_compiling()
        with progress(directions) as step:
            begun = 0

            def seen_along(done):
                nonlocal begun
                while begun < done:
                    begun += 1
                    step(f"what texels see along direction {begun}")

            seen = scattering.spread(field, directions, seen_along)
        frame = scattering.commands(
            field,
            seen,
            towards,
            machine,
            size,
            found=found,
            paths=paths,
            bounces=bounces,
            exposure=exposure,
            seed=seed,
            accumulation=summed,
        )
        # The progress bar counts the frame's own commands. Commands that a HostStep issues are part of it.
        own = {id(command) for command in frame}
        with progress(len(frame)) as step:
            drawing = drawn(
                frame,
                machine,
                2 * size,
                size,
                threads,
                done=lambda command: step(command.label) if id(command) in own else None,
            )
    write_whole(path, png(drawing.image))
    click.echo(
        f"{heights}: {field.columns}x{field.rows} texels, {seen.stored_bytes / 1e6:.2g} MB of what they see "
        f"along {directions} directions"
    )
    click.echo(
        f"{path}: {found.title}, {drawing.summary}; the picture with scattered light is "
        f"{scattering.gain(drawing.image):.1f} % brighter"
    )

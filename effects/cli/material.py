"""``fixedpipe material``: draw a mesh of any reflectance, under lights or in an environment."""

import click

from fixedpipe.effects.cli.options import (
    eye_of,
    limit_option,
    profile_option,
    refuse_beside,
    refuse_ignored,
    threads_option,
    three_numbers,
    view_option,
)


@click.command(short_help="Draw a mesh with any reflectance.")
@click.argument("reflectance", required=False, metavar="[NAME or FILE]")
@click.option(
    "--list", "listing", is_flag=True, help="Print the reflectances and their parameters, and draw nothing."
)
@click.option(
    "--set",
    "settings",
    metavar="NAME=VALUE",
    multiple=True,
    help="Change a parameter of the reflectance, such as alpha_x=0.15. --list names the parameters.",
)
@click.option(
    "--mesh",
    "mesh_name",
    metavar="NAME",
    default="sphere",
    show_default=True,
    help="plane, sphere, torus, teapot, or an OBJ or PLY file.",
)
@click.option(
    "--terms",
    type=click.IntRange(1, 8),
    metavar="N",
    help="How many separable products are added. Default: two, or one homomorphic product if that is better.",
)
@click.option(
    "--way",
    metavar="WAY",
    help="How the reflectance is split into factors: homomorphic, halfway (separable by halfway and "
    "difference vector) or directions (separable by light and view). Default: the smallest error.",
)
@click.option(
    "--error-at-most",
    "most",
    type=click.FloatRange(min=0.0),
    metavar="E",
    help="Draw nothing if the RMS error of the factors is more than E of the reflectance's.",
)
@click.option(
    "--color",
    metavar="R,G,B",
    default="1,1,1",
    show_default=True,
    help="A colour, 0 to 1, that multiplies the reflectance.",
)
@click.option(
    "--light",
    "lights",
    metavar="X,Y,Z",
    multiple=True,
    help="Direction to a light of intensity 1. May be given several times. Default: -1,1,1.",
)
@click.option(
    "--environment",
    metavar="NAME",
    help="Light from an environment instead of --light: room, or the file of a panorama or light probe "
    "(.hdr, .exr, PNG, TIFF, JPEG or NPY).",
)
@click.option(
    "--as",
    "layout",
    metavar="LAYOUT",
    help="Layout of the environment's file, as for fixedpipe environment: latlong, ball, mirror, cross or "
    "strip.",
)
@click.option(
    "--lights",
    "count",
    type=click.IntRange(1, 64),
    metavar="N",
    default=16,
    show_default=True,
    help="How many directional lights stand for the environment. Each one's picture is rounded to bytes.",
)
@view_option
@profile_option
@click.option("--out", metavar="FILE.png", help="Write the picture to this file.")
@click.option(
    "--size",
    type=click.IntRange(min=1),
    metavar="N",
    default=512,
    show_default=True,
    help="Width and height of the picture in pixels.",
)
@click.option(
    "--exposure",
    type=float,
    metavar="E",
    help="A number that multiplies all light. Default: 1, or less for an environment of high range.",
)
@limit_option
@threads_option
def material(
    reflectance,
    listing,
    settings,
    mesh_name,
    terms,
    way,
    most,
    color,
    lights,
    environment,
    layout,
    count,
    view,
    profile,
    out,
    size,
    exposure,
    threads,
):
    """Draw a mesh with any reflectance, on any machine, by products of textures.

    NAME is a reflectance from --list. FILE is a MERL table (.binary), or an NPZ file of fixedpipe brdf. A
    table over all directions of light and view is approximated by products of textures. The command prints
    the error of this approximation. IDEAL draws the reflectance itself at each pixel.

    An environment is replaced by directional lights. Each light has its own passes, and the resulting
    pictures are added. The environment is also the background. +x is right, +y up, +z towards you.
    """
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.progress import progress_of_long
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.reports.files import writable_picture, write_whole
    from fixedpipe.effects.user_pictures import shown_material
    from fixedpipe.effects.user_pictures.drawing import drawn
    from fixedpipe.effects.user_pictures.factored_brdf import Factorisation
    from fixedpipe.effects.user_pictures.inputs import MESH_KINDS, read_mesh
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.profiles import PROFILES

    context = click.get_current_context()
    if listing:
        refuse_beside(context, "--list")
        click.echo(shown_material.listed())
        return
    if reflectance is None:
        raise Refusal("No reflectance is given; give a name of fixedpipe material --list, or a file.")
    if out is None:
        raise Refusal("No file is given for the picture; give --out FILE.png.")
    machine = choose("profile", profile, PROFILES)
    if machine.arithmetic.exact:
        refuse_ignored(
            context,
            ("terms", "way", "most"),
            "IDEAL draws the reflectance itself, without factors; leave it out",
        )
    ways = {each.name.lower(): each for each in Factorisation}
    factorisation = way and choose("way", way, ways)
    if environment is None:
        refuse_ignored(
            context, ("count", "layout"), "they are of an --environment; leave it out, or give one"
        )
    else:
        if environment == shown_material.ROOM:
            refuse_ignored(context, ("layout",), "room is no file; leave it out")
        refuse_ignored(context, ("lights",), "the --environment gives the light; leave one of the two out")
    inputs = [each for each in (reflectance, mesh_name, environment) if each is not None]
    path = writable_picture(out, tuple(inputs))
    check_size("The picture", (size, size), machine)
    tint = three_numbers(color, "The colour", "1,0.8,0.4")
    towards = [three_numbers(each, "The light's direction") for each in lights or ("-1,1,1",)]
    eye = eye_of(view, shown_material.EYE)
    told: list[str] = []
    with refusals():
        shown_material.check_machine(machine)
        brdf = shown_material.reflectance(reflectance, _settings(settings))
        is_file = mesh_name.lower().endswith(MESH_KINDS)
        surface = read_mesh(mesh_name, tell=told.append) if is_file else shown_material.mesh(mesh_name)
        if environment is None:
            lighting = shown_material.directional(towards, exposure)
        else:
            lighting = shown_material.environment(environment, count, exposure, layout)
        if machine.arithmetic.exact:
            announce_compiling()
            with progress_of_long(1) as step:
                step("the reflectance at each pixel")
                drawing = shown_material.meant(
                    brdf, surface, lighting, size, size, color=tint, eye=eye, threads=threads
                )
            drawn_by = drawing.summary
        else:
            shown_material.check_picture(lighting, machine, size, size, tint)
            announce_compiling()
            with progress_of_long(2) as step:
                step("the factors of the reflectance")
                found = shown_material.factored(brdf, terms, factorisation)
                if most is not None and found.error > most:
                    said = shown_material.said_of(reflectance, found)
                    raise Refusal(
                        f"{said}: more than {most:g}. Give more --terms, another reflectance, or a larger "
                        "--error-at-most."
                    )
                step("the frame's commands")
                frame = shown_material.commands(
                    found, surface, lighting, machine, size, size, color=tint, eye=eye
                )
            coming = iter(frame)
            with progress_of_long(len(frame)) as step:

                def begin(_=None):
                    if (command := next(coming, None)) is not None:
                        step(command.label)

                begin()
                drawing = drawn(frame, machine, size, size, threads, done=begin)
            passes = shown_material.passes_of(frame)
            drawn_by = (
                f"{shown_material.way_of(machine)}; {passes} pass{'es' * (passes > 1)}, {drawing.summary}"
            )
            told.append(shown_material.said_of(reflectance, found))
            if doubt := shown_material.doubt_of(reflectance, found):
                click.echo(doubt, err=True)
    write_whole(path, png(drawing.image))
    for line in told:
        click.echo(line)
    if drawing.dropped:
        click.echo(f"{drawing.dropped} triangles were left out: the camera is inside them.", err=True)
    shining = len(lighting.directions)
    click.echo(f"{path}: {shining} light{'s' * (shining > 1)}, exposure {lighting.exposure:.4g}; {drawn_by}")


def _settings(settings):
    """The texts of --set by name. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal

    found = {}
    for setting in settings:
        name, equals, text = (part.strip() for part in setting.partition("="))
        if not (name and equals):
            raise Refusal(f"--set is {setting!r}; give NAME=VALUE, as alpha_x=0.15.")
        if name in found:
            raise Refusal(f"--set names {name} twice; give it once.")
        found[name] = text
    return found

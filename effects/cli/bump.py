"""``fixedpipe bump``: a photograph or an elevation model as bumps on a mesh."""

import click

from fixedpipe.effects.cli.options import (
    eye_of,
    fill_option,
    limit_option,
    profile_option,
    threads_option,
    three_numbers,
    view_option,
)


@click.command(short_help="Bump-map a mesh with a photograph.")
@click.argument("photo")
@click.option(
    "--mesh",
    "mesh_name",
    metavar="NAME",
    default="sphere",
    show_default=True,
    help="plane, sphere, torus, teapot, or an OBJ or PLY file.",
)
@click.option(
    "--material",
    "material_name",
    metavar="NAME",
    default="stone",
    show_default=True,
    help="gold, steel, brushed, stone or plastic.",
)
@click.option("--light", metavar="X,Y,Z", default="-1,1,1", show_default=True, help="Direction to the light.")
@view_option
@click.option("--out", metavar="FILE.png", required=True, help="Write the picture to this file.")
@click.option(
    "--size",
    type=click.IntRange(min=1),
    metavar="N",
    default=512,
    show_default=True,
    help="Width and height of the picture in pixels.",
)
@profile_option
@click.option(
    "--height-scale",
    type=click.FloatRange(0.0, 1.0),
    metavar="H",
    help="Height from the lowest to the highest point, in widths of the photograph. Default: the material's.",
)
@click.option(
    "--alpha-x",
    type=float,
    metavar="A",
    help="Width of the highlight along the tangents, 0.25 to 1. Default: the material's.",
)
@click.option("--alpha-y", type=float, metavar="A", help="Width of the highlight across them, 0.25 to 1.")
@click.option(
    "--map-size", type=int, metavar="N", help="Width and height of the textures in texels, a power of two."
)
@click.option(
    "--antialias",
    metavar="HOW",
    default="none",
    show_default=True,
    help="How to filter bumps smaller than a pixel: none, mip or roughness.",
)
@limit_option
@fill_option
@threads_option
def bump(
    photo,
    mesh_name,
    material_name,
    light,
    view,
    out,
    size,
    profile,
    height_scale,
    alpha_x,
    alpha_y,
    map_size,
    antialias,
    threads,
):
    """Bump-map a mesh with PHOTO: a PNG, TIFF (its first page), JPEG or NPY file, or a sample.

    Machines with register combiners compute a halfway vector at every pixel. Machines with the imaging subset
    have one for every triangle. Any other machine needs about fifty passes, and can draw wide highlights
    only: stone, or --alpha-x and --alpha-y from 0.71. IDEAL draws without rounding.

    From a distance bumps flicker. --antialias mip filters the texels like colours; the highlight of distant
    bumps then shrinks to that of a smooth surface. --antialias roughness also stores with every level how far
    the filtered normals spread, so the highlight stays wide. Both need register combiners.

    Samples: sample:gravel, sample:brick, sample:grass, sample:coins, sample:moon (photographs) and
    sample:jacksboro (an elevation model). Light texels are high, dark ones low. For --light, +x is right, +y
    up and +z towards you.
    """
    from dataclasses import replace

    from fixedpipe.effects.bump_mapping.tangent_space import examine_surface
    from fixedpipe.effects.cli.compiling import announce_compiling
    from fixedpipe.effects.cli.refusal import check_size
    from fixedpipe.effects.refusal import choose, refusals
    from fixedpipe.effects.reports.files import writable_picture, write_whole
    from fixedpipe.effects.user_pictures.bumped_mesh import (
        EYE,
        Antialiasing,
        commands,
        map_edges,
        material,
        mesh,
        way_of,
    )
    from fixedpipe.effects.user_pictures.drawing import drawn
    from fixedpipe.effects.user_pictures.inputs import MESH_KINDS, read_corners, read_picture
    from fixedpipe.pipeline.framebuffers.pictures import png
    from fixedpipe.pipeline.profiles import PROFILES

    machine = choose("profile", profile, PROFILES)
    how = choose("antialiasing", antialias, {a.value: a for a in Antialiasing})
    path = writable_picture(out, (photo, mesh_name))
    check_size("The picture", (size, size), machine)
    direction = three_numbers(light, "The light's direction")
    eye = eye_of(view, EYE)
    changed = {"relief": height_scale, "alpha_x": alpha_x, "alpha_y": alpha_y}
    told: list[str] = []
    with refusals():
        way = way_of(machine)
        parameters = replace(material(material_name), **{k: v for k, v in changed.items() if v is not None})
        if mesh_name.lower().endswith(MESH_KINDS):
            corners = read_corners(mesh_name)
            surface = corners.surface(mesh_name, smooth=True)
            told.append(f"{mesh_name}: {corners.text(smooth=True)}")
            if not (report := examine_surface(surface)).clean:
                click.echo(f"{mesh_name}: {_MADE * (not corners.has_coordinates)}{report.text()}", err=True)
        else:
            surface = mesh(mesh_name)
        picture = read_picture(photo)
        frame = commands(
            picture,
            surface,
            parameters,
            direction,
            machine,
            size,
            size,
            map_size=map_size,
            antialias=how,
            eye=eye,
        )
        shape, edges = picture.shape[:2], map_edges(picture.shape[:2], machine, map_size)
        if shape != edges:
            sizes = (f"{columns} x {rows}" for rows, columns in (shape, edges))
            told.append("{}: {} heights, fitted to a map of {} texels".format(photo, *sizes))
        announce_compiling()
        drawing = drawn(frame, machine, size, size, threads)
    write_whole(path, png(drawing.image))
    for line in told:
        click.echo(line)
    if drawing.dropped:
        click.echo(f"{drawing.dropped} triangles were left out: the camera is inside them.", err=True)
    filtered = "" if how is Antialiasing.NONE else f", antialiased by {how.value}"
    click.echo(f"{path}: {way.title}{filtered}, {drawing.summary}")


_MADE = "spherical texture coordinates, because the file does not give every corner its own: "

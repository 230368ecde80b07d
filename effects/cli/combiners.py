"""``fixedpipe combiners``: a combiner or pixel shader program of the time, checked and in words."""

import click

from fixedpipe.effects.cli.options import refuse_ignored


@click.command(short_help="Check a program of the time (RC1.0, TS1.0, ps.1.x), print it in words.")
@click.argument("file", metavar="FILE")
@click.option(
    "--profile",
    metavar="NAME",
    help="Machine that the program has to fit; without it, what no machine has is refused.",
)
@click.option(
    "--target",
    "targets",
    multiple=True,
    metavar="UNIT=TARGET",
    help="What a pixel shader's unit has bound: 1=TEXTURE_CUBE_MAP for instance. May be given again.",
)
@click.option("--rc", "notation", is_flag=True, help="Print as !!TS1.0 and !!RC1.0 text, not in words.")
@click.option("--bounds", is_flag=True, help="What every register can hold, and which clamps may bite.")
def combiners(file, profile, targets, notation, bounds):
    """Read FILE (- for standard input), a program for nvparse: ``!!RC1.0`` register combiners, ``!!TS1.0``
    texture shaders, both in one text, or a Direct3D pixel shader ps.1.0 to ps.1.3, and print what it sets, as
    equations.

    --bounds: the range of every register after every stage on the machine, for colours and texels from 0 to
    1, and of which a clamp can bite. A range may be wider than what fragments reach, and is never narrower.
    """
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.user_pictures.inputs import read_text
    from fixedpipe.pipeline.description.describe import describe_program
    from fixedpipe.pipeline.notations.programs import parse_program
    from fixedpipe.pipeline.notations.tokens import ProgramTextError
    from fixedpipe.pipeline.profiles import PROFILES
    from fixedpipe.pipeline.validation.validate import validate_program

    if bounds and (profile is None or notation):
        raise Refusal("--bounds are a machine's numbers; give --profile, and leave --rc out.")
    machine = None if profile is None else choose("profile", profile, PROFILES)
    bound = _targets(targets)
    try:
        # Of the time: comments in any encoding, which the notations skip.
        program = parse_program(read_text(file, otherwise="latin-1"), bound)
    except ProgramTextError as error:
        raise Refusal(f"{'standard input' if file == '-' else file}, {error}") from error
    if not any(name.startswith("ps.") for name in program.notations):
        refuse_ignored(
            click.get_current_context(),
            ("targets",),
            f"{' and '.join(program.notations)} says what its units read, and a pixel shader alone does not",
        )
    with refusals():
        if machine is not None:
            validate_program(program.texture_shader, program.combiners, machine)
        text = _text(program) if notation else describe_program(program.texture_shader, program.combiners)
    if notation:
        click.echo(text, nl=False)
        return
    on = "" if machine is None else f", on {machine.name}"
    click.echo(f"{' and '.join(program.notations)}{on}\n")
    click.echo(text, nl=False)
    for place in program.constants:
        where = (
            f"the eye of texture shader stage {place.stage}"
            if place.register is None
            else f"{place.register.name.lower().replace('constant_color', 'const')} of GC{place.stage}"
        )
        click.echo(f"  c{place.constant} is {where}")
    for note in program.notes:
        click.echo(f"note: {note}")
    if bounds:
        _tell_bounds(program.combiners, machine)


def _tell_bounds(combiners, machine):
    from fixedpipe.effects.refusal import Refusal, refusals
    from fixedpipe.pipeline.inspection.bounds import combiner_bounds

    if combiners is None:
        raise Refusal("This program has texture shaders alone; bounds are of register combiners.")
    with refusals():
        found = combiner_bounds(combiners, machine)
    click.echo(f"\n{'':20}{'':14}{'least':>9}{'greatest':>9}   without the clamp")
    for bound in found:
        free = f"{bound.below:12.3f}{bound.above:9.3f}" if bound.clamps else ""
        numbers = f"{bound.least:9.3f}{bound.greatest:9.3f}"
        click.echo(f"{bound.stage:20}{bound.register:14}{numbers}{free}")


def _targets(options):
    """{unit: TextureTarget} of every ``UNIT=TARGET``. Raises Refusal where a unit is given twice."""
    from fixedpipe.effects.refusal import Refusal

    found = {}
    for given in options:
        unit, target = _target(given)
        if found.setdefault(unit, target) is not target:
            raise Refusal(f"--target gives unit {unit} two targets; give it one.")
    return found


def _target(given):
    """(unit, TextureTarget) of ``UNIT=TARGET``."""
    from fixedpipe.effects.refusal import Refusal, choose
    from fixedpipe.pipeline.enums import TextureTarget

    unit, equals, name = given.partition("=")
    if not equals or unit not in ("0", "1", "2", "3"):
        raise Refusal(f"--target {given} is no UNIT=TARGET; write --target 1=TEXTURE_CUBE_MAP, units 0 to 3.")
    return int(unit), choose("texture target", name, TextureTarget.__members__)


def _text(program):
    """The program in the notations of nvparse's own."""
    from fixedpipe.pipeline.notations.register_combiner_format import format_program
    from fixedpipe.pipeline.notations.texture_shaders import format_stages

    stages, combiners = program.texture_shader, program.combiners
    return (format_stages(stages) if stages else "") + (format_program(combiners) if combiners else "")

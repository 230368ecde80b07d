"""``fixedpipe combiners``: check a combiner or pixel shader program of the time, and print it in words."""

from math import isfinite

import click

from fixedpipe.effects.cli.options import refuse_ignored


@click.command(short_help="Check a combiner program (RC1.0, TS1.0, ps.1.x, xps.1.1), and print it in words.")
@click.argument("file", metavar="FILE")
@click.option(
    "--profile",
    metavar="NAME",
    help="The machine that the program must fit. Without it, only what no machine has is refused.",
)
@click.option(
    "--target",
    "targets",
    multiple=True,
    metavar="UNIT=TARGET",
    help="The texture target that a pixel shader's unit has bound, such as 1=TEXTURE_CUBE_MAP. May be given "
    "several times.",
)
@click.option(
    "--rc", "notation", flag_value="rc", help="Print the program as !!TS1.0 and !!RC1.0 text, not in words."
)
@click.option("--ts", "notation", flag_value="ts", help="Print only its texture shaders, as !!TS1.0 text.")
@click.option(
    "--ps", "notation", flag_value="ps", help="Print the program as a pixel shader, ps.1.1 to ps.1.3."
)
@click.option(
    "--nv2a", "notation", flag_value="nv2a", help="Print the program as words of the NV2A's registers."
)
@click.option(
    "--constant",
    "constants",
    multiple=True,
    metavar="N=R,G,B,A",
    help="A constant that a pixel shader's application sets, such as 1=0.5,0.5,0.5,1. May be given several "
    "times.",
)
@click.option(
    "--draw", type=int, metavar="N", help="If a dump has several draws: which one to read. Default: the last."
)
@click.option(
    "--bounds", is_flag=True, help="Print what every register can hold, and which clamps can change a value."
)
@click.option(
    "--table",
    is_flag=True,
    help="Evaluate the program for --input, stage by stage, as fixedpipe inspect does.",
)
@click.option(
    "--input",
    "inputs",
    multiple=True,
    metavar="REGISTER=R,G,B,A",
    help="With --table: the bytes of t0 to t3, v0 or v1. One number stands for all four. May be given "
    "several times. Default: 0.",
)
@click.option("--json", "json_file", metavar="FILE", help="Write the state that the program sets as JSON.")
def combiners(file, profile, targets, notation, constants, draw, bounds, table, inputs, json_file):
    """Read FILE (- for standard input), a combiner program, and print the state that it sets as equations.
    Each equation has the lines of FILE that it comes from.

    FILE is a program for nvparse: ``!!RC1.0`` register combiners, ``!!TS1.0`` texture shaders, or both in one
    text. It may also be a Direct3D pixel shader ps.1.0 to ps.1.3, the Xbox's xps.1.1, or words of the NV2A's
    registers as an emulator's dump has them.

    A register is marked as clamped if a clamp of the machine may change it. Without --profile the machine is
    the NV2A. --bounds prints the range of every register after every stage on the machine, for colours and
    texels from 0 to 1. It also prints which clamps can change a value. A range may be wider than what
    fragments reach, but never narrower.
    """
    from fixedpipe.effects.refusal import Refusal, choose, refusals
    from fixedpipe.effects.user_pictures.inputs import read_text
    from fixedpipe.pipeline.description.program_text import program_text, usage
    from fixedpipe.pipeline.notations.nv2a_registers import HEADER
    from fixedpipe.pipeline.notations.program_sources import is_pixel_shader
    from fixedpipe.pipeline.notations.programs import parse_program
    from fixedpipe.pipeline.notations.tokens import ProgramTextError
    from fixedpipe.pipeline.profiles import PROFILES
    from fixedpipe.pipeline.validation.validate import validate_program
    from fixedpipe.pipeline.validation.walk import UnsupportedState

    for name, given in (("--bounds are", bounds), ("--table is of", table)):
        if given and (profile is None or notation):
            raise Refusal(f"{name} a machine's numbers; give --profile, and leave the notation out.")
    if json_file and (bounds or table or notation):
        raise Refusal("--json writes only what the program sets; leave --bounds, --table and notations out.")
    if inputs and not table:
        raise Refusal("--input gives --table its values; give --table too.")
    machine = None if profile is None else choose("profile", profile, PROFILES)
    bound = _targets(targets)
    try:
        # Files of the time have comments in any encoding. The notations skip comments.
        program = parse_program(
            read_text(file, otherwise="latin-1"),
            bound,
            _colors(constants),
            _per_stage_constants(machine),
            draw,
        )
    except ProgramTextError as error:
        raise Refusal(f"{'standard input' if file == '-' else file}, {error}") from error
    if not is_pixel_shader(program.notations):
        refuse_ignored(
            click.get_current_context(),
            ("targets", "constants"),
            f"{' and '.join(program.notations)} says what its units read and what its constants are, and a "
            "pixel shader alone does not",
        )
    is_dump = program.notations == (HEADER,)
    if not is_dump:
        refuse_ignored(
            click.get_current_context(), ("draw",), f"{' and '.join(program.notations)} is of no draw"
        )
    unused = sorted({number for number in _colors(constants) if number not in program.colors})
    if unused:
        raise Refusal(f"--constant {unused[0]}: the program reads no c{unused[0]}; leave it out.")
    if machine is not None:
        try:
            validate_program(program.texture_shader, program.combiners, machine)
        except UnsupportedState as error:
            raise Refusal(program.tell(str(error))) from error
    if is_dump and (notation or json_file):
        # Notes name the rules by which a dump was read. The printed text has no place for them.
        for note in program.notes:
            click.echo(f"note: {note}", err=True)
    if notation:
        with refusals():
            click.echo(_text(program, notation), nl=False)
        return
    if json_file:
        _write_json(program, json_file)
        return
    on, limits = "", ()
    if machine is not None:
        on = f", on {machine.name}"
        limits = machine.combiners.max_general_combiners, machine.textures.max_texture_units
    click.echo(f"{' and '.join(program.notations)}{on}: {usage(program, *limits)}\n")
    click.echo(program_text(program, _clamped(program, machine)), nl=False)
    for place in program.constants:
        if place.register is None:
            by = "" if place.constant in program.defined else ", set by the application"
            click.echo(f"  c{place.constant}{by} is the eye of texture shader stage {place.stage}")
    for note in program.notes:
        click.echo(f"note: {note}")
    if bounds:
        _tell_bounds(program.combiners, machine)
    if table:
        from fixedpipe.effects.cli.program_table import tell_table

        tell_table(program, machine, inputs)


def _per_stage_constants(machine):
    """Whether each combiner has constants of its own. A machine without combiners refuses them elsewhere."""
    return (
        machine is None
        or not machine.combiners.max_general_combiners
        or machine.combiners.per_stage_constants
    )


def _clamped(program, machine):
    """(number, portion, register) of each output that the clamp of the machine may change. Without a machine,
    the NV2A's clamp counts.
    """
    from fixedpipe.pipeline.inspection.bounds import combiner_bounds
    from fixedpipe.pipeline.profiles import NV2A

    if program.combiners is None:
        return ()
    found = set()
    for bound in combiner_bounds(program.combiners, machine or NV2A):
        number = bound.stage.removeprefix("general combiner ")
        register, _, component = bound.register.rpartition(".")
        if bound.clamps and number.isdigit():
            found.add((int(number), "alpha" if component == "a" else "rgb", register))
    return found


def _colors(options):
    """{number: color} of every ``N=R,G,B,A``. Raises Refusal for another form."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.pipeline.notations.xbox_pixel_shaders import CONSTANT_COUNT

    found = {}
    for given in options:
        number, _, color = given.partition("=")
        try:
            components = tuple(float(component) for component in color.split(","))
        except ValueError:
            components = ()
        if (
            number not in map(str, range(CONSTANT_COUNT))
            or len(components) != 4
            or not all(map(isfinite, components))
        ):
            raise Refusal(
                f"--constant {given} is no N=R,G,B,A; write --constant 1=0.5,0.5,0.5,1, c0 to c7, "
                f"and to c{CONSTANT_COUNT - 1} of an xps.1.1 program."
            )
        if number in map(str, found):
            raise Refusal(f"--constant gives c{number} twice; give it once.")
        found[int(number)] = components
    return found


def _write_json(program, path):
    import json

    from fixedpipe.effects.cli.frames import write_file
    from fixedpipe.pipeline.description.program_text import program_json

    write_file(path, json.dumps(program_json(program), indent=1) + "\n")


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
    """{unit: TextureTarget} of every ``UNIT=TARGET``. Raises Refusal if a unit has two targets."""
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


def _text(program, notation):
    """The program in a notation: "rc" (nvparse's own notations), "ts" (only its texture shaders, for
    nvparse), "ps" (a pixel shader) or "nv2a" (the NV2A's registers).
    """
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.pipeline.notations.nv2a_registers import format_registers
    from fixedpipe.pipeline.notations.pixel_shader_format import format_pixel_shader
    from fixedpipe.pipeline.notations.register_combiner_format import format_program
    from fixedpipe.pipeline.notations.texture_shaders import format_stages

    stages, combiners = program.texture_shader, program.combiners
    if notation == "nv2a":
        return format_registers(combiners, stages)
    if notation == "ps":
        try:
            return format_pixel_shader(program)
        except ValueError as error:
            raise Refusal(program.tell(str(error))) from error
    if notation == "ts":
        if not stages:
            raise Refusal("This program has no texture shaders; leave --ts out.")
        return format_stages(stages)
    return (format_stages(stages) if stages else "") + (format_program(combiners) if combiners else "")

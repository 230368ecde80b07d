"""Options that several subcommands share, and functions that read their values and refuse wrong ones."""

import math

import click
from click.core import ParameterSource

from fixedpipe.effects.refusal import Refusal, choose, refusals

profile_option = click.option(
    "--profile",
    metavar="NAME",
    default="GEFORCE_256",
    show_default=True,
    help="The machine, or IDEAL.",
)
threads_option = click.option(
    "--threads",
    type=click.IntRange(min=1),
    metavar="N",
    help="How many threads draw. Any number gives the same bits.",
)


view_option = click.option(
    "--view",
    metavar="X,Y,Z",
    help="Direction to the eye. Default: from the front, a little from above.",
)


def eye_of(view, usual):
    """The eye's place for --view, as far from the origin as the ``usual`` place. Without --view it is the
    ``usual`` place. Raises Refusal.
    """
    if view is None:
        return usual
    x, y, z = three_numbers(view, "The direction to the eye")
    length = math.hypot(x, y, z)
    if math.hypot(x, z) < 1e-3 * length:
        raise Refusal(f"The eye looks along y, which is up; give another --view than {view}, as 0.1,1,0.")
    return tuple(c * (math.hypot(*usual) / length) for c in (x, y, z))


def _limited(context, _, millions):
    if millions is not None:
        from fixedpipe.effects.user_pictures.reading import limit

        context.with_resource(limit(1_000_000 * millions))


limit_option = click.option(
    "--limit",
    type=click.IntRange(min=1),
    metavar="MILLIONS",
    expose_value=False,
    callback=_limited,
    help="Read a file of up to so many million pixels, voxels or samples. Default: 40 million pixels, 135 "
    "million voxels or 17 million samples. Each takes about 1.2 GB of memory.",
)


def _filled(context, _, wanted):
    if wanted:
        from fixedpipe.effects.user_pictures.reading import filling

        context.with_resource(filling())


fill_option = click.option(
    "--fill",
    is_flag=True,
    expose_value=False,
    callback=_filled,
    help="Fill missing heights (NaN, or the file's number for no data) with the mean of their neighbours.",
)


def set_option(command):
    """Add --set for a figure's parameters, and --limit and --fill, because some parameters are files."""
    return click.option(
        "--set",
        "settings",
        metavar="NAME=VALUE",
        multiple=True,
        help="Change a parameter of the figure, such as alpha_x=0.15 or light=1,1,1. fixedpipe parameters ID "
        "lists the parameters.",
    )(limit_option(fill_option(command)))


def changes_of(settings, figure, methods):
    """The values of --set by name, in the form that the figure's scenes take.

    Raises Refusal for a text without the form NAME=VALUE, and for a name given twice. It also refuses a
    parameter that the figure does not have with one of ``methods``, and a value that it cannot have.
    """
    changes = {}
    with refusals():
        for setting in settings:
            name, equals, text = (part.strip() for part in setting.partition("="))
            if not (name and equals):
                raise Refusal(f"--set is {setting!r}; give NAME=VALUE, as alpha_x=0.15.")
            if name in changes:
                raise Refusal(f"--set names {name} twice; give it once.")
            for method in methods:
                parameter = figure.offer(name, method)
                changes[name] = parameter.parse(text, f"{figure.id}'s {name}")
        for method in methods:
            figure.accepted(method, changes)
    return changes


def three_numbers(text, what, example="1,2,3", zero=False):
    """Three finite numbers, not all zero unless ``zero``, from ``x,y,z``. Raises Refusal, which names
    ``what``.
    """
    try:
        numbers = tuple(float(c) for c in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) != 3 or not all(map(math.isfinite, numbers)) or not (zero or any(numbers)):
        not_zero = "" if zero else "not all zero, "
        raise Refusal(f"{what} is {text!r}; give three numbers, {not_zero}as {example}.")
    return numbers


def machine_of(key):
    """The Profile of a machine, by its key. Raises Refusal for an unknown key, and for the ideal, which is
    not a machine.
    """
    from fixedpipe.pipeline.profiles import PROFILES

    machines = {k: p for k, p in PROFILES.items() if not p.arithmetic.exact}
    if key in PROFILES.keys() - machines.keys():
        raise Refusal(
            f"{key} is no machine, and its numbers have no width to change or measure; give one of "
            f"{', '.join(machines)}."
        )
    return choose("profile", key, machines)


def given_options(context, names=None):
    """The options and arguments given on the command line, in the order of the subcommand's help.

    Options are spelled as on the command line, arguments in capitals. ``names``: the parameters to look at;
    None: all.
    """
    return [
        p.opts[-1] if isinstance(p, click.Option) else p.human_readable_name.strip("[]").partition(" ")[0]
        for p in context.command.params
        if (names is None or p.name in names)
        and context.get_parameter_source(p.name) is ParameterSource.COMMANDLINE
    ]


def refuse_ignored(context, names, why):
    """Raise Refusal if parameters were given that would be ignored.

    ``names``: these parameters; ``why``: a sentence without its full stop, which ends with what to do.
    """
    ignored = given_options(context, names)
    if ignored:
        raise Refusal(f"{' and '.join(ignored)} would be ignored: {why}.")


def refuse_beside(context, option):
    """Raise Refusal if any other option or argument was given with ``option``, which ignores all others."""
    others = [given for given in given_options(context) if given != option]
    if others:
        raise Refusal(f"{option} prints a list and does nothing else; leave {' and '.join(others)} out.")

"""``fixedpipe profiles``: list the machines, or print one with the evidence of its values."""

import click

from fixedpipe.effects.cli.options import machine_of, refuse_ignored

_WIDE = 110  # columns of a terminal that shows whole descriptions


def _set_text(values):
    """A set in words. It says so if it has all members of the enumeration, or none."""
    if not values:
        return "none"
    members = sorted(values)
    kind = type(members[0])
    if kind is int:
        return ", ".join(map(str, members))
    missing = [m.name for m in kind if m not in values]
    if not missing:
        return f"all {len(members)}: {', '.join(m.name for m in members)}"
    return (
        f"{len(members)}, all but {', '.join(missing)}"
        if len(missing) < len(members)
        else ", ".join(m.name for m in members)
    )


def _name(value):
    return getattr(value, "name", str(value))


# Functions that put a value into words, by the value's class. Other values give their name.
_TEXTS = {
    frozenset: _set_text,
    bool: lambda value: "yes" if value else "no",
    tuple: lambda values: ", ".join(map(_name, values)),
    float: lambda value: f"{value:g}",
}


def _value_text(value):
    """A profile's value in words."""
    return _TEXTS.get(type(value), _name)(value)


def _overview(profiles, width):
    """A table with a row for each machine, for a terminal of ``width`` columns."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0))
    table.add_column("profile", no_wrap=True)
    table.add_column("machine", ratio=1)
    for heading in ("units", "combiners", "color", "depth"):
        table.add_column(heading, justify="right", no_wrap=True)
    for name, profile in profiles.items():
        framebuffers, exact = profile.framebuffers, profile.arithmetic.exact
        depths = sorted({abs(bits) for bits in framebuffers.depth_bits})
        table.add_row(
            name,
            profile.description if width >= _WIDE else profile.description.partition(":")[0],
            str(profile.textures.max_texture_units),
            str(profile.combiners.max_general_combiners or "-"),
            "float" if exact else ", ".join(map(str, framebuffers.color_bits)),
            "float" if exact else ", ".join(map(str, depths)),
        )
    return table


def _values(profile):
    """A table of all values of a machine, by section. It gives the evidence of each value, unless all have
    the same evidence.
    """
    from rich import box
    from rich.table import Table

    from fixedpipe.pipeline.profiles.sections import SECTIONS

    facts = profile.facts
    table = Table(box=box.SIMPLE, pad_edge=False)
    table.add_column("what", no_wrap=True)
    table.add_column("value", ratio=3, overflow="fold")
    if len({fact.evidence for fact in facts.values()}) > 1:
        table.add_column("evidence", ratio=4, overflow="fold")
    for section, kind in SECTIONS.items():
        table.add_section()
        table.add_row(section.replace("_", " "), style="bold")
        for name in kind.names():
            row = name, _value_text(facts[name].value), facts[name].evidence
            table.add_row(*row[: len(table.columns)])
    return table


def _lines(profile, with_evidence):
    """All values of a machine, each on a line of its own below its section's name."""
    from fixedpipe.pipeline.profiles.sections import SECTIONS

    for section, kind in SECTIONS.items():
        yield section.replace("_", " ")
        for name in kind.names():
            fact = profile.facts[name]
            yield f"  {name}: {_value_text(fact.value)}" + f" ({fact.evidence})" * with_evidence


def _change_text(now, other):
    """A field's value in words; for a set, the members that it has more or less than the profile's set."""
    if not isinstance(now, frozenset):
        return _value_text(now) or "none"
    parts = [("without", other - now), ("with", now - other)]
    return ", ".join(f"{word} {', '.join(m.name for m in sorted(of))}" for word, of in parts if of)


def _driver_lines(profile, driver):
    """How a driver changes a machine: lines, one for each kind of evidence."""
    yield f'Driver "{driver.name}", {driver.since}' + (":" if driver.facts else ": as below.")
    changes = {}
    for name, fact in driver.facts.items():
        text = _change_text(fact.value, profile.facts[name].value)
        changes.setdefault(fact.evidence, []).append(f"{name} {text}")
    for evidence, texts in changes.items():
        yield f"  {'; '.join(texts)}. {evidence}."


def _print_conf(names, year):
    """Print the gltrace.conf of a machine. Raises Refusal."""
    from fixedpipe.effects.refusal import Refusal
    from fixedpipe.effects.replays.gltrace_conf import conf_text, of_year

    if len(names) != 1:
        raise Refusal("--gltrace-conf needs one machine; name it, as in fixedpipe profiles GEFORCE_256.")
    machine = machine_of(names[0])
    click.echo(conf_text(names[0], machine if year is None else of_year(machine, year)), nl=False)


@click.command(short_help="List the machines, or print one with its evidence.")
@click.argument("names", metavar="[NAME …]", nargs=-1)
@click.option(
    "--gltrace-conf",
    "conf",
    is_flag=True,
    help="Print a gltrace.conf for apitrace. A program that is traced with it sees the machine NAME.",
)
@click.option(
    "--year",
    type=int,
    metavar="N",
    help="With --gltrace-conf: the machine with its driver of a year, such as 2001.",
)
def profiles(names, conf, year):
    """List the machines. With NAME, print all values of this machine: what it can do, how wide its numbers
    are, and how each value is known.

    The evidence is Source (a specification or paper), Measured (on silicon), Inferred (from those) or
    Assumed.
    """
    from rich.console import Console

    from fixedpipe.effects.refusal import choose
    from fixedpipe.pipeline.profiles import PROFILES

    if conf:
        _print_conf(names, year)
        return
    refuse_ignored(click.get_current_context(), ("year",), "it is of --gltrace-conf; give both")

    console = Console(soft_wrap=False, highlight=False)
    if not names:
        console.print(_overview(PROFILES, console.width))
        console.print("\nAll values of one, each with its evidence: fixedpipe profiles NAME")
        console.print("Which machine has which feature: docs/machines.md")
        return
    chosen = {name: choose("profile", name, PROFILES) for name in names}
    console.soft_wrap = not console.is_terminal
    for name, profile in chosen.items():
        console.print(f"{name}: {profile.description}", style="bold")
        if profile.ancestor is not None:
            console.print(f"Made from: {profile.ancestor.name}.")
        for driver in profile.drivers:
            for line in _driver_lines(profile, driver):
                console.print(line)
        said = {fact.evidence for fact in profile.facts.values()}
        if len(said) == 1:
            console.print(f"All values: {said.pop()}.")
        if console.is_terminal:
            console.print(_values(profile))
        else:  # a file or another program: a line for each value, whole
            for line in _lines(profile, len(said) > 1):
                click.echo(line)

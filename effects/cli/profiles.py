"""``fixedpipe profiles``: the machines, each value with its evidence."""

import click


def _value_text(value):
    """A profile's value in words; a set that holds all its enumeration's members, or none, says so."""
    if isinstance(value, frozenset):
        if not value:
            return "none"
        members = sorted(value)
        kind = type(members[0])
        if kind is int:
            return ", ".join(map(str, members))
        missing = [m.name for m in kind if m not in value]
        if not missing:
            return f"all {len(members)}: {', '.join(m.name for m in members)}"
        return (
            f"{len(members)}, all but {', '.join(missing)}"
            if len(missing) < len(members)
            else ", ".join(m.name for m in members)
        )
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    return getattr(value, "name", f"{value:g}" if isinstance(value, float) else str(value))


@click.command(short_help="Print the machines, with evidence.")
@click.argument("names", metavar="[NAME …]", nargs=-1)
def profiles(names):
    """Print the machines: what each can do, how wide its numbers are, and how each value is known.

    Evidence: Source (a specification or paper), Measured (on silicon), Inferred (from those), Assumed.
    """
    from dataclasses import fields

    from rich import box
    from rich.console import Console
    from rich.table import Table

    from effects.cli.refusal import choose
    from pipeline.profile import Profile
    from pipeline.profiles import PROFILES

    chosen = {name: choose("profile", name, PROFILES) for name in names} or PROFILES
    console = Console(soft_wrap=False, highlight=False)
    for name, profile in chosen.items():
        console.print(f"{name}: {profile.description}", style="bold")
        said = set(profile.evidence.values())
        if len(said) == 1:
            console.print(f"All values: {said.pop()}.")
        table = Table(box=box.SIMPLE, pad_edge=False)
        table.add_column("what", no_wrap=True)
        table.add_column("value", ratio=3, overflow="fold")
        if len(said) > 1:
            table.add_column("evidence", ratio=4, overflow="fold")
        for field in fields(Profile):
            if field.name not in ("name", "description", "evidence"):
                row = field.name, _value_text(getattr(profile, field.name)), profile.evidence[field.name]
                table.add_row(*row[: len(table.columns)])
        console.print(table)

"""``fixedpipe parameters``: print the parameters of a figure that a user may change."""

import json
import shlex

import click


@click.command(short_help="Print what you can change in a figure.")
@click.argument("figure_id", metavar="ID|FILE.py")
@click.option("--json", "json_file", metavar="FILE", help="Also write the parameters as a JSON list.")
def parameters(figure_id, json_file):
    """Print the parameters of figure ID, or of the FIGURE in your FILE.py: each with its value, unit and
    range, and what it does.

    You can give these values to --set of figures, passes and other commands. Commas separate the numbers of
    one value. Slashes separate several values.
    """
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.effects.reports.own_figures import figure_of

    figure = figure_of(figure_id)
    path = writable_file(json_file) if json_file else None
    rows = _rows(figure)
    if path:
        write_whole(path, (json.dumps(rows, indent=2) + "\n").encode())
    if not rows:
        click.echo(f"{figure.id} has no parameters: {figure.title}.")
        return
    click.echo(f"{figure.id}: {figure.title}\n")
    for row in rows:
        unit = f" ({row['unit']})" if row["unit"] else ""
        click.echo(f"{row['name']}={row['default']}{unit}")
        for machines, value in row["on"].items():
            click.echo(f"    {value} on {machines}")
        click.echo(f"    {row['does']}")
        if row["of"]:
            click.echo(f"    It has an effect only together with {row['of']}.")
        click.echo(f"    Give {row['allowed']}.")
    # None is a value, but a poor example. A parameter that needs another one is no example by itself.
    shown = next((row for row in rows if row["default"] != "None" and not row["of"]), None)
    if shown is not None:
        setting = shlex.quote(f"{shown['name']}={shown['default']}")
        click.echo(f"\nFor example: fixedpipe figures {shlex.quote(figure_id)} --set {setting}")


def _rows(figure):
    """A dict for each parameter that users may set, in the figure's order. Values are texts."""
    known = {
        name: p for method in reversed(figure.methods) for name, p in figure.parameters_of(method).items()
    }
    rows = []
    for name, parameter in known.items():
        if not parameter.offered:
            continue
        own = figure.parameters.get(name, parameter)
        on = {}
        for method in figure.methods:
            there = figure.parameters_of(method).get(name)
            if there is not None and (there.default != own.default or name not in figure.parameters):
                on[", ".join(method.machines)] = there.kind.show(there.default)
        rows.append(
            {
                "name": name,
                "default": own.kind.show(own.default),
                "unit": own.unit,
                "allowed": own.kind.allowed,
                "does": own.does,
                "of": own.of,
                "on": on,
            }
        )
    return rows

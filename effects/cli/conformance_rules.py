"""``--discriminates``: find captures that decide between an open rule of the arithmetic and its rival."""

import json

import click


def list_rules():
    """Print the open rules, each with its rival."""
    from fixedpipe.effects.conformance.rules import RULES

    for name, rule in RULES.items():
        click.echo(f"{name:20}{rule.question}\n{'':20}as it stands: {rule.stands}; or: {rule.otherwise}")


def tell_distinctions(name, captures, modules, inputs, json_path, progress):
    """Print the captures that distinguish the rule ``name`` from its rival. Raises Refusal if there is no
    such rule.
    """
    from fixedpipe.effects.conformance.rules import RULES
    from fixedpipe.effects.refusal import choose
    from fixedpipe.effects.reports.files import write_whole

    rule = choose("rule", name, RULES)
    click.echo(f"{rule.question}\n  as it stands: {rule.stands}\n  otherwise: {rule.otherwise}\n")
    with progress(len(captures)) as (say, step):
        told = _by_pictures if rule.changed is not None else _by_fragments
        found = list(told(rule, captures, modules, inputs, say, step))
    if json_path:
        write_whole(json_path, (json.dumps(found, indent=1) + "\n").encode())
    if not found:
        would = (
            f"; on a board {rule.probe}." if rule.probe else "; a program whose pixels depend on it would."
        )
        click.echo(f"None of {len(captures)} captures tells{would}")
    else:
        click.echo(f"{len(found)} of {len(captures)} captures tell.")


def _by_pictures(rule, captures, modules, inputs, say, step):
    """Cases whose pictures depend on the rule, and how the chip drew those pixels."""
    from fixedpipe.effects.conformance.redraw import compare
    from fixedpipe.effects.conformance.rules import distinction

    for capture in captures:
        step(f"{capture.suite}/{capture.name}")
        given = capture.suite, modules.get(capture.suite), capture.name, capture.read(), inputs
        ours = compare(*given)
        if not ours.covered:
            continue
        found = distinction(ours, compare(*given, profile=rule.changed))
        if found is None:
            continue
        say(
            f"{found.suite}/{found.name}: {found.pixels} pixels depend on it; the chip drew "
            f"{found.as_it_stands} as it stands, {found.otherwise} otherwise"
        )
        yield {"suite": found.suite, "case": found.name, "pixels": found.pixels} | {
            "as_it_stands": found.as_it_stands,
            "otherwise": found.otherwise,
        }


def _by_fragments(rule, captures, modules, inputs, say, step):
    """Cases with fragments that depend on the rule."""
    from fixedpipe.effects.conformance.case import MissingInput
    from fixedpipe.effects.conformance.rules import fragments_that_differ

    for capture in captures:
        step(f"{capture.suite}/{capture.name}")
        module = modules.get(capture.suite)
        try:
            case = module.case(capture.name, inputs) if module is not None else None
        except MissingInput:
            continue
        count = 0 if case is None else fragments_that_differ(case, rule)
        if count:
            say(f"{capture.suite}/{capture.name}: {count} components' fragments depend on it")
            yield {"suite": capture.suite, "case": capture.name, "fragments": count}

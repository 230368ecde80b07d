"""The work of ``fixedpipe golden judge``."""

import json

import click

_WIDTH = 34


def judge_program(program, names, cases, seed, patience, json_file, html_file):
    """Judge a program, print a line for each rule, and write the files whose names are given. Returns whether
    all answers are right.
    """
    from fixedpipe.effects.arithmetic.rules import RULES
    from fixedpipe.effects.emulators.judge import judged
    from fixedpipe.effects.refusal import choose
    from fixedpipe.effects.reports.files import writable_file, write_whole
    from fixedpipe.effects.reports.golden.scorecard import scorecard_page, scorecard_record

    paths = [name and writable_file(name) for name in (json_file, html_file)]
    chosen = {choose("rule", name, RULES).id for name in names} or RULES.keys()
    rules = [rule for id_, rule in RULES.items() if id_ in chosen]  # in the order of the machine
    scores = []
    for score in judged(program, rules, cases, seed, patience):
        scores.append(score)
        click.echo(_line(score))
    record = scorecard_record(program, scores, cases, seed)
    for line in _summary(record["totals"]):
        click.echo(line)
    json_path, html_path = paths
    if json_path:
        write_whole(json_path, (json.dumps(record, indent=1) + "\n").encode())
    if html_path:
        write_whole(html_path, scorecard_page(record).encode())
        click.echo(f"{html_path} shows the results; open it in a browser.")
    return all(score.whole for score in scores)


def _shown(value):
    return "[" + ", ".join(map(str, value)) + "]" if type(value) is list else str(value)


def _line(score):
    from fixedpipe.effects.emulators.judge import tag_of

    begin = f"{score.rule.id:{_WIDTH}} {f'{score.right} of {score.vectors}':>12}  {tag_of(score.rule):9}"
    captures = len(score.rule.captures)
    begin += f"{f'{captures} captures' if captures != 1 else '1 capture':>12}"
    if score.absent:
        return f"{begin}  not answered"
    if score.failure:
        return f"{begin}  {score.failure}"
    if score.first is None:
        return begin
    inputs = ", ".join(f"{name} {_shown(value)}" for name, value in score.first["inputs"].items())
    expected, answered = (_shown(score.first[name]) for name in ("expected", "answered"))
    return f"{begin}  {inputs}: {expected}, not {answered[:80]}"


def _summary(totals):
    yield (
        f"{totals['whole']} of {totals['rules']} rules are whole, {totals['right']} of {totals['vectors']} "
        f"vectors right; {totals['absent']} rules not answered, {totals['failed']} failed."
    )
    parts = (f"{tag} {found['whole']} of {found['rules']}" for tag, found in totals["by_evidence"].items())
    yield f"Rules that are whole, by their evidence: {', '.join(parts)}."

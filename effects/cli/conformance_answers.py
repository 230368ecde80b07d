"""A real board's answers to the open questions: ``--answers``."""

import json

import click


def tell_answers(name, json_file):
    """Print which facts the answers in the file ``name`` confirm. Raises Refusal for a wrong file."""
    from fixedpipe.effects.cli.frames import check_files, write_file
    from fixedpipe.effects.conformance.answers import read_answers
    from fixedpipe.effects.user_pictures.inputs import read_text

    board, answers = read_answers(read_text(name), "standard input" if name == "-" else name)
    check_files(json_file)
    click.echo(board)
    for answer in answers:
        byte = "" if answer.byte is None else answer.byte
        click.echo(f"{answer.name:20}{byte:>4}  {answer.sentence()}")
    verdicts = [answer.verdict for answer in answers]
    asked = len(verdicts) - verdicts.count("not asked")
    click.echo(
        f"{asked} of {len(verdicts)} questions were asked: {verdicts.count('stands')} as it stands, "
        f"{verdicts.count('otherwise')} otherwise, {verdicts.count('neither')} neither."
    )
    if json_file:
        rows = [
            {"question": a.name, "answer": a.byte, "verdict": a.verdict, "as_it_stands": a.question.byte}
            for a in answers
        ]
        write_file(json_file, json.dumps({"board": board, "answers": rows}, indent=1) + "\n")

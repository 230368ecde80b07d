"""Every row of what others refuse and is accepted here, and the other way round."""

import pytest

from fixedpipe.pipeline.notations.programs import parse_program
from fixedpipe.pipeline.notations.register_combiner_format import format_program
from fixedpipe.pipeline.notations.texture_shaders import format_stages
from fixedpipe.pipeline.notations.tokens import ProgramTextError
from tests.support.refusals import REFUSALS, SOURCES

ROWS = [pytest.param(row, id=f"{title}: {row.construct}") for title, _, rows in REFUSALS for row in rows]


def said(program):
    """What is said of a program: its notes, its operations, and it in nvparse's notations, on one line."""
    stages = format_stages(program.texture_shader) if program.texture_shader else ""
    combiners = format_program(program.combiners) if program.combiners else ""
    operations = [stage.operation.name for stage in program.texture_shader or ()]
    return " ".join([*program.notes, *operations, *stages.split(), *combiners.split()])


@pytest.mark.parametrize("row", ROWS)
def test_a_row_says_what_happens(row):
    assert row.source in SOURCES
    if row.accepted:
        assert row.proof in said(parse_program(row.program))
    else:
        with pytest.raises(ProgramTextError) as refused:
            parse_program(row.program)
        assert row.proof in str(refused.value)

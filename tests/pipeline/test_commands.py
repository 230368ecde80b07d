"""Commands are one list, and whoever has a table of them has every one in it."""

import pytest

from fixedpipe.pipeline.commands import COMMANDS
from fixedpipe.pipeline.description.describe import DESCRIPTIONS
from fixedpipe.pipeline.execution.machine import METHODS
from fixedpipe.pipeline.ideal import evaluate
from fixedpipe.pipeline.validation.validate import VALIDATIONS
from tests.support import run_reference

TABLES = {
    "validation": VALIDATIONS,
    "execution": METHODS,
    "ideal": evaluate.OPERATIONS,
    "description": DESCRIPTIONS,
    "reference": run_reference.OPERATIONS,
}


@pytest.mark.parametrize("table", TABLES)
def test_every_table_of_commands_has_each_command_and_no_other(table):
    assert set(TABLES[table]) == set(COMMANDS)

"""Commands are one list, and whoever has a table of them has every one in it."""

import pytest

from fixedpipe import pipeline
from fixedpipe.pipeline.commands import COMMANDS
from fixedpipe.pipeline.description.describe import DESCRIPTIONS
from fixedpipe.pipeline.execution.machine import METHODS
from fixedpipe.pipeline.ideal import evaluate
from fixedpipe.pipeline.profiles import PROFILES
from fixedpipe.pipeline.validation.validate import VALIDATIONS
from tests.support import run_reference

TABLES = {
    "validation": VALIDATIONS,
    "execution": METHODS,
    "ideal": evaluate.OPERATIONS,
    "description": DESCRIPTIONS,
    "reference": run_reference.OPERATIONS,
}


def test_the_door_has_every_command_and_every_machine():
    offered = {command.__name__ for command in COMMANDS} | PROFILES.keys()
    assert offered <= set(pipeline.__all__) <= set(dir(pipeline))
    for name in pipeline.__all__:  # each is where the table of names says
        assert getattr(pipeline, name) is not None
    with pytest.raises(AttributeError, match=r"'Lattice'; dir.* tokens are in fixedpipe.pipeline.enums"):
        pipeline.Lattice  # noqa: B018 (asking is what is tested)


@pytest.mark.parametrize("table", TABLES)
def test_every_table_of_commands_has_each_command_and_no_other(table):
    assert set(TABLES[table]) == set(COMMANDS)

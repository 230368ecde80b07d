"""docs/arithmetic-for-emulators.md is what the rules and their vectors say."""

from fixedpipe.effects.arithmetic.rules import RULES
from tests import arithmetic


def test_the_page_is_up_to_date():
    assert arithmetic.PAGE.read_text() == arithmetic.page(), "make arithmetic"


def test_every_rule_has_a_row_and_a_stage_one_table():
    text = arithmetic.PAGE.read_text()
    for rule in RULES.values():
        assert f"| `{rule.id}` | [{rule.numbers}]" in text
        assert text.count(f"\n## {rule.stage}\n") == 1

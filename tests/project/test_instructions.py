"""docs/program-instructions.md is what the readers, the profiles and the proved rows say."""

from fixedpipe.pipeline.notations.pixel_shaders import ARITHMETIC
from fixedpipe.pipeline.notations.register_combiner_words import MAPPING_WORDS, SCALES
from tests import instructions
from tests.support.instructions import GROUPS


def constructs(key):
    return {row.construct for row in GROUPS[key].rows}


def test_the_page_is_up_to_date():
    assert instructions.PAGE.read_text() == instructions.page(), "make instructions"


def test_every_construct_has_a_row():
    """Texture instructions and operations are listed from the readers' own tables."""
    assert constructs("instructions") == set(ARITHMETIC)
    words = {f"{sign}{function}(x)" if function else f"{sign}x" for sign, function in MAPPING_WORDS.values()}
    assert words <= constructs("mappings")
    assert {f"{word}()" for word in SCALES} <= constructs("scales")
    assert {"_x2", "_x4", "_d2", "_sat"} <= constructs("modifiers")
    for source in ("r1", "-r1", "1-r1", "r1_bx2", "-r1_bx2", "r1_bias", "-r1_bias", "r1.a"):
        assert source in constructs("sources")

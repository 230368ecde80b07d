"""A pass that reads the texture of a unit that it does not enable is drawn, and says so, once."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from fixedpipe.effects.cli import main
from fixedpipe.pipeline import (
    GEFORCE_3,
    GEFORCE_256,
    NV2A,
    DisabledTexture,
    Draw,
    Mesh,
    PassState,
    TexImage,
    TextureEnvironment,
    TextureShaderStage,
    TextureUnit,
    execute,
    parse_program,
    texture_2d,
    validate,
)
from fixedpipe.pipeline.enums import CombineSource, TextureEnvironmentMode, TextureShaderOperation
from fixedpipe.pipeline.state import Combine

TRIANGLE = Mesh([[-1, -1], [3, -1], [-1, 3]], texture_coordinates=(np.zeros((3, 2)),) * 2)
WHITE = TexImage(label="white", texture="t", image=texture_2d(np.full((1, 1, 4), 255, np.uint8)))
UNITS = (TextureUnit("t"),)
READS_TEXTURE3 = "!!RC1.0 {rgb {spare0 = tex3;}} out.rgb = spare0; out.a = unsigned_invert(zero);"


def frame(text=None, units=UNITS, **state):
    combiners = None if text is None else parse_program(text).combiners
    return WHITE, Draw(
        label="pass",
        mesh=TRIANGLE,
        state=PassState(texture_units=units, register_combiners=combiners, **state),
    )


def said(commands, profile=GEFORCE_3):
    """What is said of a frame, once it and once it again is validated."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for _ in range(2):
            validate(commands, profile, 4, 4)
    assert all(w.category is DisabledTexture and w.filename == __file__ for w in caught)
    return [str(w.message) for w in caught]


def test_a_register_of_a_disabled_unit_is_said_and_black():
    commands = frame(READS_TEXTURE3)
    with pytest.warns(
        DisabledTexture, match=r"\"pass\": General combiner 0 reads TEXTURE3, and texture unit 3"
    ):
        image = execute(commands, GEFORCE_3, 4, 4).image()
    assert (image == (0, 0, 0, 255)).all()
    (sentence,) = said(frame(READS_TEXTURE3))
    assert sentence.endswith("opaque black, (0, 0, 0, 1). Enable the unit, or read another register.")


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("{rgb {spare0 = tex0;}} out.rgb = spare0; out.a = tex0.a;", []),
        ("{rgb {spare0 = tex1;}} out.rgb = spare0; out.a = tex0.a;", ["General combiner 0 reads TEXTURE1"]),
        ("{rgb {spare0 = tex0;}} out.rgb = spare0; out.a = tex2.a;", ["The final combiner reads TEXTURE2"]),
        # Written first, it is a register as any other; its alpha was not written.
        ("{rgb {tex2 = col0;}} {rgb {spare0 = tex2;}} out.rgb = tex2; out.a = tex0.a;", []),
        (
            "{rgb {tex2 = col0;}} {rgb {spare0 = tex2;}} out.rgb = spare0; out.a = tex2.a;",
            ["The final combiner reads TEXTURE2"],
        ),
        ("{rgb {tex2 = tex2;}} out.rgb = tex2; out.a = tex0.a;", ["General combiner 0 reads TEXTURE2"]),
        (
            "{rgb {spare0 = tex1 * tex3;}} out.rgb = spare0; out.a = tex1.a;",
            ["General combiner 0 reads TEXTURE1", "General combiner 0 reads TEXTURE3"],
        ),
    ],
)
def test_what_is_read_before_it_is_written_is_said_once(text, wanted):
    sentences = said(frame(f"!!RC1.0 {text}"))
    assert [sentence.split(": ")[1].split(",")[0] for sentence in sentences] == wanted


def test_a_stage_of_a_texture_shader_that_is_none_is_a_disabled_unit():
    text = "!!RC1.0 {rgb {spare0 = tex1;}} out.rgb = spare0; out.a = tex0.a;"
    read = TextureShaderStage(TextureShaderOperation.TEXTURE_2D)
    units = (TextureUnit("t"),) * 2
    assert said(frame(text, units, texture_shader=(read, read))) == []
    assert len(said(frame(text, units, texture_shader=(read, TextureShaderStage())))) == 1


@pytest.mark.parametrize(("profile", "gets"), [(GEFORCE_256, "so it reads ones"), (NV2A, "so it reads ones")])
def test_an_environment_that_names_a_disabled_unit_is_said(profile, gets):
    half = Combine(sources=(CombineSource.TEXTURE1, CombineSource.PREVIOUS, CombineSource.CONSTANT))
    unit = TextureUnit("t", environment=TextureEnvironment(TextureEnvironmentMode.COMBINE, rgb=half))
    (sentence,) = said(frame(units=(unit,)), profile)
    assert "the environment of texture unit 0 reads TEXTURE1" in sentence and gets in sentence
    assert said(frame(units=(unit, TextureUnit("t"))), profile) == []
    unused = replace(unit, environment=replace(unit.environment, mode=TextureEnvironmentMode.MODULATE))
    assert said(frame(units=(unused,)), profile) == []


def test_the_command_line_says_it_once_and_as_a_sentence(monkeypatch):
    @main.command("draws-black")
    def draws_black():
        for _ in range(2):
            execute(frame(READS_TEXTURE3), GEFORCE_3, 4, 4)

    monkeypatch.setattr("fixedpipe.effects.cli._COMMANDS", ("draws-black",))
    monkeypatch.setattr(type(main), "get_command", lambda *_: draws_black)
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        done = CliRunner().invoke(main, ["draws-black"])
    assert done.exit_code == 0, done.output
    assert done.stderr.startswith('fixedpipe: Command 1, "pass": General combiner 0 reads TEXTURE3')
    assert done.stderr.count("TEXTURE3") == 1 and "Warning" not in done.stderr

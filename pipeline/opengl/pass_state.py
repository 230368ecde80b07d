"""Makes the PassState of a draw from its sections. The modules of the various subjects define these."""

from fixedpipe.pipeline.opengl import driver
from fixedpipe.pipeline.opengl.values import section
from fixedpipe.pipeline.opengl.vertex_program_draws import ENABLED, programmed_state
from fixedpipe.pipeline.state import PassState

# The fields of PassState, and the section that makes each field.
_FIELDS = {
    "vertex": "vertex",
    "polygon": "polygon",
    "texture_units": "texture_units",
    "register_combiners": "register_combiners",
    "color_sum": "color_sum",
    "fog": "fog",
    "scissor": "scissor section",
    "alpha_test": "alpha_test",
    "stencil_test": "stencil_test",
    "depth_test": "depth_test",
    "blending": "blending",
    "logic_op": "logic_op",
    "color_mask": "color_mask section",
    "texture_shader": "texture_shader",
    "perspective_correction": "perspective_correction",
    "point": "point",
    "line": "line",
    "depth_clamp": "depth_clamp",
}


@section("pass", ENABLED, "position kept", *_FIELDS.values())
def _pass(gl, programmed, keeps_position, *parts):
    state = PassState(**dict(zip(_FIELDS, parts, strict=True)))
    return driver.place_sprite(gl.profile, programmed_state(state, keeps_position) if programmed else state)

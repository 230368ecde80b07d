"""A frame of the stranger's, on a machine of fixedpipe's."""

import os

from fixedpipe.pipeline import GEFORCE_256, Clear, Draw, Mesh, PassState, parse_program


def test_combiners(golden):
    factor = "const0" if os.environ.get("STRANGER_BUG") else "col0"
    squared = parse_program(
        "!!RC1.0 const0 = (0.5, 0.5, 0.5, 0.5); { rgb { spare0 = col0 * "
        f"{factor}; }} }} out.rgb = spare0; out.a = unsigned_invert(zero);"
    ).combiners
    triangle = Mesh([[-1, -1], [3, -1], [-1, 3]], colors=[[0.3, 0.6, 0.9]] * 3)
    frame = (
        Clear(label="black", color=(0, 0, 0, 0)),
        Draw(label="the colour, squared", mesh=triangle, state=PassState(register_combiners=squared)),
    )
    golden.frame(frame, GEFORCE_256, 8, 8, engine="columns")

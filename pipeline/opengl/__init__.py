"""OpenGL 1.0 to 1.5 as calls: a ``Context`` takes OpenGL's calls and makes commands.

``Context(profile, width, height)`` has OpenGL's entry points as methods. It draws nothing. An application's
calls become ``Draw``, ``TexImage`` and other commands, which a ``Machine`` runs.
"""

# Each of these modules adds its calls to the table of entry points, and declares its state.
from fixedpipe.pipeline.opengl import (  # noqa: F401
    arb_vertex_programs,
    array_draws,
    arrays,
    attributes,
    buffers,
    capabilities,
    color_buffers,
    combiners,
    compressed_images,
    current,
    environments,
    evaluators,
    fog,
    fragments,
    framebuffer_blits,
    framebuffer_objects,
    images,
    imaging_copies,
    lighting,
    lists,
    matrices,
    occlusion_queries,
    pass_state,
    pixel_transfers,
    pixels,
    points,
    queries,
    rectangles,
    selection,
    texture_queries,
    texturing,
    tokens,
    vertex_array_objects,
    vertex_program_draws,
    vertex_program_objects,
    vertex_programs,
)
from fixedpipe.pipeline.opengl.context import Context

__all__ = ["Context", "tokens"]

"""The brushed sphere of F004-4 and K04: how finely it is cut, and how it is brushed."""

from fixedpipe.effects.figures import parameters as word

# The parameters of ``material_textures.brushed`` and of the sphere; alphas are each figure's own.
BRUSHED_SPHERE = {
    "slices": word.SLICES(50),
    "stacks": word.STACKS(26),
    "map_columns": word.TEXELS(512, "Columns of the material's textures: texels around the axis."),
    "map_rows": word.TEXELS(256, "Rows of the material's textures: texels from pole to pole."),
    "spread": word.SPREAD(8.0),
    "depth": word.STROKE_DEPTH(0.25),
    "k_s": word.K_S((0.5, 1.0)),
}

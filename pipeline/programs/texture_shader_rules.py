"""Rules of texture shaders (NV_texture_shader): allowed sequences of stages, and what each stage reads."""

from fixedpipe.pipeline.enums import ColorKeyOperation, DotProductMapping, TextureTarget
from fixedpipe.pipeline.enums import TextureShaderOperation as Operation
from fixedpipe.pipeline.state import TextureShaderStage
from fixedpipe.raster import codes as C

# Stages that sample the unit's own texture, as units without texture shaders do.
CONVENTIONAL = frozenset(
    {
        Operation.TEXTURE_1D,
        Operation.TEXTURE_2D,
        Operation.TEXTURE_RECTANGLE,
        Operation.TEXTURE_CUBE_MAP,
        Operation.TEXTURE_3D,
    }
)
# Stages that read no texture.
WITHOUT_TEXTURE = frozenset(
    {
        Operation.PASS_THROUGH,
        Operation.CULL_FRAGMENT,
        Operation.DOT_PRODUCT,
        Operation.DOT_PRODUCT_DEPTH_REPLACE,
    }
)
# Stages that may discard a fragment, or change its depth.
DISCARDING = frozenset({Operation.CULL_FRAGMENT, Operation.DOT_PRODUCT_DEPTH_REPLACE})
# Operations that compute coordinates.  Source: table 3.C.
DEPENDENT = frozenset(
    {
        Operation.OFFSET_TEXTURE_2D,
        Operation.OFFSET_TEXTURE_2D_SCALE,
        Operation.OFFSET_TEXTURE_RECTANGLE,
        Operation.OFFSET_TEXTURE_RECTANGLE_SCALE,
        Operation.DEPENDENT_AR_TEXTURE_2D,
        Operation.DEPENDENT_GB_TEXTURE_2D,
        Operation.DOT_PRODUCT_TEXTURE_2D,
        Operation.DOT_PRODUCT_TEXTURE_RECTANGLE,
        Operation.DOT_PRODUCT_TEXTURE_3D,
        Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP,
        Operation.DOT_PRODUCT_REFLECT_CUBE_MAP,
        Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP,
        Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP,
        Operation.BRDF_TEXTURE_3D,
    }
)
# The textures that operations read: first that of table 3.B, then others that the chip reads too. Measured:
# cube maps as volumes, 2D textures as cube maps (DotSTR3D and Texture_2D_as_cubemap captures).
_2D, _CUBE = TextureTarget.TEXTURE_2D, TextureTarget.TEXTURE_CUBE_MAP
TARGETS_READ = {
    Operation.TEXTURE_1D: (TextureTarget.TEXTURE_1D,),
    Operation.TEXTURE_2D: (_2D,),
    Operation.TEXTURE_RECTANGLE: (TextureTarget.TEXTURE_RECTANGLE,),
    Operation.TEXTURE_CUBE_MAP: (_CUBE, _2D),
    Operation.TEXTURE_3D: (TextureTarget.TEXTURE_3D,),
    Operation.OFFSET_TEXTURE_2D: (_2D,),
    Operation.OFFSET_TEXTURE_2D_SCALE: (_2D,),
    Operation.OFFSET_TEXTURE_RECTANGLE: (TextureTarget.TEXTURE_RECTANGLE,),
    Operation.OFFSET_TEXTURE_RECTANGLE_SCALE: (TextureTarget.TEXTURE_RECTANGLE,),
    Operation.DEPENDENT_AR_TEXTURE_2D: (_2D,),
    Operation.DEPENDENT_GB_TEXTURE_2D: (_2D,),
    Operation.DOT_PRODUCT_TEXTURE_2D: (_2D,),
    Operation.DOT_PRODUCT_TEXTURE_RECTANGLE: (TextureTarget.TEXTURE_RECTANGLE,),
    Operation.DOT_PRODUCT_TEXTURE_3D: (TextureTarget.TEXTURE_3D, _CUBE, _2D),
    Operation.DOT_PRODUCT_TEXTURE_CUBE_MAP: (_CUBE, _2D),
    Operation.DOT_PRODUCT_REFLECT_CUBE_MAP: (_CUBE, _2D),
    Operation.DOT_PRODUCT_CONST_EYE_REFLECT_CUBE_MAP: (_CUBE, _2D),
    Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP: (_CUBE, _2D),
    Operation.BRDF_TEXTURE_3D: (TextureTarget.TEXTURE_3D,),
}
# Operations that scale an unsigned texture's colours.  Source: NV_texture_shader, table 3.B.
SCALING = tuple(map(Operation, C.OPERATIONS_WITH_SCALE))
# Operations whose lookup roughness may filter.
ROUGH = (Operation.OFFSET_TEXTURE_2D, Operation.DOT_PRODUCT_TEXTURE_2D)
_REFLECTING = tuple(map(Operation, C.OPERATIONS_REFLECTING))
_WITHOUT_RESULT = (
    Operation.NONE,
    Operation.CULL_FRAGMENT,
    Operation.DOT_PRODUCT,
    Operation.DOT_PRODUCT_DEPTH_REPLACE,
)
_WORDS = (DotProductMapping.UNSIGNED_HILO, DotProductMapping.SIGNED_HILO_HEMISPHERE)
_HOLDS_WORDS = 8  # bits of a texel's components; two of them hold a word of 16 bits


def shader_stages(state):
    """A texture shader stage for every texture unit, or None where texture shaders are disabled."""
    if state.texture_shader is None:
        return None
    missing = len(state.texture_units) - len(state.texture_shader)
    return (*state.texture_shader, *(TextureShaderStage(),) * missing)


def stage_problem(i, stages):
    """A sentence that says what is inconsistent about texture shader stage ``i``, or None.

    Source: NV_texture_shader, table 3.A.
    """
    operations = [stage.operation for stage in stages]
    operation, previous = operations[i], stages[i].previous_texture_input
    if operation is Operation.BRDF_TEXTURE_3D:
        if i < 2 or any(operations[k] in _WITHOUT_RESULT for k in (i - 2, i - 1)):
            return (
                f"texture shader stage {i} is BRDF_TEXTURE_3D; it reads the eye's and the light's directions "
                "of the two stages before it, which must result in a color or a texel."
            )
        return None
    dotted = operation.name.startswith("DOT_PRODUCT")
    if (dotted or operation in DEPENDENT) and (
        not 0 <= previous < i or operations[previous] in _WITHOUT_RESULT
    ):
        given = operations[previous].name if 0 <= previous < len(stages) else "no stage"
        return (
            f"texture shader stage {i} ({operation.name}) reads stage {previous} ({given}); give "
            "previous_texture_input an earlier stage that results in a color or a texel."
        )
    if not dotted or operation is Operation.DOT_PRODUCT:
        return None
    before = 2 if operation in C.OPERATIONS_OF_THREE_DOT_PRODUCTS else 1
    for k in range(1, before + 1):
        allowed = (Operation.DOT_PRODUCT,)
        if k == 1 and operation in _REFLECTING:
            allowed = (Operation.DOT_PRODUCT, Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP)
        if i < k or operations[i - k] not in allowed:
            return (
                f"texture shader stage {i} is {operation.name}; the stage {k} before it must be "
                f"{' or '.join(a.name for a in allowed)}."
            )
    if operation is Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP and (
        i + 1 >= len(stages) or operations[i + 1] not in _REFLECTING
    ):
        return (
            f"texture shader stage {i} is DOT_PRODUCT_DIFFUSE_CUBE_MAP; the stage after it must be "
            f"{' or '.join(a.name for a in _REFLECTING)}."
        )
    if operation is Operation.DOT_PRODUCT_DIFFUSE_CUBE_MAP and stages[i + 1].previous_texture_input == i:
        return (
            f"texture shader stage {i} ({operation.name}) reads where stage {i + 1}'s dot product says, and "
            f"that reads stage {i}; give stage {i + 1} an earlier previous_texture_input."
        )
    if operation is Operation.DOT_PRODUCT_DEPTH_REPLACE and operation in operations[:i]:
        return (
            f"texture shader stage {i} is a second DOT_PRODUCT_DEPTH_REPLACE; a fragment has one depth, so "
            "leave one of them out."
        )
    return None


def roughness_problem(i, stages):
    """A sentence that says what is wrong with the roughness that stage ``i`` reads, or None."""
    stage = stages[i]
    if stage.roughness is None:
        return None
    if stage.operation not in ROUGH:
        return (
            f"texture shader stage {i} is {stage.operation.name}, which no roughness filters; leave "
            f"roughness None, or take {' or '.join(o.name for o in ROUGH)}."
        )
    given = stages[stage.roughness].operation if 0 <= stage.roughness < len(stages) else Operation.NONE
    if not 0 <= stage.roughness < i or given in _WITHOUT_RESULT:
        return (
            f"texture shader stage {i} takes its roughness of stage {stage.roughness}; give it an earlier "
            "stage that results in a color or a texel."
        )
    if not 0.0 <= stage.roughness_scale < float("inf"):
        return (
            f"texture shader stage {i} has the roughness_scale {stage.roughness_scale:g}; give a finite "
            "number from 0 on."
        )
    return None


def texture_shader_problems(stages):
    """Yields (stage number, sentence) for each problem of ``stages`` on all machines with texture shaders."""
    for i, stage in enumerate(stages):
        if stage.operation is not Operation.NONE and (problem := stage_problem(i, stages)):
            yield i, problem


def texture_target(operation):
    """The target of the texture that a texture shader operation reads (table 3.B), or None."""
    return TARGETS_READ.get(operation, (None,))[0]


def stage_width_problem(stages, widths, profile):
    """A sentence that says why texels of these widths cannot be read as words of 16 bits, or None.

    ``widths`` are in bits, of each stage's texel; None for a stage without a texel.
    """
    for i, stage in enumerate(stages):
        if stage.operation is Operation.BRDF_TEXTURE_3D:
            read = i - 2, i - 1
        elif stage.operation.name.startswith("DOT_PRODUCT") and stage.dot_product_mapping in _WORDS:
            read = (stage.previous_texture_input,)
        else:
            continue
        for k in read:
            if widths[k] != _HOLDS_WORDS:
                return (
                    f"texture shader stage {i} ({stage.operation.name}) reads words of 16 bits of stage {k}, "
                    f"whose components have {widths[k]} bits on {profile.name}; give stage {k} a HILO16 "
                    "texture, or the dot product another mapping."
                )
    return None


def killing_units(state):
    """Numbers of the units whose color keys discard fragments.

    They are all such units that are sampled, even if nothing reads the sample. Measured: UnsampledTex
    (Color_key captures).
    """
    return tuple(
        i
        for i, unit in enumerate(state.texture_units)
        if unit is not None
        and unit.color_key is not None
        and unit.color_key.operation == ColorKeyOperation.KILL
        and reads_texture(state, i)
    )


def reads_texture(state, i):
    """Whether a state's unit i has a texel, its own or its texture shader stage's."""
    if state.texture_units[i] is None or state.texture_units[i].texture is None:
        return False
    stages = shader_stages(state)
    return stages is None or stages[i].operation not in WITHOUT_TEXTURE | {Operation.NONE}

"""The code's names for the rules' names: one scheme for C and GLSL."""

# By what an input is called: the words before its names' constants.
_PREFIXES = {
    "scale": "SCALE",
    "bias": "BIAS",
    "select": "MUX",
    "mapping": "MAPPING",
    "wrap": "WRAP",
    "function": "COMPARE",
    "mode": "FOG",
    "modes": "CULL",
}
_OPERATIONS = {"stencil-operation": "STENCIL", "logic-operation": "LOGIC"}


def function_of(id_: str) -> str:
    """The function of a rule: ``blend-func-add`` is ``nv2a_blend_func_add``."""
    return f"nv2a_{id_.replace('-', '_')}"


def constant_of(id_: str, name: str, value: str) -> str:
    """The constant of a value of a rule's input that is a name: ``NV2A_WRAP_REPEAT``."""
    prefix = _OPERATIONS[id_] if name == "operation" else _PREFIXES[name]
    return f"NV2A_{value}" if value.startswith(f"{prefix}_") else f"NV2A_{prefix}_{value}"

"""All rules, in the order in which a machine computes."""

from fixedpipe.effects.arithmetic import combiners, depth, fragments, texture_shaders, textures, vertices
from fixedpipe.effects.arithmetic.rule import Rule

RULES: dict[str, Rule] = {
    rule.id: rule
    for module in (vertices, depth, textures, texture_shaders, combiners, fragments)
    for rule in module.RULES
}

"""Small states as JSON, and the pixel that a machine draws of each: ``fixedpipe pixel``.

``values`` reads JSON as the values that states are made of, ``states`` a whole file, ``drawing`` draws it,
and ``schema`` describes it. docs/pixel-states.md is for those who write such files.
"""

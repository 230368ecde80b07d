"""The portable engine: plain loops, for every state. Each stage is a module, and has the same name in the
other engines.
"""

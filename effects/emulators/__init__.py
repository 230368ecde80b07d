"""For authors of emulators: the NV2A's arithmetic as code that they can paste, and a judge of their own
code.
"""

"""Light that is scattered between the bumps of a height field: visibility that is computed once, and what is
made of it. Source: Heidrich, Daubert, Kautz, Seidel 2000.
"""

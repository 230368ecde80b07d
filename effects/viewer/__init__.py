"""The live viewer: a machine draws a frame while the user changes its parameters, its machine or its camera.

``subjects`` has the frames that can be viewed, and ``views`` a window's requests. ``studio`` draws them, and
``worker`` drops a request when a newer one arrives. ``conversation`` exchanges messages with a page. They go
through a WebSocket of this computer (``server``) or through a notebook (``widget``).
"""

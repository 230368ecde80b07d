"""The live viewer: a frame drawn by a machine while its parameters, its machine and its camera are moved.

``subjects`` says what can be viewed, ``views`` how it is asked for, ``studio`` draws it, ``worker`` lets the
newest request win, ``conversation`` talks with a page, by whatever way: ``server`` by a WebSocket of this
computer, ``widget`` by a notebook's messages.
"""

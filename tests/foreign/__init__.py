"""Cases of other projects' test suites, on every machine here: pictures whose colours nobody here chose.

WineHQ's tests of Direct3D 8 and 9 hold on drivers and chips of the time; piglit's hold on OpenGL drivers.
Each module has one subject, names its source, and lists at its end where a machine is known to draw
otherwise and who is right. Coordinates, colours and tolerances are the tests' own; where a test's window is
larger than its colours need, a smaller one is drawn.
"""

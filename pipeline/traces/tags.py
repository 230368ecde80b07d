"""Tags, the bytes that say what follows them in a trace; and the versions of the format.

Source: apitrace's docs/FORMAT.markdown; for version 6 its lib/trace/trace_format.hpp and trace_parser.cpp.
"""

# Events.
ENTER, LEAVE = 0x00, 0x01
# Details of a call.
END, ARGUMENT, RESULT, THREAD, BACKTRACE, FLAGS = range(6)
# Values.
NULL, FALSE, TRUE, NEGATIVE, UNSIGNED, FLOAT, DOUBLE, STRING = range(0x00, 0x08)
BLOB, ENUM, BITMASK, ARRAY, STRUCT, OPAQUE, REPR, WIDE_STRING = range(0x08, 0x10)
# Details of a frame of a backtrace. Strings: module, function, file. Numbers: line, offset.
FRAME_STRINGS, FRAME_NUMBERS = (0x01, 0x02, 0x03), (0x04, 0x05)
# The bit of FLAGS for a call that apitrace inserted, such as one with the bytes of a client array.
FAKE = 0x01

# The oldest and the newest version that are read and written.
# Then the versions that added enumerations with all their names, the thread at the beginning of a call, and
# properties of the trace.
OLDEST, NEWEST = 1, 6
NAMED_ENUMS, THREADS, PROPERTIES = 3, 4, 6

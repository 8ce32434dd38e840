"""Patterns of names in scenes, and what they allow in words."""

from __future__ import annotations

PRINTABLE = r"^[^\x00-\x1f\x7f]*$"
"""Pattern of names: no control characters, which would break the tables and plots that names stand in."""
BODY_NAME = r"^[^\x00-\x1f\x7f*]*$"
"""Pattern of names of bodies, and of what their names begin with: no star either, which stands for all numbers where
laws name bodies."""
FILE_NAME = r"^[\w.-]*\w$"
"""Pattern of names after which files are named."""
LETTERS = "^[A-Za-zµμ]+$"
"""Pattern of names of units."""
IN_WORDS = {
    PRINTABLE: "a text with no control characters",
    BODY_NAME: "a text with no control characters, and no `*`, which stands for all numbers in the names of laws",
    FILE_NAME: "letters, digits, `_`, `-` and `.` without spaces, and not `-` or `.` at the end",
    LETTERS: "letters alone",
}
"""Each pattern in words."""

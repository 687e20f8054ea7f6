# SPDX-License-Identifier: MIT
"""What the benchmarks written in Python share: ending with a message, tables, sections of docs/."""
import os
import sys


def fail(text, status=2):
    """Ends the program with a message; 2: wrong usage, or something is not there."""
    print(f"{os.path.basename(sys.argv[0])}:", text, file=sys.stderr)
    sys.exit(status)


def table(head, rows):
    """A table in Markdown."""
    return "\n".join(["| " + " | ".join(head) + " |", "|" + " --- |" * len(head)] +
                     ["| " + " | ".join(row) + " |" for row in rows])


def write_section(page, name, text):
    """Puts the text between the markers of that name in the page."""
    with open(page) as file:
        old = file.read()
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    if begin not in old or end not in old:
        fail(f"no markers of {name} in {page}")
    with open(page, "w") as file:
        file.write(old[:old.index(begin) + len(begin)] + text + "\n" + old[old.index(end):])

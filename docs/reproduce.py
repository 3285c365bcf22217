"""The papers' figures, tables and numbers, made again on our own characters and generated data.

    python docs/reproduce.py              all three pages, from nothing, in some minutes
    python docs/reproduce.py tracking     one of them

Fills the gaps of docs/reproduction/NAME.md into docs/papers/NAME.md, with its pictures beside it.
"""

import sys

from reproduction import genetic_blending, online_mapping, sheet, tracking

PAGES = {
    "online_mapping": online_mapping.results,
    "genetic_blending": genetic_blending.results,
    "tracking": tracking.results,
}


def main(*names: str) -> None:
    """Make the pages called ``names``, or all."""
    for name in names or PAGES:
        sheet.write(name, PAGES[name]())


if __name__ == "__main__":
    main(*sys.argv[1:])

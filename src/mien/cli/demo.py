"""Try it: the sample performance that comes with mien drives all four characters."""

from __future__ import annotations

import argparse
from importlib import resources

from mien.cli import animate
from mien.cli.capture import CUT_OPTIONS
from mien.errors import InputError


def configure(parser: argparse.ArgumentParser) -> None:
    animate.add_acting_options(parser, "out/demo")
    parser.set_defaults(capture="landmarks", **dict.fromkeys(CUT_OPTIONS))


def run(options: argparse.Namespace) -> None:
    with resources.as_file(resources.files("mien").joinpath("data", "sample.mp4")) as sample:
        if not sample.is_file():
            raise InputError(f"{sample}: the sample performance is missing; install mien again")
        options.take = str(sample)
        animate.run(options)

"""Every error a user can meet.

    MienError               one line: which file or option, what is wrong, what would mend it
      InputError            something the user named cannot be used
        FormatError         ... because a file's content is not what it should be
        NoFaceError         ... because nobody's face is in it
      OutputError           a result could not be written
      MissingExtraError     an optional dependency is not installed

The command line prints the message and exits 1; nothing else is caught there.
"""


class MienError(Exception):
    """Base of all errors that are meant to be read by a user."""


class InputError(MienError):
    """A file, a name or an option the user gave cannot be used."""


class FormatError(InputError):
    """A file was found but its content is broken, foreign or dangerous."""


class NoFaceError(InputError):
    """A recording was read but no face was found in it."""


class OutputError(MienError):
    """A result could not be written."""


class MissingExtraError(MienError):
    """Something needs an optional dependency that is not installed."""

    def __init__(self, what: str, extra: str) -> None:
        super().__init__(f"{what} needs the extra '{extra}': pip install 'mien[{extra}]'")

"""What can go wrong. Every exception of this package is an :class:`IsolaError`."""

from pathlib import Path


class IsolaError(Exception):
    """Base of all of them."""


class Unreachable(IsolaError):
    """Nobody listens at the address."""


class NoSuchRun(IsolaError):
    """There is no such run, or none, or more than one to choose from."""


class OtherVersion(IsolaError):
    """The other side speaks another version of the messages."""


class NoAnswer(IsolaError):
    """The coordinator did not answer in time: it is gone, frozen or cut off."""


class Refused(IsolaError):
    """The coordinator answered that it cannot give what was asked for (not computed yet, say)."""


class Corrupt(IsolaError):
    """Bytes that are not what was announced, or not a message."""


class Damaged(Corrupt):
    """Something in the store of a run cannot be read, or is not what was stored."""

    def __init__(self, file: Path, detail: object) -> None:
        super().__init__(f"{file}: the file is damaged ({detail}); restore a copy")
        #: What is wrong, without file and remedy.
        self.detail = str(detail)


class NoSuchBranch(IsolaError, KeyError):
    """The run has no branch of this name (yet)."""

    __str__ = Exception.__str__


class NoProgram(IsolaError):
    """The program `isola` is not there, or cannot be started."""


class ProgramFailed(IsolaError):
    """The program ended with an error: the message is its own, in which options are called what they are in Python."""

    def __init__(self, message: str, code: int) -> None:
        super().__init__(message)
        #: Exit code: 1 error, 2 wrong usage.
        self.code = code


class FolderInUse(IsolaError, FileExistsError):
    """There is a run, or a model, in a folder that is to be written."""


class BadModel(IsolaError, ValueError):
    """A model that makes no sense: which entry, and what would be right."""


class BadStudy(IsolaError, ValueError):
    """Amplitudes or settings of a sweep that make no sense: which one, and what would be right."""


class StudyRefused(ProgramFailed, BadStudy):
    """The program refuses amplitudes or settings, before any response is computed: with its own message."""


class ModelRefused(ProgramFailed, BadModel):
    """The program refuses a model, before anything is computed: with its own message."""


class Incomplete(UserWarning):
    """A sweep has ended, but tasks were given up, or what lies beyond what it found is not known: the program says which."""


class Doubtful(UserWarning):
    """The program doubts that something of a study is meant, and says what and why; or takes for given what nobody gave."""


class LeftOut(UserWarning):
    """Part of what was asked for is damaged or missing: the message says which, the rest is there."""

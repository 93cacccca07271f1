"""What can go wrong. Every exception of this package is an :class:`IsolaError`."""


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

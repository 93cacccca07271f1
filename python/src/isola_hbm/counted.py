"""Numbers of things in words."""


def count(number: int, thing: str, plural: str | None = None) -> str:
    """A number of things: ``1 branch``, ``2 branches``."""
    return f"{number} {thing if number == 1 else plural or thing + 's'}"

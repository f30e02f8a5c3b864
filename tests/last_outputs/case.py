"""A case: commands of the program, one after the other, and the files that they find."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Case:
    title: str
    commands: list[list[str]]
    files: dict[str, str] = field(default_factory=dict)
    together: bool = False  # one digest for everything that is printed and written
    must_succeed: bool = False  # there are no digests of commands that fail

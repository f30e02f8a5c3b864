#!/usr/bin/env python3
"""Runs what README.md and the pages of docs/ show: a document's scenes and commands must give what it prints. (examples/check.py does so for the examples.)

    docs/check_examples.py OPENCLOSE [FILE.md ...]

In a document, a block that begins with ```toml NAME is written to the file NAME (```toml NAME + adds to it), and in a block that begins with ```console every
line after "$ " is run. Lines below a command are lines of its output, in their order; the numbers in them may differ by NUMBERS_DIFFER, and ... stands for a
word that is rounding or time.
A command that ends with "; echo $?" may fail: its exit status is its last line. Commands find the other files of the document's folder beside them.
Exit status: 0 if every command succeeds and prints these lines, else 1.
"""

import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Relative: what another compiler's rounding may change in a printed number of six digits.
NUMBERS_DIFFER = 1e-3
LIMIT_S = 120
SHOWS_STATUS = "; echo $?"
ANYTHING = "..."
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")


def blocks(text: str) -> list[tuple[str, list[str]]]:
    """The fenced blocks: what stands behind the fence, and the lines."""
    found = re.findall(r"^```(\S[^\n]*)\n(.*?)^```$", text, re.M | re.S)
    return [(head.strip(), body.splitlines()) for head, body in found]


def same_line(expected: str, line: str) -> bool:
    """The same words, and numbers that are nearly the same."""
    pairs = list(zip(expected.split(), line.split()))
    return len(expected.split()) == len(line.split()) and all(want == ANYTHING or same_word(want, word) for want, word in pairs)


def same_word(expected: str, word: str) -> bool:
    if NUMBER.sub("#", expected) != NUMBER.sub("#", word):
        return False
    pairs = zip(map(float, NUMBER.findall(expected)), map(float, NUMBER.findall(word)))
    return all(abs(a - b) <= NUMBERS_DIFFER * abs(a) for a, b in pairs)


def missing_line(expected: list[str], output: list[str]) -> str | None:
    """The first expected line that does not follow the ones before it."""
    lines = iter(output)
    return next((want for want in expected if not any(same_line(want, line) for line in lines)), None)


def commands(lines: list[str]) -> list[tuple[str, list[str]]]:
    found: list[tuple[str, list[str]]] = []
    for line in lines:
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif line.strip():
            found[-1][1].append(line)
    return found


def failure(command: str, expected: list[str], openclose: Path, folder: Path) -> str | None:
    words = shlex.split(command.removesuffix(SHOWS_STATUS))
    programs = {"openclose": openclose, "openclose-reference": openclose.parent / "analytical" / "openclose-reference"}
    if words[0] not in programs:
        return f"only {' and '.join(programs)} can be run"
    result = subprocess.run([str(programs[words[0]]), *words[1:]], cwd=folder, capture_output=True, text=True, timeout=LIMIT_S)
    output = result.stdout + result.stderr
    if command.endswith(SHOWS_STATUS):
        output += f"\n{result.returncode}"
    elif result.returncode != 0:
        return f"exit status {result.returncode}: {output.strip()}"
    missing = missing_line(expected, output.splitlines())
    return None if missing is None else f"does not print: {missing}\nbut: {output.strip()}"


def check(document: Path, openclose: Path, folder: Path) -> tuple[int, list[str]]:
    """Runs a document in an empty folder. Number of commands, and what is wrong with them."""
    count, wrong = 0, []
    for path in (ROOT / "examples", ROOT / "paper", ROOT / "verification", *document.parent.glob("*.toml"), *document.parent.glob("*.csv")):
        (folder / path.name).symlink_to(path)
    for head, lines in blocks(document.read_text()):
        words = head.split()
        if words[0] == "toml" and len(words) > 1:
            with open(folder / words[1], "a" if words[2:] == ["+"] else "w") as stream:
                stream.write("\n".join(lines) + "\n")
        if words[0] == "console":
            for command, expected in commands(lines):
                count += 1
                problem = failure(command, expected, openclose, folder)
                if problem:
                    wrong.append(f"{document.relative_to(ROOT)}: $ {command}\n{problem}")
    return count, wrong


def check_alone(document: Path, openclose: Path) -> tuple[int, list[str]]:
    with tempfile.TemporaryDirectory() as name:
        return check(document, openclose, Path(name))


def main() -> int:
    openclose = Path(sys.argv[1]).resolve()
    documents = [Path(name) for name in sys.argv[2:]] or [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    counts, problems = zip(*(check_alone(document.resolve(), openclose) for document in documents))
    for problem in sum(problems, []):
        print(problem)
    print(f"{sum(counts)} commands of {len(documents)} documents, {len(sum(problems, []))} wrong")
    return 1 if any(problems) or not sum(counts) else 0


if __name__ == "__main__":
    sys.exit(main())

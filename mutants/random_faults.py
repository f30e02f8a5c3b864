"""Faults of one token at places drawn by a seed, to measure what the checks see: nobody has chosen them, so nobody has chosen the easy ones.

A place is anything in src/ that one of RULES fits, outside comments, texts, preprocessor lines and static assertions. All places are as likely as each other.
"""

import random
import re
from pathlib import Path

# What is looked for (group 1 is the token that is replaced), what stands there instead, and what that is called. Spaces around operators, as the
# project writes them, tell them from templates, references and pointers.
RULES = [
    (r" (<=) ", "<", "comparison"), (r" (>=) ", ">", "comparison"), (r" (<) ", "<=", "comparison"), (r" (>) ", ">=", "comparison"),
    (r" (==) ", "!=", "comparison"), (r" (!=) ", "==", "comparison"),
    (r"[\w)\]] (\+) [\w(]", "-", "operator"), (r"[\w)\]] (-) [\w(]", "+", "operator"),
    (r"[\w)\]] (\*) [\w(]", "/", "operator"), (r"[\w)\]] (/) [\w(]", "*", "operator"),
    (r" (\+=) ", "-=", "operator"), (r" (-=) ", "+=", "operator"),
    (r" (&&) [\w(!]", "||", "logic"), (r" (\|\|) ", "&&", "logic"), (r"[(\s](!)[\w(]", "", "logic"),
    (r"\b(true)\b", "false", "logic"), (r"\b(false)\b", "true", "logic"),
    (r"(?:[=(,?:]|return) (-)[\w(]", "", "sign"), (r"\((-)[\w(]", "", "sign"),
    (r"std::(max)\(", "min", "function"), (r"std::(min)\(", "max", "function"),
    (r"\bstd::(sin)\(", "cos", "function"), (r"\bstd::(cos)\(", "sin", "function"), (r"\bstd::(abs)\(", "cbrt", "function"),
    (r"\.(x)\(\)", "y", "index"), (r"\.(y)\(\)", "x", "index"), (r"\[(0)\]", "1", "index"), (r"\[(1)\]", "0", "index"),
    (r"[^\w.](0\.5)\b", "1.0", "constant"), (r"[^\w.](1\.0)\b", "0.5", "constant"), (r"[^\w.](2\.0)\b", "1.0", "constant"),
    (r"[=<>+\-] (1)\b(?!\.)", "2", "constant"), (r"[=<>+\-] (0)\b(?!\.)", "1", "constant"), (r"[^\w.](0\.0)\b", "1.0", "constant"),
    (r"\w\(((\w+), (\w+))\)", r"\3, \2", "swapped arguments"),
]
PREFIX = "random-"


def blanked(text):
    """The source with everything that is no code replaced by spaces, so that places keep their numbers."""
    def spaces(match):
        return re.sub(r"[^\n]", " ", match.group())
    outside = r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\])\'|^[ \t]*#[^\n]*|static_assert\s*\(.*?;'
    return re.sub(outside, spaces, text, flags=re.S | re.M)


def places(root):
    """All faults of one token, in a fixed order, without their ids."""
    for path in sorted((root / "src").glob("*/*")):
        if path.suffix not in (".h", ".cpp"):
            continue
        text = path.read_text()
        code = blanked(text)
        for pattern, replacement, kind in RULES:
            for match in re.finditer(pattern, code):
                token = text[match.start(1):match.end(1)]
                instead = match.expand(replacement)
                if token != instead:
                    yield {"file": str(path.relative_to(root)), "at": match.start(1), "original": token, "replacement": instead, "kind": kind}


def line_of(text, at):
    begin = text.rfind("\n", 0, at) + 1
    end = text.find("\n", at)
    return text.count("\n", 0, at) + 1, text[begin:end if end >= 0 else len(text)].strip()


def draw(root: Path, seed: int, count: int):
    everything = list(places(root))
    drawn = random.Random(seed).sample(everything, min(count, len(everything)))
    for number, fault in enumerate(drawn, 1):
        line, code = line_of((root / fault["file"]).read_text(), fault["at"])
        fault["id"] = f"{PREFIX}{seed}-{number}"
        fault["description"] = f"{fault.pop('kind')}, line {line}: {fault['original']} -> {fault['replacement'] or 'nothing'} in: {code}"
    return drawn

"""What the numbers were taken on: results/bench_machine.json."""

import json
import os
import platform
import re
from pathlib import Path

from openclose_scripts.processes import run_process


def _processor() -> str:
    try:
        found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    except OSError:
        found = None
    return found.group(1) if found else platform.processor()


def _memory() -> int | None:
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (ValueError, OSError):
        return None


def _cached(build: Path, key: str) -> str:
    """A value of the build's CMakeCache.txt."""
    try:
        found = re.search(rf"^{key}:\w+=(.*)$", (build / "CMakeCache.txt").read_text(encoding="utf-8"), re.MULTILINE)
    except OSError:
        found = None
    return found.group(1) if found else ""


def _compiler(build: Path) -> str:
    for file in sorted(build.glob("CMakeFiles/*/CMakeCXXCompiler.cmake")):
        text = file.read_text(encoding="utf-8")
        name, version = (re.search(rf'set\(CMAKE_CXX_COMPILER_{key} "([^"]*)"\)', text) for key in ("ID", "VERSION"))
        if name and version:
            return f"{name.group(1)} {version.group(1)}"
    return _cached(build, "CMAKE_CXX_COMPILER")


def describe(executable: Path, commit: str, mode: str) -> dict:
    build = executable.parent
    return {
        "version": run_process([str(executable), "--version"]).stdout.strip(),
        "commit": commit,
        "mode": mode,
        "processor": _processor(),
        "processors": os.cpu_count(),
        "load_average_at_start": os.getloadavg()[0],
        "memory_bytes": _memory(),
        "system": platform.platform(),
        "compiler": _compiler(build),
        "build_type": _cached(build, "CMAKE_BUILD_TYPE"),
        "tuned": _cached(build, "OPENCLOSE_TUNE") == "ON",
        "threads": 1,
    }


def write(description: dict, file: Path) -> None:
    file.write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")

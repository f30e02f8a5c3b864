"""Installs the program into a folder of its own and uses it: the command, manual pages, completions of three shells, the CMake package; then removes it.

    python3 tests/install/try_installation.py ROOT        (needs man-db, zsh and fish; make verify-install installs them)
"""

import os
import pty
import select
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# A program of somebody else that settles a block and reads a key of the version.
CONSUMER = {
    "CMakeLists.txt": """
cmake_minimum_required(VERSION 3.22)
project(consumer LANGUAGES CXX)
set(CMAKE_CXX_STANDARD 20)
find_package(openclose 0.1 REQUIRED)
add_executable(consumer consumer.cpp)
target_link_libraries(consumer PRIVATE openclose::analysis openclose::report openclose::study)
""",
    "consumer.cpp": """
#include <openclose/analysis/strength_reduction.h>
#include <openclose/report/report.h>
#include <openclose/scene/reader.h>
#include <openclose/study/convergence.h>
#include <openclose/version.h>

#include <cstdio>

int main(int, char** argv) {
  openclose::Scene scene = openclose::read_scene(argv[1]);
  scene.step.dt = scene.settle.first_dt;
  openclose::Simulation simulation(scene);
  std::printf("%s %.4f\\n", openclose::version, openclose::factor_of_safety(simulation).stable());
}
""",
}

# tan(35 deg) / tan(20 deg): a block on a slope.
SCENE = """
[[material]]
name = "rock"
density_kg_per_m3 = 2500
[[joint]]
materials = ["rock", "rock"]
normal_stiffness_pa_per_m = 1e9
shear_stiffness_pa_per_m = 4e8
friction_angle_deg = 35
[[block]]
name = "base"
material = "rock"
fixed = true
vertices_m = [[0, -1], [20, -1], [20, 0], [0, 7.279404685324046]]
[[block]]
name = "block"
material = "rock"
vertices_m = [[8, 4.367642811194427], [10, 3.6397023426620234], [10, 4.6397023426620234], [8, 5.367642811194427]]
"""
FACTOR = 1.9238


def require(holds: bool, what: str) -> None:
    if not holds:
        sys.exit(f"try_installation: {what}")


def output_of(*command: object, **options: object) -> str:
    result = subprocess.run([str(word) for word in command], capture_output=True, text=True, **options)
    require(result.returncode == 0, f"{' '.join(map(str, command))[:200]}: exit status {result.returncode}: {result.stdout}{result.stderr}")
    return result.stdout


def check_command(prefix: Path, folder: Path) -> None:
    openclose = prefix / "bin" / "openclose"
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    said = output_of(openclose, "fos", "scene.toml", "-o", "out", cwd=folder)
    require(f"factor of safety {FACTOR:.3f}"[:-1] in said, f"fos says {said}")
    output_of(openclose, "report", "out", cwd=folder)
    swept = output_of(openclose, "sweep", "scene.toml", "--vary", "joint[0].friction_angle_deg=30:35:5", "-o", "sweep", cwd=folder)
    require("2 of 2 cases" in swept, f"sweep says {swept}")


def check_manual(prefix: Path) -> int:
    openclose = prefix / "bin" / "openclose"
    commands = [line.split()[0] for line in output_of(openclose, "--help").split("Subcommands:")[1].splitlines() if line.startswith("  ") and line[2] != " "]
    require(len(commands) >= 9, f"commands: {commands}")
    pages = {path.name for path in (prefix / "share/man/man1").iterdir()}
    require(pages == {"openclose.1"} | {f"openclose-{command}.1" for command in commands}, f"manual pages: {sorted(pages)}")
    for page in sorted(pages):
        result = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(prefix / "share/man/man1" / page)], capture_output=True, text=True)
        require(result.returncode == 0 and not result.stderr, f"man says of {page}: {result.stderr}")
    text = output_of("man", "-M", prefix / "share/man", "openclose-run", env={**os.environ, "MANPAGER": "cat", "COLUMNS": "100"})
    require("--restart" in text and "checkpoint" in text, "the page of run has no --restart")
    return len(pages)


def bash_choices(prefix: Path, *words: str) -> list[str]:
    script = prefix / "share/bash-completion/completions/openclose"
    quoted = " ".join(f"'{word}'" for word in words)
    # Outside of a completion bash has no compopt that works.
    return output_of("bash", "-c", f"compopt() {{ :; }}; source '{script}'; COMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _openclose; printf '%s\\n' \"${{COMPREPLY[@]}}\"").split()


def fish_choices(prefix: Path, line: str) -> list[str]:
    script = prefix / "share/fish/vendor_completions.d/openclose.fish"
    return [row.split("\t")[0] for row in output_of("fish", "--no-config", "-c", f"source '{script}'; complete -C '{line}'").splitlines()]


def zsh_choices(prefix: Path, line: str) -> str:
    """What an interactive zsh shows after two tabs."""
    folder = prefix / "share/zsh/site-functions"
    process, terminal = pty.fork()
    if process == 0:
        os.environ.update(TERM="dumb", PS1="> ", COLUMNS="400", LINES="300")
        os.execvp("zsh", ["zsh", "-f", "-i"])

    def read(seconds: float) -> str:
        text, end = "", time.monotonic() + seconds
        while time.monotonic() < end:
            if not select.select([terminal], [], [], 0.1)[0]:
                continue
            try:
                text += os.read(terminal, 65536).decode(errors="replace")
            except OSError:  # the shell has gone
                break
        return text

    os.write(terminal, f"fpath=('{folder}' $fpath); LISTMAX=1000; autoload -Uz compinit; compinit -u -D; unsetopt list_ambiguous; stty columns 400 rows 300\n".encode())
    read(2.0)
    os.write(terminal, (line + "\t\t").encode())
    shown = read(2.0)
    os.write(terminal, b"\x15exit\n")
    read(0.3)
    os.close(terminal)
    os.waitpid(process, 0)
    return shown


def check_completions(prefix: Path) -> None:
    for name, words, expected in (("commands", ("openclose", "r"), ["run", "report"]), ("options", ("openclose", "fos", "--cont"), ["--contact"]),
                                  ("words", ("openclose", "run", "--contact", "s"), ["soft", "shi"]), ("keys", ("openclose", "run", "--set", "step.d"), ["step.dt_s="]),
                                  ("keys of explain", ("openclose", "explain", "settle.first"), ["settle.first_dt_s"]),
                                  ("shells", ("openclose", "completion", ""), ["bash", "zsh", "fish"])):
        found = bash_choices(prefix, *words)
        require(sorted(found) == sorted(expected), f"bash completes {name} to {found}, not {expected}")
        found = fish_choices(prefix, " ".join(words))
        require(sorted(found) == sorted(expected), f"fish completes {name} to {found}, not {expected}")
    for line, expected in (("openclose re", "port"), ("openclose run --contact ", "hard"), ("openclose run --set step.dt", "_s="), ("openclose explain settle.first_", "dt_s")):
        shown = zsh_choices(prefix, line)
        require(expected in shown, f"zsh completes '{line}' to {shown!r}")


def check_package(prefix: Path, folder: Path) -> None:
    source = folder / "consumer"
    source.mkdir()
    for name, text in CONSUMER.items():
        (source / name).write_text(text, encoding="utf-8")
    output_of("cmake", "-S", source, "-B", source / "build", f"-DCMAKE_PREFIX_PATH={prefix}", "-DCMAKE_BUILD_TYPE=Release")
    output_of("cmake", "--build", source / "build")
    said = output_of(source / "build" / "consumer", folder / "scene.toml").split()
    require(said[0] in output_of(prefix / "bin" / "openclose", "--version"), f"versions differ: {said[0]}")
    require(abs(float(said[1]) - FACTOR) < 1e-3, f"the program of somebody else finds {said[1]}, not {FACTOR}")


def main() -> None:
    root = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        # As a packager does, and with a name that holds a space.
        prefix = folder / "a prefix" / "openclose"
        manifest = root / "build/release/install_manifest.txt"
        kept = manifest.read_bytes() if manifest.exists() else None
        make = ["make", "-s", "--no-print-directory", "-C", root]
        try:
            output_of(*make, "install", f"PREFIX={prefix}")
            (prefix / "own.txt").write_text("mine")
            check_command(prefix, folder)
            pages = check_manual(prefix)
            check_completions(prefix)
            check_package(prefix, folder)
            output_of(*make, "uninstall")
            left = [str(path.relative_to(prefix)) for path in prefix.rglob("*") if not path.is_dir()]
            require(left == ["own.txt"], f"make uninstall leaves {left}")
        finally:
            if kept is None:
                manifest.unlink(missing_ok=True)
            else:
                manifest.write_bytes(kept)
    print(f"installed, used and removed: the command, {pages} manual pages, completions of bash, zsh and fish, libraries with their CMake package")


if __name__ == "__main__":
    main()

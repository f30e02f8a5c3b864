"""Runs commands, if asked for with a limit of CPU time."""

import resource
import signal
import subprocess
from pathlib import Path

DONE, NOT_CONVERGED, BAD_INPUT = 0, 1, 2  # exit statuses of openclose


class RunFailed(Exception):
    """A command did not end well; the message holds the command line and what it said."""


def run_process(arguments: list[str], cpu_limit_s: int | None = None, folder: Path | None = None) -> subprocess.CompletedProcess:
    """Runs it in `folder`, by default the present one, and keeps what it prints."""

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_CPU, (cpu_limit_s, cpu_limit_s + 1))

    try:
        return subprocess.run(arguments, capture_output=True, text=True, check=False, cwd=folder, preexec_fn=limit if cpu_limit_s else None)
    except OSError as error:
        raise RunFailed(f"cannot run {arguments[0]}: {error.strerror}") from error


def was_stopped(done: subprocess.CompletedProcess) -> bool:
    """Whether the limit of CPU time has ended it."""
    return done.returncode in (-signal.SIGXCPU, -signal.SIGKILL)


def call(arguments: list[str]) -> str:
    done = run_process(arguments)
    if done.returncode != DONE:
        raise RunFailed(f"exit status {done.returncode} from: {' '.join(arguments)}\n{done.stderr.strip()}")
    return done.stdout

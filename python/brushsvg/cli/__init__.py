"""Run the typed command and turn its result into lines on stderr and an exit status.

Nothing is imported before main runs, so that from its first moment on Ctrl-C leaves no traceback.
"""

from __future__ import annotations

import sys


def main(argv: list[str] | None = None) -> int:
    """Run one command; the exit status: 0 done, 1 refused, 2 wrong usage, 130 interrupted."""
    interrupts = _Interrupts()
    try:
        interrupts.count()
        return _run_with_streams(argv, interrupts)
    except KeyboardInterrupt:
        pass
    except Exception:
        if not interrupts.seen:
            raise
    finally:
        interrupts.count_no_more()
    from .console import say

    say("interrupted")
    return 130


class _Interrupts:
    """Ctrl-C while a module is being imported can come out as another error: seen says that there was one."""

    seen = 0
    before = None

    def count(self) -> None:
        import signal
        from contextlib import suppress

        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            with suppress(ValueError):  # only the main thread may, and only it is interrupted
                self.before = signal.signal(signal.SIGINT, self._raise)

    def count_no_more(self) -> None:
        if self.before is not None:
            import signal

            signal.signal(signal.SIGINT, self.before)

    def _raise(self, *_) -> None:
        self.seen += 1
        raise KeyboardInterrupt


def _run_with_streams(argv: list[str] | None, interrupts: _Interrupts) -> int:
    """Run the command with any terminal encoding, and with a reader that may stop reading."""
    from ..errors import Notice
    from .console import discard_output, say_notice

    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    try:
        status = _run_command(argv, interrupts)
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except OSError as problem:
        if sys.stdout is not None:
            discard_output(sys.stdout)
        if isinstance(problem, BrokenPipeError):
            return 0  # the reader closed the pipe
        reason = (problem.strerror or str(problem)).lower()
        say_notice(problem.filename or "standard output", Notice("", reason, code="file-unwritable"))
        return 1


def _run_command(argv: list[str] | None, interrupts: _Interrupts) -> int:
    from dataclasses import replace

    from ..errors import unexpected
    from .arguments.parser import parse
    from .console import RefusedError, say_notice, use_json_messages

    file = ""
    try:
        use_json_messages(False)
        args = parse(argv)
        use_json_messages(args.messages == "json")
        file = getattr(args, "input", "")
        from . import commands
        from .steps.project_settings import use_project

        run = getattr(commands, args.run)
        use_project(args, argv)
        run(args)
    except SystemExit as leaving:
        return leaving.code
    except RefusedError as refused:
        for notice in refused.why:
            say_notice(refused.file, replace(notice, refused=True))
        return 1
    except OSError:
        raise
    except Exception as mistake:
        if interrupts.seen:
            raise
        say_notice(file, replace(unexpected(mistake).notice(), refused=True))
        return 1
    return 0

"""Run the typed command, print its messages on stderr, and return its status.

Nothing is imported before main runs, so that Ctrl-C never leaves a traceback.
"""

from __future__ import annotations

import sys


def main(argv: list[str] | None = None) -> int:
    """Run one command and return its exit status.

    The status is 0 if the command is done, 1 if it is refused, 2 for wrong usage, and 130 if it is interrupted.
    """
    interrupts = _Interrupts()
    try:
        interrupts.start()
        return _run_with_streams(argv, interrupts)
    except KeyboardInterrupt:
        pass
    except Exception:
        if not interrupts.seen:
            raise
    finally:
        interrupts.stop()
    from .console import say

    say("interrupted")
    return 130


class _Interrupts:
    """Counts interrupts by Ctrl-C.

    Ctrl-C during the import of a module can appear as another error, so `seen` records that there was an interrupt.
    """

    seen = 0
    previous_handler = None

    def start(self) -> None:
        import signal
        from contextlib import suppress

        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            # Only the main thread may set a handler, and only the main thread is interrupted.
            with suppress(ValueError):
                self.previous_handler = signal.signal(signal.SIGINT, self._raise)

    def stop(self) -> None:
        if self.previous_handler is not None:
            import signal

            signal.signal(signal.SIGINT, self.previous_handler)

    def _raise(self, *_) -> None:
        self.seen += 1
        raise KeyboardInterrupt


def _run_with_streams(argv: list[str] | None, interrupts: _Interrupts) -> int:
    """Run the command with any terminal encoding. The reader of the output may stop reading at any time."""
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

    from ..errors import describe_unexpected
    from .arguments.parser import parse
    from .console import RefusedError, say_notice, set_output

    file = ""
    try:
        set_output(json_messages=False, quiet=False)
        args = parse(argv)
        set_output(args.messages == "json", getattr(args, "quiet", False) and not getattr(args, "json", False))
        file = getattr(args, "input", "")
        from . import commands
        from .steps.project_settings import use_project

        run = getattr(commands, args.run)
        use_project(args, argv)
        run(args)
    except SystemExit as exit_request:
        return exit_request.code
    except RefusedError as refused:
        for notice in refused.why:
            say_notice(refused.file, replace(notice, refused=True))
        return 1
    except OSError:
        raise
    except Exception as bug:
        if interrupts.seen:
            raise
        say_notice(file, replace(describe_unexpected(bug).notice(), refused=True))
        return 1
    return 0

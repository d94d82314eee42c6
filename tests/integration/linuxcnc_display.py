#!/usr/bin/python3
"""Replace LinuxCNC's screen: run a program once and record the commanded places.

The program is next to the .ini. The record has a row for each millisecond. LinuxCNC starts this script, see
controller.py.
"""

import subprocess
import time
from pathlib import Path

import linuxcnc

MOST_S = 60


def run(program, samples):
    command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()

    def send(*words):
        getattr(command, words[0])(*words[1:])
        command.wait_complete()

    with samples.open("w") as out, subprocess.Popen(["halsampler", "-t"], stdout=out) as sampler:
        send("state", linuxcnc.STATE_ESTOP_RESET)
        send("state", linuxcnc.STATE_ON)
        send("home", -1)
        send("mode", linuxcnc.MODE_AUTO)
        send("program_open", str(program))
        command.auto(linuxcnc.AUTO_RUN, 0)
        end, began = time.monotonic() + MOST_S, False
        while time.monotonic() < end:
            status.poll()
            began = began or status.interp_state != linuxcnc.INTERP_IDLE
            if began and status.interp_state == linuxcnc.INTERP_IDLE:
                break
            time.sleep(0.02)
        time.sleep(0.2)
        sampler.terminate()
    return [error[1] for error in iter(errors.poll, None)]


if __name__ == "__main__":
    folder = Path.cwd()
    (folder / "errors.txt").write_text("\n".join(run(folder / "program.ngc", folder / "samples.txt")))

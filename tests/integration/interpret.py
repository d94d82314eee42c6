"""Interpret a program with LinuxCNC and print the machine's actions as JSON.

Run with the system's Python, which has LinuxCNC's module gcode: python3 interpret.py PROGRAM PARAMETERS
Events: ["comment", text], ["rapid", x, y, z], ["feed", x, y, z, mm/min], ["arc", x, y, z, mm/min, centre x,
centre y, turns] (turns > 0 counter-clockwise), ["other", name] for calls that are neither geometry nor
harmless. Lengths in mm. If LinuxCNC refuses the program, the exit status is 1 and its message is on stderr.
"""

import json
import sys

import gcode

MM = 25.4  # the module always uses inches
HARMLESS = {"next_line", "set_plane", "set_xy_rotation", "set_g5x_offset", "set_g92_offset"}


class Canon:
    def __init__(self, parameter_file):
        self.parameter_file = parameter_file
        self.events = []
        self.feed_mm_min = 0.0

    def set_feed_rate(self, rate):
        self.feed_mm_min = rate * MM

    def comment(self, text):
        self.events.append(["comment", text])

    def straight_traverse(self, x, y, z, *turned):
        self.events.append(["rapid", x * MM, y * MM, z * MM])
        self._no_other_axes(turned)

    def straight_feed(self, x, y, z, *turned):
        self.events.append(["feed", x * MM, y * MM, z * MM, self.feed_mm_min])
        self._no_other_axes(turned)

    def arc_feed(self, x, y, centre_x, centre_y, turns, z, *turned):
        centre = [centre_x * MM, centre_y * MM, turns]
        self.events.append(["arc", x * MM, y * MM, z * MM, self.feed_mm_min, *centre])
        self._no_other_axes(turned)

    def _no_other_axes(self, turned):
        if any(turned):
            self.events.append(["other", "a move of another axis"])

    def check_abort(self):
        return False

    def get_tool(self, _):
        return (-1, *[0.0] * 12, 0)

    def get_external_angular_units(self):
        return 1.0

    def get_external_length_units(self):
        return 1.0

    def get_axis_mask(self):
        return 7

    def get_block_delete(self):
        return False

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)

        def call(*values):
            if name in ("set_xy_rotation", "set_g5x_offset", "set_g92_offset"):
                # One of these calls begins with the number of the coordinate system.
                harmless = not any(values[1:] if name == "set_g5x_offset" else values)
            else:
                harmless = name in HARMLESS
            if not harmless:
                self.events.append(["other", name])

        return call


def main():
    canon = Canon(sys.argv[2])
    result, line = gcode.parse(sys.argv[1], canon, "", "")
    if result > gcode.MIN_ERROR:
        sys.exit(f"line {line}: {gcode.strerror(result)}")
    json.dump(canon.events, sys.stdout)


main()

"""What the robot languages and their controllers require, limit and round."""

from __future__ import annotations

REQUIRED_TABLES = {
    "grbl-servo": ("servo",),
    "ebb": ("servo", "motors"),
    "hpgl": ("pen",),
    "marlin-servo": ("pen",),
    "robodk": ("tool", "robodk"),
} | dict.fromkeys(("urscript", "jaka", "rapid", "xarm", "krl", "dobot", "fanuc", "doosan", "ros2"), ("tool",))
CONTACT_KEYS = {"urscript": "force_n", "xarm": "sensitivity"}  # the key that sets when contact ends a program
JOINT_PLAY_REASON = "joints of an arm have play of their own"
NO_BACKLASH_REASONS = dict.fromkeys(  # languages for which backlash is not compensated, with the reason
    ("urscript", "jaka", "rapid", "xarm", "krl", "dobot", "fanuc", "doosan", "ros2", "robodk"),
    JOINT_PLAY_REASON,
) | {"ebb": "its motors share x and y, and have play of their own"}
LEAST_ACCELERATION_MM_S2 = {"rapid": 100.0}  # the smallest value that PathAccLim accepts
# Lowest speed of a line. All speeds of a program are whole multiples of it.
LEAST_SPEED_MM_S = {"dobot": 1.0, "fanuc": 1.0, "hpgl": 10.0, "ebb": 0.1}
MIN_SERVO_SPEED_MM_S = 1 / 60  # grbl replaces a lower feed by this one
UNITS_MM = {"hpgl": 0.025}  # size of a whole unit in languages without fractions
# Firmware that divides circles into lines, if it supports circles at all.
ARCS_IN_SEGMENTS = ("marlin", "klipper")
# Largest difference of the distances from a circle's centre to the two ends of the circle.
MAX_RADIUS_DIFFERENCE_MM = {"fluidnc": 0.005}
MAX_PROGRAM_POINTS = {"fanuc": 1000}  # longer jobs are split into several programs between strokes
# Longer jobs are split into several programs. A stroke with more lines becomes a program by itself.
MAX_PROGRAM_LINES = {"urscript": 1000, "krl": 2500}

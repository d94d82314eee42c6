"""A small RoboDK-style post for tests; it writes one line for each call."""


class RobotPost:
    PROG_EXT = "txt"
    LOG = ""

    def __init__(self, robotpost, robotname, robot_axes, **kwargs):
        assert robot_axes == 6, robot_axes
        self.lines = []

    def ProgStart(self, progname):  # noqa: N802 as RoboDK calls them, and those below
        self.lines.append(f"start {progname}")

    def ProgFinish(self, progname):  # noqa: N802
        self.lines.append("finish")

    def ProgSave(self, folder, progname, ask_user=False, show_result=False):  # noqa: N802
        print("SAVED")
        with open(f"{folder}/{progname}.{self.PROG_EXT}", "w") as file:
            file.write("\n".join(self.lines) + "\n")

    def _at(self, pose):
        return " ".join(f"{row[3]:.3f}" for row in pose[:3]) + f" down {pose[2][2]:g}"

    def MoveL(self, pose, joints, conf_RLF=None):  # noqa: N802, N803
        assert joints is None
        self.lines.append(f"line {self._at(pose)}")

    def MoveC(self, pose1, joints1, pose2, joints2, conf_RLF_1=None, conf_RLF_2=None):  # noqa: N802, N803
        self.lines.append(f"circle {self._at(pose1)} to {self._at(pose2)}")

    def setFrame(self, pose, frame_id=None, frame_name=None):  # noqa: N802
        self.lines.append(f"frame {self._at(pose)}")

    def setTool(self, pose, tool_id=None, tool_name=None):  # noqa: N802
        self.lines.append(f"tool {self._at(pose)}")

    def Pause(self, time_ms):  # noqa: N802
        self.lines.append(f"pause {time_ms:.0f}")

    def setSpeed(self, speed_mms):  # noqa: N802
        self.lines.append(f"speed {speed_mms:g}")

    def setAcceleration(self, accel_mmss):  # noqa: N802
        self.lines.append(f"acceleration {accel_mmss:g}")

    def setZoneData(self, zone_mm):  # noqa: N802
        self.lines.append(f"zone {zone_mm:g}")

    def RunMessage(self, message, iscomment=False):  # noqa: N802
        self.lines.append(("; " if iscomment else "say ") + message)

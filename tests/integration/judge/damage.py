"""Damage a correct program as an editor, a sender or a typing error could.

The same seed gives the same damage.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


class Script(NamedTuple):
    """The parts of a robot's language that a damage needs.

    remark: the beginning of a comment.
    moves: a pattern for the beginning of a line that moves.
    words: pairs of a word and another one of its kind that replaces it.
    modes: pairs of a word that sets frames or tools and its replacement.
    offsets: a pattern for lines whose numbers shift all later moves.
    shifts: the amounts of a shift, written with the given decimals.
    more: lines that do something else.
    says: a line that only shows a message.
    rates: patterns for speeds, accelerations and blends; their second group is the number.
    after: the number of lines of code after the last stroke.
    first: the number of lines before which no remark may stand.
    """

    remark: str
    moves: str
    words: tuple[tuple[str, str], ...]
    modes: tuple[tuple[str, str], ...]
    offsets: str
    shifts: tuple[float, ...]
    more: tuple[str, ...]
    says: str
    rates: tuple[str, ...]
    after: int = 0
    first: int = 0
    decimals: int = 3
    data: str = ""


PRINTER = Script(
    remark=";",
    moves=r"G[0-3] [XYZ]",
    words=(
        *(
            ("X", "Y"),
            ("Y", "X"),
            ("Z", "X"),
            ("Z", "E"),
            ("G1", "G0"),
            ("G0", "G1"),
            ("G1 ", ""),
            ("G0 ", ""),
        ),
        *(
            ("G1", "G2"),
            ("F", "S"),
            ("P", "S"),
            ("Y", "Z"),
            ("G1", "G28"),
            ("G2 ", "G3 "),
            ("G3 ", "G2 "),
            ("I", "J"),
        ),
    ),
    modes=(
        *(("G21", "G20"), ("G90", "G91"), ("G21", ""), ("G90", ""), ("M400", "M410"), ("M400", "M2")),
        *(("M0", "M1"), ("M0", "M2"), ("M400", "M30")),
    ),
    offsets=r"^G0 Z|^G4 ",
    shifts=(-100, -5, -1, 1, 0.2),
    more=(
        *("G92 X0 Y0", "G92 X10 Y10 Z0", "G92 Z-1", "G91", "G20", "G28", "M0", "M2", "M3 S200", "M5", "M30"),
        *("M220 S200", "G4 P500", "G4 S5", "T1", "M84", "M204 S5000", "PAUSE", "G90", "G21", "M400", "M112"),
    ),
    says="M117 {}",
    rates=(r"(F)(\d+\.\d+)", r"(G4 P)(\d+)"),
)
SCRIPTS = {
    "marlin": PRINTER,
    "klipper": PRINTER._replace(modes=(*PRINTER.modes, ("PAUSE", "M0"))),
    "marlin-servo": PRINTER._replace(
        moves=r"G[01] X|M280",
        words=(
            *(
                ("X", "Y"),
                ("Y", "X"),
                ("Y", "Z"),
                ("G1", "G0"),
                ("G0", "G1"),
                ("G1 ", ""),
                ("G1", "G2"),
                ("F", "S"),
            ),
            *(("P", "S"), ("S", "T"), ("P0", "P1"), ("M280", "M281"), ("M280", "M28"), ("G4", "G1")),
        ),
        modes=(*PRINTER.modes, ("M400", ""), ("S90", "S40"), ("S40", "S90"), ("S40", "S140")),
        offsets=r"^M280|^G4 ",
        rates=(r"(F)(\d+\.\d+)", r"(G4 P)(\d+)", r"(M280 P0 S)(\d+)"),
    ),
    "urscript": Script(
        remark="  #",
        moves="  move",
        words=(
            *(("movel", "movep"), ("movep", "movel"), ("movel", "movej"), ("movec", "movel"), ("a=", "v=")),
            *(("mode=1", "mode=0"), ("v=", "a=")),
        ),
        modes=(("set_tcp(", "set_tpc("), ("pose_trans(paper", "pose_trans(here"), ("paper = ", "p = ")),
        offsets=r"set_tcp|  paper =|return pose_trans",
        shifts=(-0.1, -0.001, 0.001, 0.1),
        more=("  halt", "  sleep(0.500)", "  set_digital_out(0, True)", '  textmsg("x")'),
        says='  textmsg("{}")',
        rates=(r"(\b[avr]=)(\d+\.\d+)",),
        after=1,
        first=1,
        decimals=7,
    ),
    "jaka": Script(
        remark="#",
        moves=r"(?:to|via) = |mov[lc]",
        words=(
            *(("movl", "movj"), ("movc(via, to", "movl(to"), ("to = ", "via = "), ("via = ", "to = ")),
            *(("(to, 0", "(to, 1"), ("(up, 1", "(up, 0"), ("here[2]", "here[1]"), (" - here", " + here")),
        ),
        modes=(
            *(("set_tool(", "set_tol("), ("tool = ", "tol = "), ("frame_id(0", "frame_id(1")),
            ("up = ", "u = "),
        ),
        offsets=r"^(?:tool|to|rise) =",
        shifts=(-100, -1, 1, 0.2, 90),
        more=("exit()", "sleep(0.500)", "set_digital_output(0, 0, 1, 1)", "pause()", 'log_message(1, "x")'),
        says='log_message(1, "{}")',
        rates=tuple(rf"(mov\w\([\w, ]*, (?:\d+\.\d+, ){{{k}}})(\d+\.\d+)" for k in range(3)),
    ),
    "rapid": Script(
        remark="  !",
        moves=r" +Move",
        words=(
            *(
                ("MoveL", "MoveJ"),
                ("MoveC", "MoveL"),
                ("MoveL", "Movel"),
                ("fine", "z10"),
                ("trans.z", "trans.y"),
            ),
            *(("mm_s(", "within("), ("within(", "mm_s("), ("<", ">"), ("here", "on_paper"), (":=", "=")),
        ),
        modes=(
            *(
                ("WObj:=paper", "WObj:=wobj0"),
                ("brush\\", "tool0\\"),
                ("\\WObj:=paper", ""),
                ("brush", "brsh"),
            ),
            *(("\\Off", "\\On"), ("FALSE", "TRUE"), ("TRUE", "FALSE")),
        ),
        offsets=r"  LOCAL PERS|    RETURN|      here",
        shifts=(-100, -1, 1, 0.2, 0.01),
        more=(
            *("    EXIT;", "    WaitTime 0.5;", "    SetDO do1, 1;", "    Stop;", '    TPWrite "x";'),
            *("    ConfL \\On;", "    AccSet 10, 10;", "    VelSet 200, 5000;"),
        ),
        says='    TPWrite "{}";',
        rates=(r"(mm_s\()(\d+\.\d+)", r"(within\()(\d+\.\d+)", r"(Max:=)(\d+\.\d+)"),
        after=1,
    ),
    "xarm": Script(
        remark="#",
        moves=r"go\(",
        words=(
            *(
                ("go(", "rise("),
                ("None", "Nan"),
                ("radius", "speed"),
                ("here[2]", "here[1]"),
                ("<", ">"),
                ("x, y", "y, x"),
            ),
            *(("False", "True"), ("wait=", "relative="), ("!=", "=="), ("    ", ""), ("arrive", "arive")),
        ),
        modes=(
            *(
                ("set_tcp_offset(TOOL", "set_tcp_offset(UPRIGHT"),
                ("TOOL", "TOL"),
                ("set_mode(0", "set_mode(1"),
            ),
            *(
                ("set_state(0", "set_state(3"),
                ("motion_enable(True", "motion_enable(False"),
                ("MOST = ", "MUST = "),
            ),
        ),
        offsets=r"^(?:UPRIGHT|TOOL) =|world_offset",
        shifts=(-100, -1, 1, 0.2, 90),
        more=(
            *("sys.exit()", "rest(0.500)", "arm.set_cgpio_digital(0, 1)", 'stop("x")', 'print("x")'),
            *("arm.set_state(4)", "arrive()", "arm.disconnect()", "arm.set_mode(2)"),
        ),
        says='print("{}")',
        rates=(
            r"(go\((?:-?[\d.]+, ){3})(\d+\.\d+)",
            r"(go\((?:-?[\d.]+, ){4})(\d+\.\d+)",
            r"(MOST = |rise\([\d.]+, )(\d+\.\d+)",
        ),
        after=2,
    ),
    "krl": Script(
        remark=";",
        moves=r"LIN |CIRC |\$VEL|\$APO",
        words=(
            *(
                ("LIN", "PTP"),
                ("CIRC", "LIN"),
                ("LIN", "lin"),
                (" C_DIS", ""),
                ("} ", "} C_DIS "),
                ("X ", "Y "),
            ),
            *(
                ("here.Z", "here.Y"),
                ("<", ">"),
                ("$VEL", "$ACC"),
                ("$APO", "$VEL"),
                ("A ", "B "),
                ("CDIS", "CPTP"),
            ),
        ),
        modes=(
            *(
                ("$BASE", "$TOOL"),
                ("$TOOL", "$BASE"),
                ("#INITMOV", "#TOOL"),
                ("E6POS", "E6AXIS"),
                ("$POS_ACT", "$NULLFRAME"),
            ),
            *(("$AXIS_ACT", "HOME"), ("DEF ", "DEFFCT ")),
        ),
        offsets=r"^\$(?:TOOL|BASE)|here\.Z",
        shifts=(-100, -1, 1, 0.2, 0.01),
        more=(
            "EXIT",
            "WAIT SEC 0.5",
            "$OUT[1]=TRUE",
            "HALT",
            "$OV_PRO=100",
            "$VEL.CP = 2",
            "$APO.CDIS = 5",
            "RETURN",
        ),
        says="$FLAG[1]={}",
        rates=(r"(\$VEL\.CP = )(\d+\.\d+)", r"(\$APO\.CDIS = )(\d+\.\d+)", r"(\$ACC\.CP = )(\d+\.\d+)"),
    ),
    "dobot": Script(
        remark="--",
        moves=r"MovL|Arc",
        words=(
            *(("MovL", "MovJ"), ("Arc", "MovL"), ("MovL", "movl"), ("speed", "v"), ("speed", "Speed")),
            *(("speed", "r"), (", r =", ", cp ="), ("}", ", r = 5}"), ("here[3]", "here[2]"), ("<", ">")),
            *((".pose", ""), ("x, y, z", "y, x, z"), ("{speed", "{tool = 0, speed"), ("pose =", "joint =")),
        ),
        modes=(
            *(("SetUser(1", "SetUser(0"), ("SetTool(1", "SetTool(2"), ("SetTool", "SetUser")),
            *(("User(1)", "User(0)"), ("Tool(1)", "Tool(0)"), ("CP(0)", "CP(50)"), ("})", "}, 1)")),
            *(("GetPose(1, 1)", "GetPose()"), ("GetPose(1, 1)", "GetPose(0, 1)"), ("function ", "func ")),
        ),
        offsets=r"^Set|here\[3\]|return",
        shifts=(-100, -1, 1, 0.2, 90),
        more=(
            *(
                "Halt()",
                "Wait(500)",
                "DO(1, ON)",
                "Pause()",
                "User(0)",
                "CP(100)",
                "ToolDO(1, 1)",
                "SetCollisionLevel(0)",
            ),
            *("SpeedFactor(100)", "MovL(on_paper(0, 0, -1), {speed = 10})", "SetPayload(1, {0, 0, 0})"),
        ),
        says='print("{}")',
        rates=(r"(speed = )(\d+)", r"(r = )(\d+)", r"(Wait\()(\d+)"),
    ),
    "fanuc": Script(
        remark=" : !",
        moves=r" : [LC] | :  P|\t[XW] =",
        words=(
            *(("L P", "J P"), ("L P", "C P"), ("C P", "L P"), ("mm/sec", "cm/min"), ("mm/sec", "sec")),
            *(("FINE", "CNT100"), ("CNT", "CR"), ("FINE", ""), ("X =", "Y ="), ("Z =", "X ="), ("mm,", "m,")),
            *(
                (",3]", ",2]"),
                ("<", ">"),
                ("P[", "PR["),
                (" ;", ""),
                ("};", "}"),
                ("GP1", "GP2"),
                ("W =", "R ="),
            ),
        ),
        modes=(
            *(("UFRAME_NUM=1", "UFRAME_NUM=0"), ("UTOOL_NUM=1", "UTOOL_NUM=2"), ("UTOOL[1]", "UFRAME[1]")),
            *(("UF : 1", "UF : 0"), ("UT : 1", "UT : 2"), ("'N U T", "'F U T"), ("'N U T", "'N D T")),
            *(("1,*,*,*,*", "*,*,*,*,*"), ("=LPOS", "=JPOS"), ("THEN", ""), ("/POS", ""), ("/PROG", "/PRG")),
        ),
        offsets=r"PR\[|\t[XW] =",
        shifts=(-100, -1, 1, 0.2, 90),
        more=(
            *(" : ABORT ;", " : WAIT 0.50(sec) ;", " : DO[1]=(ON) ;", " : PAUSE ;", " : UFRAME_NUM=0 ;"),
            *(
                " : PR[1,3]=50 ;",
                " : UTOOL[1]=PR[2] ;",
                " : OVERRIDE=100% ;",
                " : CALL OTHER ;",
                " : JMP LBL[1] ;",
            ),
            *(" : L P[1] 100mm/sec FINE ;", " : PAYLOAD[2] ;", " : LINEAR_MAX_SPEED=2000 ;"),
        ),
        says=" : MESSAGE[{}] ;",
        rates=(r"( )(\d+)(?=mm/sec)", r"(CNT)(\d+)", r"(WAIT )(\d+\.\d+)"),
        first=6,
        data="/POS",
    ),
    "doosan": Script(
        remark="#",
        moves=r"move[lc]\(|set_velx",
        words=(
            *(
                ("movel", "movej"),
                ("movec", "movel"),
                ("movel", "amovel"),
                ("radius", "ref"),
                ("radius", "time"),
            ),
            *(
                ("velx", "accx"),
                ("here[2]", "here[1]"),
                ("<", ">"),
                ("x, y", "y, x"),
                ("    ", ""),
                (")[0]", ")"),
            ),
            *(
                (", radius=", ", acc="),
                ("tip", "top"),
                ("on_paper(", "posx("),
                ("))", "), mod=1)"),
                ("abs", "sum"),
            ),
        ),
        modes=(
            *(
                ('set_tcp("brush', 'set_tcp("hand'),
                ("set_ref_coord(paper", "set_ref_coord(DR_BASE"),
                ("(paper)", "()"),
            ),
            *(
                ("ref=DR_BASE", "ref=DR_TOOL"),
                ("paper = ", "sheet = "),
                ("DR_PM_MESSAGE", "DR_PM_ALARM"),
                ("def ", "de "),
            ),
        ),
        offsets=r"paper =|here\[2\]|    return|if abs",
        shifts=(-100, -1, 1, 0.2, 90),
        more=(
            *(
                "exit()",
                "wait(0.500)",
                "set_digital_output(1, 1)",
                'tp_log("x")',
                "set_velx(300, 30)",
                "set_accx(9000, 90)",
            ),
            *("set_ref_coord(DR_BASE)", "movel(posx(0, 0, 0, 0, 180, 0))", "stop(1)", 'set_tool("t")'),
        ),
        says='tp_log("{}")',
        rates=(r"(set_velx\()(\d+\.\d+)", r"(radius=)(\d+\.\d+)", r"(set_accx\()(\d+\.\d+)"),
    ),
    "hpgl": Script(
        remark='CO "',
        moves=r"PA-?\d|PU|PD",
        words=(
            *(("PA", "PR"), ("PU", "PD"), ("PD", "PU"), ("PA", "PD"), ("PD", "PA"), (",", ";"), (";", "")),
            *((";", ","), ("PA", "PU"), ("PA", "pa"), ("VS", "SP"), ("SP", "VS"), ("PU;", ""), ("PA", "AA")),
        ),
        modes=(
            *(("IN", ""), ("IN", "DF"), ("PA;", "PR;"), ("SP1", "SP2"), ("SP1", "SP"), ("SP0", "SP1")),
            *(("PA;", ""), ("VS2", "VS38"), ("VS", "FS")),
        ),
        offsets=r"PA\d",
        shifts=(-4000, -40, -1, 1, 400),
        more=(
            *("SC0,100,0,100;", "IP0,0,4000,4000;", "RO90;", "PR;", "IN;", "PD;", "PU;", "SP2;", "VS38;"),
            *("EA1000,1000;", "CI200;", "LBx;", "PD0,0;", "PA0,0;", "PG;", "VS1;"),
        ),
        says="LB{};",
        rates=(r"(VS)(\d+)",),
        after=1,
        decimals=0,
    ),
    "ebb": Script(
        remark="#",
        moves=r"SM|S2",
        words=(
            *(("SM", "XM"), ("SM", "LM"), ("S2", "SP"), ("SM", "S2"), ("S2", "SM"), (",-", ","), (",", ";")),
            *((",0,0", ",0"), (",4,", ",5,"), ("SM", "sm"), (",0,", ",1,"), (",", ",-"), (",4,0,0", ",4")),
        ),
        modes=(
            *(("EM,1,1", "EM,2,2"), ("EM,1,1", "EM,0,0"), ("EM", ""), ("SR,0,1", "SR,60000,1"), ("SR", "")),
            *(("SR,0,1", "SR,0,0"), (",4,0,", ",4,100,")),
        ),
        offsets=r"SM",
        shifts=(-800, -80, -1, 1, 80),
        more=(
            *("SM,500,100,100", "SP,0", "SP,1", "TP", "CS", "HM,4000", "EM,0,0", "EM,1,1", "R", "SC,4,12000"),
            *("SM,500,0,0", "S2,0,4", "S2,15000,4,0,0", "XM,100,10,10", "SR,0,1", "QG", "SR,60000"),
        ),
        says="says,{}",
        rates=(r"(SM,)(\d+)", r"(S2,\d+,4,0,)(\d+)"),
        decimals=0,
    ),
    "ros2": Script(
        remark="#",
        moves=r"-?\d",
        words=(
            *(
                (",pose", ""),
                ("way", "rest"),
                ("000,", ","),
                (",", ";"),
                ("pose", "poses"),
            ),
            *(("1.0000", "0.9999"), ("0.", "-0."), (".", ","), ("0.0000", "0.0200"), ("1.0", "-1.0")),
        ),
        modes=(
            ("x_m,y_m", "y_m,x_m"),
            ("time_s", "time_ms"),
            ("x_m", "x_mm"),
            ("limit_m_s,", ""),
            ("qx", "qw"),
        ),
        offsets=r"\d",
        shifts=(-0.1, -0.001, 0.001, 0.1),
        more=("0,0,0,0,0,0,0,1,0.1,pose", "1e3", "stop", "time_s", "5.0,0.4,0,0.2,1,0,0,0,0.1,pose"),
        says="says,{}",
        rates=(r"(^)(\d+\.\d+)",),
        decimals=8,
    ),
}


HEADS = ("COMMENT", "PROTECT", "DEFAULT_GROUP")


class Page:
    """The lines of a program, sorted by kind. `damaged` adds the line ends again."""

    def __init__(self, text: str, dialect: str):
        self.dialect, self.script = dialect, SCRIPTS.get(dialect)
        self.remark = self.script.remark if self.script else "("
        self.lines = text.split("\n")[:-1]
        self.comments = [k for k, line in enumerate(self.lines) if self._comment(line)]
        self.code = [k for k, line in enumerate(self.lines) if line.strip() and not self._comment(line)]
        self.header = [k for k in self.comments if k < next(c for c in self.code if self._acts(c))]
        self.titles = [k for k in self.comments if re.search(r"stroke \d|paint: ", self.lines[k])]
        moves = self.script.moves if self.script else r"G[0-3] |M3 "
        self.moves = [k for k in self.code if re.match(moves, self.lines[k])]
        data = self.script.data if self.script else ""
        self.data = self.lines.index(data) if data in self.lines else len(self.lines)

    def _comment(self, line: str) -> bool:
        return line.startswith(self.remark)

    def _acts(self, k: int) -> bool:
        return not self.lines[k].startswith(("def ", "MODULE ", "&", "DEF ", "/", *HEADS))

    def sections(self) -> list[tuple[int, int]]:
        """Return the line of each title and the line after its section."""
        last = self.code[-1] + (self.dialect in ("jaka", "xarm", "dobot", "doosan", "ros2", "ebb"))
        last = min(last - (self.script.after if self.script else 0), self.data)
        ends = [*self.titles[1:], last]
        return list(zip(self.titles, ends, strict=True))

    def made(self, words: str) -> str:
        if self.dialect == "hpgl":
            return f'CO "{words}";'
        end = " ;" if self.remark.startswith(" : ") else ""
        return f"{self.remark} {words}{end}" if self.script else f"({words})"


Damage = Callable[[Page, np.random.Generator], list[str] | None]


def _pick(random, some):
    return some[int(random.integers(len(some)))]


def _with(page: Page, k: int, *instead: str) -> list[str]:
    return [*page.lines[:k], *instead, *page.lines[k + 1 :]]


def _at_number(page: Page, random, lines, change: Callable[[str], str]) -> list[str] | None:
    """Change one number in one of the given lines."""
    k = _pick(random, lines)
    found = list(NUMBER.finditer(page.lines[k]))
    if not found:
        return None
    one = _pick(random, found)
    line = page.lines[k]
    return _with(page, k, line[: one.start()] + change(one[0]) + line[one.end() :])


def _numbers(page: Page, random) -> list[int]:
    return page.moves if random.random() < 0.6 else page.code


def sign(page, random):
    return _at_number(page, random, _numbers(page, random), lambda n: n[1:] if n.startswith("-") else f"-{n}")


def digit(page, random):
    def change(number: str) -> str:
        at = _pick(random, [k for k, letter in enumerate(number) if letter.isdigit()])
        return number[:at] + str((int(number[at]) + int(random.integers(1, 10))) % 10) + number[at + 1 :]

    return _at_number(page, random, _numbers(page, random), change)


def last_digit(page, random):
    """Add or subtract one in the last decimal, as rounding could."""

    def change(number: str) -> str:
        decimals = len(number.partition(".")[2])
        if not decimals:
            return number
        return f"{float(number) + float(random.choice((-1, 1))) * 10.0**-decimals:.{decimals}f}"

    return _at_number(page, random, page.moves, change)


def digit_lost(page, random):
    def change(number: str) -> str:
        at = int(random.integers(len(number)))
        return number[:at] + number[at + 1 :]

    return _at_number(page, random, _numbers(page, random), change)


def digit_more(page, random):
    def change(number: str) -> str:
        at = int(random.integers(len(number) + 1))
        return number[:at] + str(int(random.integers(10))) + number[at:]

    return _at_number(page, random, _numbers(page, random), change)


def point_moved(page, random):
    def change(number: str) -> str:
        factor = float(random.choice((0.1, 10.0, 100.0, 25.4)))
        decimals = len(number.partition(".")[2])
        return f"{float(number) * factor:.{decimals}f}"

    return _at_number(page, random, _numbers(page, random), change)


def line_lost(page, random):
    return _with(page, _pick(random, page.code))


def comment_lost(page, random):
    return _with(page, _pick(random, page.comments))


def line_doubled(page, random):
    k = _pick(random, page.code)
    return _with(page, k, page.lines[k], page.lines[k])


def lines_swapped(page, random):
    k = int(random.integers(len(page.lines) - 1))
    return [*page.lines[:k], page.lines[k + 1], page.lines[k], *page.lines[k + 2 :]]


def line_moved(page, random):
    """Move a line to another place."""
    k = _pick(random, page.code)
    lines = _with(page, k)
    at = int(random.integers(len(lines) + 1))
    return [*lines[:at], page.lines[k], *lines[at:]]


def lines_lost(page, random):
    k = _pick(random, page.code)
    return page.lines[:k] + page.lines[k + int(random.integers(2, 8)) :]


def line_of_another_stroke(page, random):
    """Overwrite a moving line with another moving line."""
    return _with(page, _pick(random, page.moves), page.lines[_pick(random, page.moves)])


def stroke_lost(page, random):
    a, b = _pick(random, page.sections())
    return page.lines[:a] + page.lines[b:]


def stroke_doubled(page, random):
    a, b = _pick(random, page.sections())
    return page.lines[:b] + page.lines[a:]


def strokes_swapped(page, random):
    sections = page.sections()
    if len(sections) < 2:
        return None
    k = int(random.integers(len(sections) - 1))
    (a, b), (_, c) = sections[k], sections[k + 1]
    return page.lines[:a] + page.lines[b:c] + page.lines[a:b] + page.lines[c:]


def stroke_reversed(page, random):
    a, b = _pick(random, page.sections())
    moves = [k for k in range(a, b) if k in page.moves]
    if not moves:
        return None
    first, last = moves[0], moves[-1] + 1
    return page.lines[:first] + page.lines[first:last][::-1] + page.lines[last:]


def cut_off(page, random):
    return page.lines[: _pick(random, page.code)]


def feed(page, random):
    """Change a speed, or the acceleration or blend of a robot."""
    word = r"(F|G64 P)(\d+\.\d+)"
    if page.script:
        rates = page.script.rates
        word = rates[int(random.integers(len(rates)))] if len(rates) > 1 else rates[0]
    if random.random() < 0.2 and not page.script:
        word = r"(P)(\d+\.\d+)"  # the time of a dwell
    lines = [k for k in page.code if re.search(word, page.lines[k])]
    if not lines:
        return None
    k = _pick(random, lines)
    factor = float(random.choice((0.0, 0.1, 0.5, 0.9, 0.99, 1.01, 1.1, 1.3, 2.0, 10.0, 60.0)))
    found = _pick(random, list(re.finditer(word, page.lines[k])))
    decimals = len(found[2].partition(".")[2])
    new = f"{float(found[2]) * factor:.{decimals}f}"
    return _with(page, k, page.lines[k][: found.start(2)] + new + page.lines[k][found.end(2) :])


def word_lost(page, random):
    k = _pick(random, page.moves)
    between = " " if " " in page.lines[k].strip(" ") else ","  # of a table
    words = page.lines[k].split(between)
    at = int(random.integers(len(words)))
    return _with(page, k, between.join(words[:at] + words[at + 1 :]))


def word_changed(page, random):
    """Replace the letters of a word: one axis or code for another."""
    pairs = (
        page.script.words
        if page.script
        else (
            *(("X", "Y"), ("Y", "X"), ("Z", "X"), ("G1", "G0"), ("G0", "G1"), ("G2", "G3"), ("G3", "G2")),
            *(("G1 ", ""), ("G0 ", ""), ("I", "J"), ("S", "F"), ("F", "S"), ("M3", "M4"), ("M3", "M5")),
            *(("G1", "G2"), ("P", "F"), ("Z", "S"), ("Y", "Z")),
        )
    )
    old, new = _pick(random, pairs)
    lines = [k for k in page.code if old in page.lines[k]]
    if not lines:
        return None
    k = _pick(random, lines)
    return _with(page, k, page.lines[k].replace(old, new, 1))


MODES = {
    "G21": ("G20", ""),
    "G90": ("G91", ""),
    "G17": ("G18", "G19", ""),
    "G91.1": ("G90.1", ""),
    "G94": ("G93", "G95", ""),
    "G40": ("G41", "G42", ""),
    "G80": ("G81", "G1", ""),
    "G64": ("G61", "G61.1", "G46"),
}


def mode(page, random):
    """Change or remove units, absolute places, planes or the path mode."""
    if page.script:
        return _word(page, random, *_pick(random, page.script.modes))
    old = _pick(random, list(MODES))
    return _word(page, random, old, _pick(random, MODES[old]))


def _word(page, random, old: str, new: str):
    lines = [k for k in page.code if old in page.lines[k]]
    if not lines:
        return None
    k = _pick(random, lines)
    line = re.sub(rf"(?<![\w.]){re.escape(old)}(?![\d.])", lambda _: new, page.lines[k], count=1)
    return _with(page, k, line if page.script else " ".join(line.split()))


def offset(page, random):
    """Shift, scale or turn all later moves, or change a robot's paper or tool."""
    if script := page.script:
        k = _pick(random, [k for k in page.code if re.search(script.offsets, page.lines[k])])
        return _at_number(page, random, [k], lambda n: f"{float(n) + random.choice(script.shifts):.{script.decimals}f}")
    line = _pick(
        random,
        (
            "G92 X0 Y0",
            "G92 X10 Y10 Z0",
            "G92 Z-1",
            "G55",
            "G54",
            "G91",
            "G20",
            "G18",
            "G43 H1",
            "G10 L2 P1 X5 Y5",
        ),
    )
    return _more(page, random, line)


def _more(page, random, line: str) -> list[str]:
    at = _pick(random, page.code[1:])
    return [*page.lines[:at], line, *page.lines[at:]]


def m_code(page, random):
    if page.script:
        return _more(page, random, _pick(random, page.script.more))
    if random.random() < 0.5:
        return _more(
            page,
            random,
            _pick(random, ("M0", "M1", "M2", "M3", "M3 S500", "M4 S200", "M5", "M6 T1", "M30", "M8")),
        )
    old = _pick(random, ("M2", "M3", "M0"))
    return _word(page, random, old, _pick(random, ("M0", "M5", "M30", "M3", "M4", "M9", "M48")))


def header_fact(page, random):
    """Change a number or a letter of the header."""
    k = _pick(random, page.header)
    line = page.lines[k]
    at = _pick(random, [n for n, letter in enumerate(line) if letter.isalnum()] or [0])
    new = str(int(random.integers(10))) if line[at].isdigit() else _pick(random, "abcdefgxyz")
    return _with(page, k, line[:at] + new + line[at + 1 :])


def header_lost(page, random):
    return _with(page, _pick(random, page.header))


def title(page, random):
    """Change a letter of a section's title."""
    k = _pick(random, page.titles)
    line = page.lines[k]
    at = int(random.integers(len(page.remark) + bool(page.script), len(line) - 1))
    return _with(page, k, line[:at] + _pick(random, "abcxyz0123456789") + line[at + 1 :])


WORDS = (
    "looked at by hand",
    "slower here",
    "tuesday",
    "see page 3",
    "half of it done",
    "check this",
    "blue ink",
    "ok",
)


def remark(page, random):
    """Add a comment, as a user could."""
    at = int(random.integers(min(len(page.lines), page.data + 1)))
    at = max(at, page.script.first if page.script else 0)
    while re.match(r" : !\+| :  P", page.lines[at] if at < len(page.lines) else ""):
        at += 1  # not inside a statement that continues on the next line
    return [*page.lines[:at], page.made(_pick(random, WORDS)), *page.lines[at:]]


def blank(page, random):
    at = int(random.integers(len(page.lines)))
    return [*page.lines[:at], "", *page.lines[at:]]


ACTING = {
    "linuxcnc": (
        "MSG, hi",
        "DEBUG, #1",
        "msg,look",
        " LOGOPEN,x.txt",
        "PRINT,#5",
        "LOGCLOSE",
        "PROBEOPEN f.txt",
        "x (y",
    ),
    "grbl": ("why?", "stop!", "go~", "50%", "50 \x18 x", "caf\xe9", "?", "!"),
}


def acting(page, random):
    """Add a comment that the controller acts on, or cannot read."""
    kind = "linuxcnc" if page.dialect == "linuxcnc" else "grbl"
    words = _pick(random, ACTING[kind])
    which = random.random()
    if which < 0.25:
        k = _pick(random, page.comments)
        line = page.lines[k]
        if page.script:
            return _with(page, k, line.lstrip().replace(page.remark.strip(), "", 1) or "x")
        if kind == "linuxcnc":
            return _with(page, k, f"({words})")
        at = int(random.integers(1, len(line)))
        return _with(page, k, line[:at] + words[-1] + line[at:])
    if which < 0.4:
        k = _pick(random, page.comments)
        at = int(random.integers(3, max(4, len(page.lines[k]) - 1)))
        return _with(page, k, page.lines[k][:at] + "\r" + page.lines[k][at:])
    if which < 0.55:
        k = _pick(random, page.comments)
        return _with(page, k, page.lines[k][:-1] + " and so on" * 30 + page.lines[k][-1])
    if which < 0.65:
        return _more(page, random, "%")
    if which < 0.75:
        k = _pick(random, page.comments)
        line = page.lines[k]
        return _with(page, k, line.replace(page.remark.strip(), "", 1) if page.script else line[:-1])
    return _more(page, random, page.script.says.format(words[:3]) if page.script else page.made(words))


def return_in_line(page, random):
    k = _pick(random, page.code)
    line = page.lines[k]
    at = int(random.integers(len(line)))
    return _with(page, k, line[:at] + "\r" + line[at:])


DAMAGES: dict[str, tuple[Damage, float]] = {
    "sign": (sign, 6),
    "digit": (digit, 12),
    "last digit": (last_digit, 6),
    "digit lost": (digit_lost, 6),
    "digit more": (digit_more, 5),
    "point moved": (point_moved, 4),
    "line lost": (line_lost, 8),
    "line doubled": (line_doubled, 6),
    "lines swapped": (lines_swapped, 6),
    "line moved": (line_moved, 6),
    "lines lost": (lines_lost, 3),
    "line of another stroke": (line_of_another_stroke, 5),
    "stroke lost": (stroke_lost, 1),
    "stroke doubled": (stroke_doubled, 1),
    "strokes swapped": (strokes_swapped, 1),
    "stroke reversed": (stroke_reversed, 1),
    "cut off": (cut_off, 1),
    "feed": (feed, 6),
    "word lost": (word_lost, 5),
    "word changed": (word_changed, 5),
    "mode": (mode, 4),
    "offset": (offset, 4),
    "M code": (m_code, 4),
    "header": (header_fact, 2),
    "header lost": (header_lost, 1),
    "comment lost": (comment_lost, 1),
    "title": (title, 2),
    "remark": (remark, 4),
    "blank line": (blank, 2),
    "acting comment": (acting, 4),
    "return": (return_in_line, 1),
}


def damaged(text: str, dialect: str, count: int, seed) -> list[tuple[str, str]]:
    """Return (damage, text) of count damaged programs, no two alike."""
    random = np.random.default_rng(seed)
    end = "\r\n" if "\r\n" in text else "\n"
    page, names = Page(text.replace(end, "\n"), dialect), list(DAMAGES)
    weights = np.array([weight for _, weight in DAMAGES.values()], dtype=float)
    out: dict[str, str] = {}
    tries = 0
    while len(out) < count and tries < 20 * count:
        tries += 1
        name = names[int(random.choice(len(names), p=weights / weights.sum()))]
        lines = DAMAGES[name][0](page, random)
        if lines is None:
            continue
        new = end.join(lines) + end
        if new != text:
            out.setdefault(new, name)
    return [(name, new) for new, name in out.items()]

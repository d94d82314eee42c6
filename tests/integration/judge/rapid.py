"""Run the RAPID that a program of moves needs, as ABB's reference manuals say.

The module is loaded first. If a part of it is not RAPID, or a name is not declared, nothing runs. Then the
routine runs from its first instruction, as with the program pointer on it. Blanks and line ends mean nothing.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from .arm import Arm
from .moves import RefusedError, Run
from .places import frame

TOKEN = re.compile(
    r'\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[A-Za-z]\w*)|(?P<text>"[^"]*")'
    r"|(?P<sign>:=|<=|>=|<>|[-+*/\\\[\]\(\),;.<>=]))"
)
FIELDS = {  # the fields of each record type: names and types
    "pos": (("x", "num"), ("y", "num"), ("z", "num")),
    "orient": (("q1", "num"), ("q2", "num"), ("q3", "num"), ("q4", "num")),
    "pose": (("trans", "pos"), ("rot", "orient")),
    "confdata": (("cf1", "num"), ("cf4", "num"), ("cf6", "num"), ("cfx", "num")),
    "extjoint": tuple((f"eax_{k}", "num") for k in "abcdef"),
    "robtarget": (("trans", "pos"), ("rot", "orient"), ("robconf", "confdata"), ("extax", "extjoint")),
    "speeddata": (("v_tcp", "num"), ("v_ori", "num"), ("v_leax", "num"), ("v_reax", "num")),
    "zonedata": (
        ("finep", "bool"),
        *((name, "num") for name in ("pzone_tcp", "pzone_ori", "pzone_eax", "zone_ori", "zone_leax", "zone_reax")),
    ),
    "loaddata": (
        ("mass", "num"),
        ("cog", "pos"),
        ("aom", "orient"),
        *((name, "num") for name in ("ix", "iy", "iz")),
    ),
    "tooldata": (("robhold", "bool"), ("tframe", "pose"), ("tload", "loaddata")),
    "wobjdata": (
        ("robhold", "bool"),
        ("ufprog", "bool"),
        ("ufmec", "string"),
        ("uframe", "pose"),
        ("oframe", "pose"),
    ),
}
FINE = [True, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
NOT_NORMAL = 1e-4  # the controller stops if the norm of an orientation is off by more
OTHERS = {
    "setdo",
    "set",
    "reset",
    "exit",
    "tperase",
    "accset",
    "velset",
    "singarea",
    "confj",
    "break",
    "movej",
}


class Token(NamedTuple):
    line: int
    kind: str
    text: str


class Routine(NamedTuple):
    parameters: list[tuple[str, str]]
    returns: str
    body: list


def run_rapid(text: str, start, paper: np.ndarray, down: np.ndarray, tool: np.ndarray) -> Run:
    """Run a program for ABB.

    start is the place of the brush's tip [mm, robot's frame]. paper, down and tool come from the cell.
    """
    robot = _Robot(start, paper, down, tool)
    try:
        robot.load(_Parser(_tokens(text, robot.run)))
        robot.begin()
    except RefusedError as refusal:
        robot.run.refused = str(refusal)
    except _DoneError:
        pass
    return robot.run


class _DoneError(Exception):
    """The program ends, by EXIT or after its last instruction."""


def _tokens(text: str, run: Run) -> list[Token]:
    out = []
    for number, raw in enumerate(text.split("\n"), 1):
        line = raw.rstrip("\r")
        if "\r" in line:
            run.acts.append(f"line {number}: a return within a line")
        at = 0
        while line[at:].strip():
            rest = line[at:].lstrip()
            if rest.startswith("!"):
                out.append(Token(number, "comment", rest[1:].strip()))
                break
            found = TOKEN.match(line, at)
            if not found:
                raise RefusedError(f"line {number}: {rest[:20]!r} is no RAPID")
            kind = found.lastgroup
            word = found[kind].lower() if kind == "name" else found[kind]
            if kind == "text" and len(word) > 82:
                raise RefusedError(f"line {number}: a string of more than 80 letters")
            if kind == "name" and len(word) > 32:
                raise RefusedError(f"line {number}: a name of more than 32 letters")
            out.append(Token(number, kind, word))
            at = found.end()
    return out


class _Parser:
    """Parse tokens to a tree.

    Comments between statements stay in the tree. Comments elsewhere belong to the header.
    """

    def __init__(self, tokens: list[Token]):
        self.comments = [token for token in tokens if token.kind == "comment"]
        self.tokens, self.k = tokens, 0
        self.name = ""

    def _peek(self, offset: int = 0) -> Token:
        k = self.k
        while True:
            if k >= len(self.tokens):
                return Token(0, "end", "")
            if self.tokens[k].kind != "comment":
                if not offset:
                    return self.tokens[k]
                offset -= 1
            k += 1

    def _next(self) -> Token:
        token = self._peek()
        while self.k < len(self.tokens) and self.tokens[self.k].kind == "comment":
            self.k += 1
        self.k += 1
        return token

    def _want(self, *texts: str) -> Token:
        token = self._next()
        if token.text not in texts or token.kind == "text":
            raise RefusedError(f"line {token.line}: {token.text[:20]!r} instead of {' or '.join(texts)}")
        return token

    def _name(self) -> str:
        token = self._next()
        if token.kind != "name":
            raise RefusedError(f"line {token.line}: {token.text[:20]!r} is no name")
        return token.text

    def module(self) -> tuple[dict, dict]:
        """Return the data and the routines of the module.

        Data is {name: (type, expression or None, kind)}, and routines are {name: routine}.
        """
        self._want("module")
        self.name = self._name()
        data: dict = {}
        routines: dict[str, Routine] = {}
        while self._peek().text != "endmodule":
            at = self._peek()
            if self._peek().text in ("local", "task"):
                self._next()
            if self._peek().text in ("pers", "var", "const"):
                if routines:
                    raise RefusedError(f"line {at.line}: data behind a routine")
                name, value = self._data()
                known = data
            else:
                name, value = self._routine()
                known = routines
            if name in data or name in routines:
                raise RefusedError(f"line {at.line}: {name} is declared twice")
            known[name] = value
        self._next()
        if self._peek().kind != "end":
            raise RefusedError(f"line {self._peek().line}: something behind the module")
        return data, routines

    def _data(self):
        kind, sort, name = self._next().text, self._name(), self._name()
        value = None
        if self._peek().text == ":=":
            self._next()
            value = self._expression()
        self._want(";")
        if sort not in (*FIELDS, "num", "bool", "string"):
            raise RefusedError(f"{sort} is no type")
        return name, (sort, value, kind)

    def _routine(self):
        kind = self._want("proc", "func").text
        returns = self._name() if kind == "func" else ""
        name = self._name()
        self._want("(")
        parameters = []
        while self._peek().text != ")":
            if parameters:
                self._want(",")
            parameters.append((self._name(), self._name()))
        self._want(")")
        body = self._block(f"end{kind}")
        self._want(f"end{kind}")
        return name, Routine(parameters, returns, body)

    def _block(self, *ends: str) -> list:
        out: list = []
        while True:
            while self.k < len(self.tokens) and self.tokens[self.k].kind == "comment":
                out.append(("comment", self.tokens[self.k].line, self.tokens[self.k].text))
                self.k += 1
            token = self._peek()
            if token.text in ends and token.kind == "name":
                return out
            if token.kind != "name":
                raise RefusedError(f"line {token.line}: {token.text[:20]!r} begins no statement")
            out.append(self._statement(token))

    def _statement(self, token: Token):
        if token.text == "if":
            self._next()
            condition = self._expression()
            if self._peek().text != "then":
                return ("if", token.line, condition, [self._statement(self._peek())])
            self._next()
            block = self._block("endif")
            self._want("endif")
            return ("if", token.line, condition, block)
        if token.text == "return":
            self._next()
            value = None if self._peek().text == ";" else self._expression()
            self._want(";")
            return ("return", token.line, value)
        if self._peek(1).text in (":=", "."):
            target = self._expression()
            self._want(":=")
            value = self._expression()
            self._want(";")
            return ("assign", token.line, target, value)
        name = self._name()
        arguments = self._arguments(";")
        self._want(";")
        return ("call", token.line, name, arguments)

    def _arguments(self, end: str) -> list:
        """Return a list of (name, expression).

        The name is "" for a required argument. The expression is None for a switch.
        """
        out: list = []
        while self._peek().text != end:
            if out and self._peek().text != "\\":
                self._want(",")
            if self._peek().text == "\\":
                self._next()
                name, value = self._name(), None
                if self._peek().text == ":=":
                    self._next()
                    value = self._expression()
                out.append((name, value))
            else:
                out.append(("", self._expression()))
        return out

    def _expression(self):
        left = self._term()
        while self._peek().text in ("<", ">", "=", "<=", ">=", "<>", "+", "-", "*", "/"):
            sign = self._next().text
            left = ("both", sign, left, self._term())
        return left

    def _term(self):
        token = self._next()
        if token.text == "-":
            return ("minus", self._term())
        if token.text == "+":
            return self._term()
        if token.kind == "number":
            return ("value", float(token.text))
        if token.kind == "text":
            return ("value", token.text[1:-1])
        if token.text == "[":
            parts = [self._expression()]
            while self._peek().text == ",":
                self._next()
                parts.append(self._expression())
            self._want("]")
            return ("all", parts)
        if token.text == "(":
            inner = self._expression()
            self._want(")")
            return inner
        if token.kind != "name":
            raise RefusedError(f"line {token.line}: {token.text[:20]!r} is no value")
        if token.text in ("true", "false"):
            return ("value", token.text == "true")
        if self._peek().text == "(":
            self._next()
            arguments = self._arguments(")")
            self._want(")")
            return ("of", token.line, token.text, arguments)
        made = ("name", token.line, token.text)
        while self._peek().text == ".":
            self._next()
            made = ("part", token.line, made, self._name())
        return made


def _said(node):
    """Return an expression without its line numbers."""
    if isinstance(node, list):
        return [_said(each) for each in node]
    if not isinstance(node, tuple):
        return node
    return [_said(each) for k, each in enumerate(node) if k != 1 or node[0] not in ("name", "of", "part")]


def _fits(value, sort: str) -> bool:
    if sort in FIELDS:
        parts = FIELDS[sort]
        return (
            isinstance(value, list)
            and len(value) == len(parts)
            and all(_fits(each, its) for each, (_, its) in zip(value, parts, strict=True))
        )
    return type(value) is {"num": float, "bool": bool, "string": str}[sort]


def _as_frame(number: int, pose: list) -> np.ndarray:
    (place, (w, x, y, z)) = pose
    if abs(w * w + x * x + y * y + z * z - 1) > NOT_NORMAL:
        raise RefusedError(f"line {number}: an orientation that is not normalised")
    turned = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return frame(place, turned)


class _Robot(Arm):
    def __init__(self, start, paper, down, tool):
        super().__init__(start, paper, down, tool, by_radius=True)
        self.data: dict[str, list] = {}  # [type, value, kind]
        self.routines: dict[str, Routine] = {}
        self.scopes: list[dict] = []
        self.is_watched = True  # ConfL: configurations are supervised until switched off
        self.acceleration = np.inf
        self.entry = ""

    def load(self, parser: _Parser) -> None:
        data, self.routines = parser.module()
        procs = [name for name, routine in self.routines.items() if not routine.returns]
        if len(procs) != 1 or self.routines[procs[0]].parameters:
            raise RefusedError("there is no routine to begin with")
        self.entry = procs[0]
        self.run.frame.append(f"module {parser.name}, routine {self.entry}")
        for name, (sort, expression, kind) in data.items():
            if kind == "pers" and expression is None:
                raise RefusedError(f"{name} has no value")
            value = None if expression is None else self._value(0, expression)
            if value is not None and not _fits(value, sort):
                raise RefusedError(f"{name} is no {sort}")
            self.data[name] = [sort, value, kind]
        for routine in self.routines.values():
            for each in routine.body:
                self._linked(each, {name for _, name in routine.parameters})
        first = min((each[1] for each in self.routines[self.entry].body), default=0)
        self.run.header = [token.text for token in parser.comments if token.line < first]

    def _linked(self, node, local: set) -> None:
        """Check that every name is declared, since otherwise the module does not load."""
        if isinstance(node, list):
            for each in node:
                self._linked(each, local)
            return
        if not isinstance(node, tuple) or not node:
            return
        known = local | self.data.keys() | {"fine"}
        if node[0] == "name" and node[2] not in known:
            raise RefusedError(f"line {node[1]}: {node[2]} is not declared")
        if node[0] == "of" and node[2] not in self.routines and node[2] not in ("crobt", "offs"):
            raise RefusedError(f"line {node[1]}: there is no function {node[2]}")
        if (
            node[0] == "call"
            and node[2] not in self.routines
            and not (hasattr(self, f"_do_{node[2]}") or node[2] in OTHERS)
        ):
            raise RefusedError(f"line {node[1]}: there is no routine {node[2]}")
        if node[0] == "call" and node[2] == "tpwrite":
            self.run.frame.append(f"says {_said(node[3])}")
        for each in node[1:]:
            self._linked(each, local)

    def begin(self) -> None:
        self._statements(self.routines[self.entry].body)

    # Statements --------------------------------------------------------------------------------------

    def _statements(self, body: list):
        for node in body:
            what, number = node[:2]
            if what == "comment":
                self.run.titles.append((node[2], len(self.run.legs)))
            elif what == "if":
                inner = [each[0] for each in node[3] if each[0] != "comment"]
                is_so = self._value(number, node[2])
                if not self.scopes:
                    self.run.frame.append(f"if {_said(node[2])} {inner}")
                if is_so and (found := self._statements(node[3])) is not None:
                    return found
            elif what == "return":
                return self._value(number, node[2]) if node[2] else True
            elif what == "assign":
                self._assign(number, node[2], node[3])
            else:
                self._call(number, node[2], node[3])
        return None

    def _assign(self, number: int, target, expression) -> None:
        path = []
        while target[0] == "part":
            path.append(target[3])
            target = target[2]
        if target[0] != "name" or target[2] not in self.data:
            raise RefusedError(f"line {number}: nothing that can be set")
        entry = self.data[target[2]]
        sort, value = entry[0], self._value(number, expression)
        if not path:
            if not _fits(value, sort):
                raise RefusedError(f"line {number}: no {sort}")
            entry[1] = value
            return
        holder = entry[1]
        for name in reversed(path[1:]):
            k, sort = self._field(number, sort, name)
            holder = holder[k]
        k, sort = self._field(number, sort, path[0])
        if holder is None or not _fits(value, sort):
            raise RefusedError(f"line {number}: no {sort}")
        holder[k] = value

    def _field(self, number: int, sort: str, name: str) -> tuple[int, str]:
        for k, (field, its) in enumerate(FIELDS.get(sort, ())):
            if field == name:
                return k, its
        raise RefusedError(f"line {number}: a {sort} has no {name}")

    def _call(self, number: int, name: str, arguments: list) -> None:
        if name in OTHERS:
            self.run.acts.append(f"line {number}: {name}")
            if name in ("exit", "break"):
                raise _DoneError
            return
        if name in self.routines:
            self.run.acts.append(f"line {number}: begins again")
            raise _DoneError
        given = [self._value(number, value) for its, value in arguments if not its]
        options = {its: value for its, value in arguments if its}
        getattr(self, f"_do_{name}")(number, given, options)

    # Instructions ------------------------------------------------------------------------------------

    def _do_confl(self, number: int, given: list, options: dict) -> None:
        if given or set(options) not in ({"off"}, {"on"}):
            raise RefusedError(f"line {number}: ConfL \\On or \\Off")
        self.is_watched = "on" in options

    def _do_pathacclim(self, number: int, given: list, options: dict) -> None:
        if len(given) != 2 or not all(type(each) is bool for each in given):
            raise RefusedError(f"line {number}: PathAccLim of two switches")
        limits = [self._option(number, options, name, "num") for name in ("accmax", "decelmax") if name in options]
        if len(limits) != sum(given) or (limits and min(limits) < 0.1):
            raise RefusedError(f"line {number}: no acceleration of 0.1 m/s2 and more")
        self.acceleration = max(limits) if all(given) else np.inf

    def _do_waittime(self, number: int, given: list, options: dict) -> None:
        if len(given) != 1 or not _fits(given[0], "num") or set(options) - {"inpos"}:
            raise RefusedError(f"line {number}: waits for no time")
        if "inpos" not in options and self.run.legs and self.run.legs[-1].cut_mm > 0:
            self.run.acts.append(f"line {number}: waits before the robot is there")
        self.rest(number, "wait", given[0])

    def _do_stop(self, number: int, given: list, options: dict) -> None:
        if given or set(options) - {"noregain", "allmoves"}:
            raise RefusedError(f"line {number}: Stop with something")
        self.rest(number, "stop")

    def _do_tpwrite(self, number: int, given: list, options: dict) -> None:
        if len(given) != 1 or type(given[0]) is not str or options:
            raise RefusedError(f"line {number}: TPWrite of no string")
        self.run.titles.append((f"stop: {given[0]}", len(self.run.legs)))

    def _do_movel(self, number: int, given: list, options: dict) -> None:
        to, speed, zone = self._moving(number, given, options, 1)
        self.line(number, to, speed, self.acceleration, zone)

    def _do_movec(self, number: int, given: list, options: dict) -> None:
        via, to, speed, zone = self._moving(number, given, options, 2)
        self.circle(number, via, to, speed, self.acceleration, zone)

    def _moving(self, number: int, given: list, options: dict, points: int) -> tuple:
        sorts = ["robtarget"] * points + ["speeddata", "zonedata", "tooldata"]
        if len(given) != len(sorts) or not all(map(_fits, given, sorts)):
            raise RefusedError(f"line {number}: not what a move is made of")
        if set(options) - {"wobj"}:
            raise RefusedError(f"line {number}: a move of another kind")
        if self.is_watched:
            self.run.acts.append(f"line {number}: configurations are supervised")
        *targets, speed, zone, tool = given
        if not tool[0] or tool[2][0] <= 0:
            raise RefusedError(f"line {number}: a tool that the robot does not hold, or without mass")
        self.tcp = _as_frame(number, tool[1])
        base = np.eye(4)
        if "wobj" in options:
            base = self._work_object(number, self._option(number, options, "wobj", "wobjdata"))
        frames = [base @ _as_frame(number, target[:2]) for target in targets]
        if not zone[0] and zone[2] < zone[1]:
            raise RefusedError(f"line {number}: a zone that the tool turns in is smaller than its own")
        numbers = [
            speed[1:],
            tool[2],
            *(target[2:] for target in targets),
        ]  # turns, load, configurations, other axes
        numbers += [] if zone[0] else [[each - zone[1] for each in zone[2:4]], zone[4], zone[6], zone[1] == 0]
        self.run.frame.append(f"moves with {numbers}")
        return (*frames, speed[0], 0.0 if zone[0] else zone[1])

    def _work_object(self, number: int, wobj: list) -> np.ndarray:
        if wobj[0] or not wobj[1] or wobj[2]:
            raise RefusedError(f"line {number}: a work object that is not fixed")
        return _as_frame(number, wobj[3]) @ _as_frame(number, wobj[4])

    def _option(self, number: int, options: dict, name: str, sort: str):
        value = self._value(number, options[name]) if options[name] else None
        if not _fits(value, sort):
            raise RefusedError(f"line {number}: \\{name} is no {sort}")
        return value

    # Values ------------------------------------------------------------------------------------------

    def _value(self, number: int, node):
        what = node[0]
        if what == "value":
            return node[1]
        if what == "all":
            return [self._value(number, each) for each in node[1]]
        if what == "minus":
            return -self._number(number, node[1])
        if what == "both":
            return self._both(number, node[1], self._number(number, node[2]), self._number(number, node[3]))
        if what == "name":
            return self._named(number, node[2])
        if what == "part":
            return self._part(number, node)[1]
        return self._called(number, node[2], node[3])

    def _number(self, number: int, node) -> float:
        value = self._value(number, node)
        if type(value) is not float:
            raise RefusedError(f"line {number}: no number")
        return value

    def _both(self, number: int, sign: str, a: float, b: float):
        if sign == "/" and b == 0:
            raise RefusedError(f"line {number}: divided by 0")
        return {
            "<": lambda: a < b,
            ">": lambda: a > b,
            "=": lambda: a == b,
            "<=": lambda: a <= b,
            ">=": lambda: a >= b,
            "<>": lambda: a != b,
            "+": lambda: a + b,
            "-": lambda: a - b,
            "*": lambda: a * b,
            "/": lambda: a / b,
        }[sign]()

    def _named(self, number: int, name: str):
        if self.scopes and name in self.scopes[-1]:
            return self.scopes[-1][name]
        if name == "fine":
            return list(FINE)
        if name not in self.data or self.data[name][1] is None:
            raise RefusedError(f"line {number}: {name} has no value")
        return self.data[name][1]

    def _part(self, number: int, node) -> tuple[str, object]:
        """Return the type and the value of data, or of a field of the data."""
        if node[0] == "name":
            return self.data[node[2]][0] if node[2] in self.data else "", self._named(number, node[2])
        sort, value = self._part(number, node[2])
        k, sort = self._field(number, sort, node[3])
        return sort, value[k]

    def _called(self, number: int, name: str, arguments: list):
        if name == "crobt":
            return self._crobt(number, dict(arguments))
        routine = self.routines.get(name)
        given = [self._value(number, value) for its, value in arguments if not its]
        if routine is None or len(given) != len(arguments) or len(given) != len(routine.parameters):
            raise RefusedError(f"line {number}: {name} of other parameters")
        for value, (sort, _) in zip(given, routine.parameters, strict=True):
            if not _fits(value, sort):
                raise RefusedError(f"line {number}: {name} of no {sort}")
        if len(self.scopes) > 20:
            raise RefusedError(f"line {number}: calls without end")
        names = [its for _, its in routine.parameters]
        self.scopes.append(dict(zip(names, given, strict=True)))
        value = self._statements(routine.body)
        self.scopes.pop()
        if not _fits(value, routine.returns):
            raise RefusedError(f"line {number}: {name} returns no {routine.returns}")
        return value

    def _crobt(self, number: int, options: dict) -> list:
        """Return the pose of the tool in the work object."""
        if set(options) - {"tool", "wobj"} or None in options.values():
            raise RefusedError(f"line {number}: CRobT of something else")
        if "tool" in options:
            self.tcp = _as_frame(number, self._option(number, options, "tool", "tooldata")[1])
        base = np.eye(4)
        if "wobj" in options:
            base = self._work_object(number, self._option(number, options, "wobj", "wobjdata"))
        seen = np.linalg.inv(base) @ self.believed()
        w, x, y, z = _quaternion(seen[:3, :3])
        return [seen[:3, 3].tolist(), [w, x, y, z], [0.0] * 4, [9e9] * 6]


def _quaternion(turned: np.ndarray) -> list[float]:
    """Return the quaternion of a rotation: the eigenvector of Bar-Itzhack's matrix."""
    m = turned
    k = np.array(
        [
            [m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2], m[2, 1] - m[1, 2]],
            [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
            [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]],
        ]
    )
    x, y, z, w = np.linalg.eigh(k)[1][:, -1].tolist()
    return [w, x, y, z]

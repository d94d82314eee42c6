"""Find every place in Python code where a fault can be planted."""

from __future__ import annotations

import ast
import copy
import re
from collections.abc import Iterator

from fault import NUMBER, Edit, Fault, another, one_line, place

COMPARISONS = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
ARITHMETIC = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.FloorDiv: ast.Div,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
}
IN_PLACE = {ast.Add: "-({})", ast.Sub: "-({})", ast.Mult: "1 / ({})", ast.Div: "1 / ({})"}
DEFAULTS = {"float": "0.0", "int": "0", "str": "''", "list": "[]", "dict": "{}", "set": "set()"}
NOT_NUMBERS = (ast.JoinedStr, ast.List, ast.ListComp, ast.Tuple, ast.Dict, ast.Set)
PURE = (
    ast.Name, ast.Attribute, ast.Constant, ast.Subscript, ast.Slice, ast.Tuple, ast.expr_context, ast.operator,
    ast.BinOp, ast.UnaryOp, ast.unaryop, ast.Compare, ast.cmpop, ast.BoolOp, ast.boolop,
)  # fmt: skip
PURE_CALLS = {"abs", "bool", "float", "int", "isinstance", "len", "max", "min", "round"}


def candidates(file: str, source: bytes, elsewhere: set[str]) -> list[Fault]:
    """Return all faults of a file.

    elsewhere holds names that other files use. Constants with these names stay unchanged.
    """
    return _File(file, source, elsewhere).faults


def names_in(source: bytes) -> set[str]:
    """Return all words of a file."""
    return set(re.findall(r"\w+", source.decode()))


def _pure(node: ast.AST) -> bool:
    """Return whether an expression may be evaluated twice."""
    if isinstance(node, ast.Call):
        known = isinstance(node.func, ast.Name) and node.func.id in PURE_CALLS
        return known and not node.keywords and all(map(_pure, node.args))
    return isinstance(node, PURE) and all(map(_pure, ast.iter_child_nodes(node)))


def _number(node: ast.AST) -> bool:
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        node = node.operand
    return isinstance(node, ast.Constant) and type(node.value) in (int, float)


def _text(node: ast.AST) -> bool:
    return isinstance(node, NOT_NUMBERS) or (isinstance(node, ast.Constant) and isinstance(node.value, str | bytes))


class _File:
    def __init__(self, file: str, source: bytes, elsewhere: set[str]):
        self.file, self.source = file, source
        self.starts = [0]
        for line in source.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.faults: list[Fault] = []
        self.uses: dict[str, list[ast.Name]] = {}
        tree = ast.parse(source)
        self._body(tree.body, False, None)
        self._constants(tree, elsewhere)

    def _span(self, node: ast.AST) -> tuple[int, int]:
        return (
            self.starts[node.lineno - 1] + node.col_offset,
            self.starts[node.end_lineno - 1] + node.end_col_offset,
        )

    def _segment(self, node: ast.AST) -> str:
        begin, end = self._span(node)
        return self.source[begin:end].decode()

    def _add(self, kind: str, node: ast.AST, mutated: str, twice: bool = False, shown: str = "{}") -> None:
        """Add a fault.

        twice: both forms may be evaluated to see whether they differ. shown is the text around the node.
        """
        begin, end = self._span(node)
        original = self._segment(node)
        also = f", lambda: ({ast.unparse(node)}), lambda: ({mutated})" if twice else ""
        text = f"(({mutated}) if __fault__({NUMBER}{also}) else ({original}))"
        edit = Edit(begin, end, text)
        change = [shown.format(one_line(text)) for text in (original, mutated)]
        self.faults.append(Fault(self.file, *place(self.source, begin), kind, *change, [[edit]]))

    # The visitor walks code that runs when a function is called, and skips code that runs on import.

    def _body(self, nodes: list[ast.stmt], inside: bool, returns: ast.expr | None) -> None:
        for node in nodes:
            self._visit(node, inside, returns)

    def _visit(self, node: ast.AST, inside: bool, returns: ast.expr | None) -> None:
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            makes = any(isinstance(each, ast.Yield | ast.YieldFrom) for each in ast.walk(node))
            self._body(node.body, True, None if makes else node.returns)
            return
        if isinstance(node, ast.ClassDef):
            self._body(node.body, inside, returns)
            return
        if isinstance(node, ast.JoinedStr | ast.Assert | ast.pattern):
            return
        if inside:
            self._mutate(node, returns)
        for child in self._children(node):
            self._visit(child, inside, None if isinstance(node, ast.Lambda) else returns)

    def _children(self, node: ast.AST) -> Iterator[ast.AST]:
        if isinstance(node, ast.AnnAssign):
            return iter([node.target, *([node.value] if node.value else [])])
        if isinstance(node, ast.Lambda):
            return iter([node.body])
        return ast.iter_child_nodes(node)

    def _mutate(self, node: ast.AST, returns: ast.expr | None) -> None:
        match node:
            case ast.Name(ctx=ast.Load()):
                self.uses.setdefault(node.id, []).append(node)
            case ast.Compare():
                for at, op in enumerate(node.ops):
                    other = copy.deepcopy(node)
                    other.ops[at] = COMPARISONS[type(op)]()
                    self._add("comparison", node, ast.unparse(other), _pure(node))
            case ast.BoolOp():
                other = copy.deepcopy(node)
                other.op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
                self._add("boolean", node, ast.unparse(other), _pure(node))
            case ast.BinOp() if type(node.op) in ARITHMETIC and not (_text(node.left) or _text(node.right)):
                other = copy.deepcopy(node)
                other.op = ARITHMETIC[type(node.op)]()
                self._add("arithmetic", node, ast.unparse(other))
            case ast.AugAssign() if type(node.op) in IN_PLACE and not _text(node.value):
                place, _, _ = ast.unparse(node).partition("= ")
                other = IN_PLACE[type(node.op)].format(ast.unparse(node.value))
                self._add("arithmetic", node.value, other, shown=place.replace("{", "{{") + "= {}")
            case ast.Constant() if _number(node):
                if other := another(repr(node.value)):
                    self._add("number", node, other)
            case ast.If() | ast.While() | ast.IfExp():
                self._add("condition", node.test, f"not ({ast.unparse(node.test)})")
            case ast.comprehension():
                for test in node.ifs:
                    self._add("condition", test, f"not ({ast.unparse(test)})")
            case ast.Expr(value=ast.Call()):
                self._add("call removed", node.value, "None")
            case ast.Return() if node.value is not None and returns is not None:
                self._returned(node.value, ast.unparse(returns))

    def _returned(self, value: ast.expr, declared: str) -> None:
        if declared == "bool":
            default = f"not ({ast.unparse(value)})"
        elif declared.endswith("| None"):
            default = "None"
        else:
            default = DEFAULTS.get(declared.split("[")[0], "")
        if default and ast.unparse(value) != default:
            self._add("return value", value, default)

    def _constants(self, tree: ast.Module, elsewhere: set[str]) -> None:
        """Change constants of the module that only its functions use."""
        functions = {id(each) for uses in self.uses.values() for each in uses}
        outside = {
            each.id
            for each in ast.walk(tree)
            if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Load) and id(each) not in functions
        }
        for node in tree.body:
            match node:
                case ast.Assign(targets=[ast.Name(id=name)], value=value) if _number(value):
                    uses = self.uses.get(name, [])
                    other = another(ast.unparse(value))
                    if not uses or not other or name in elsewhere or name in outside:
                        continue
                    where = place(self.source, self._span(node)[0])
                    edits = [Edit(*self._span(use), f"({other} if __fault__({NUMBER}) else {name})") for use in uses]
                    original = f"{name} = {self._segment(value)}"
                    self.faults.append(Fault(self.file, *where, "constant", original, f"{name} = {other}", [edits]))

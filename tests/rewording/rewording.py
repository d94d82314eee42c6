"""Other words for all that people read: which tests fail with these depend on wording.

Words get a letter in their middle. Numbers, directions, names in quotes, options, files, codes and what stands for a
value stay. So do the lines of programs: they are a format that `check` reads, and tests/golden has them.
"""

import ast
import re

# plain words; with what joins them to a name, a number or a placeholder they are none
WORD = re.compile(
    r"""(?<![\w\-./\\=<>@#$%&'"`{\[:])(?:[a-z]{4,}|(?:(?<=\A)|(?<=\n)|(?<=[.:] )|(?<=\())[A-Z][a-z]{3,})"""
    r"""(?![\w\-/\\=<>@'"`}(\[\x00]|[.:]\w)"""
)
KEPT = re.compile(r"""(?<!\w)'[^']*'|"[^"]*"|`[^`]*`|\{[^}]*\}|%\([^)]*\)|brushsvg( [a-z]+)+|-m pip [a-z]+.*|  .*""")
NO_SENTENCE = re.compile(  # addresses, markup, programs, patterns, lines of a header, names of faults
    r"://|</?[a-z]|=>|;\n|[{}];|\)\s*\{|\\[sdwb]|\w\(\w*\)| = |^order: | in [xy]$"
)
PROGRAMS = re.compile(r"machine/(posts/|header_lines|program|setup_programs)|verify/readback/|jobs/outputs")
SAID = {
    "Error",
    "Notice",
    "lacking",
    "need",
    "need_number",
    "need_one_of",
    "need_truth",
    "refuse",
}  # also in those
SENTENCE = re.compile(r"(?<![\w\-./=])[A-Za-z]?[a-z]{2,}[,:;]? (?:[a-z]{2,}|.* [a-z]{3,})(?![\w\-/=])", re.DOTALL)


DIRECTIONS = {"left", "right", "upper", "lower", "clockwise"}


def is_sentence(text: str) -> bool:
    return SENTENCE.search(text) is not None and NO_SENTENCE.search(text) is None


def reworded(text: str) -> str:
    kept = [each.span() for each in KEPT.finditer(text)]

    def other(found: re.Match) -> str:
        word = found[0]
        if word in DIRECTIONS or any(start <= found.start() < end for start, end in kept):
            return word
        middle = len(word) // 2
        return f"{word[:middle]}q{word[middle:]}"

    return WORD.sub(other, text)


class Reworder(ast.NodeTransformer):
    """Rewords the sentences of a module; what is compared, looked up or split is no sentence. everything: not only
    those of refusals and notices; lists: names of texts that are split."""

    def __init__(self, everything: bool, lists: set[str]):
        self.everything, self.lists = everything, lists

    def visit(self, node: ast.AST) -> ast.AST:
        return node if isinstance(node, ast.Compare | ast.Subscript | ast.Set | ast.MatchValue) else super().visit(node)

    def visit_Constant(self, node: ast.Constant) -> ast.Constant:
        if self.everything and isinstance(node.value, str) and is_sentence(node.value):
            node.value = reworded(node.value)
        return node

    def visit_JoinedStr(self, node: ast.JoinedStr) -> ast.JoinedStr:
        texts = [part.value if isinstance(part, ast.Constant) else "\0" for part in node.values]
        if self.everything and is_sentence("".join(texts).replace("\0", "x1")):
            parts = reworded("".join(texts)).split("\0")
            assert len(parts) == texts.count("\0") + 1
            found = iter(parts)
            last = next(found)
            values = []
            for part in node.values:
                if isinstance(part, ast.Constant):
                    continue
                values += [ast.Constant(last)] if last else []
                values.append(part)
                last = next(found)
            values += [ast.Constant(last)] if last else []
            for value in values:
                ast.copy_location(value, node)
            node.values = values
        for part in node.values:
            if isinstance(part, ast.FormattedValue):
                part.value = self.visit(part.value)
        return node

    def visit_Expr(self, node: ast.Expr) -> ast.AST:
        return node if isinstance(node.value, ast.Constant) else self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        called = node.func
        if isinstance(called, ast.Attribute):
            if isinstance(called.value, ast.Name) and called.value.id == "re":
                return node
            if called.attr in (
                "split",
                "startswith",
                "endswith",
                "get",
                "find",
                "removeprefix",
                "removesuffix",
            ):
                return node
        return self._wholly(node, isinstance(called, ast.Name) and called.id in SAID)

    def visit_Assign(self, node: ast.Assign) -> ast.AST:
        if isinstance(node.targets[0], ast.Name) and node.targets[0].id in self.lists:
            return node
        return self._wholly(
            node, isinstance(node.targets[0], ast.Name) and node.targets[0].id in ("sentence", "advice")
        )

    def _wholly(self, node: ast.AST, is_said: bool) -> ast.AST:
        before, self.everything = self.everything, self.everything or is_said
        node = self.generic_visit(node)
        self.everything = before
        return node

    def visit_keyword(self, node: ast.keyword) -> ast.keyword:
        return node if node.arg == "loc" else self.generic_visit(node)  # a place, to matplotlib

    def visit_Dict(self, node: ast.Dict) -> ast.Dict:
        node.values = [self.visit(value) for value in node.values]
        return node

    def visit_AnnAssign(self, node: ast.AnnAssign) -> ast.AnnAssign:
        node.value = node.value and self.visit(node.value)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        node.body = [self.visit(each) for each in node.body]
        return node


def reworded_module(source: str | bytes, path: str) -> ast.Module:
    module = ast.parse(source, path)
    split = (each.value for each in ast.walk(module) if isinstance(each, ast.Attribute) and each.attr == "split")
    lists = {name.id for each in split for name in ast.walk(each) if isinstance(name, ast.Name)}
    return ast.fix_missing_locations(Reworder(PROGRAMS.search(path) is None, lists).visit(module))

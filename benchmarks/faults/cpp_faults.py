"""Find every place in C++ code where a fault can be planted.

This needs tree-sitter and tree-sitter-cpp, which the project itself does not need: pip install tree-sitter
tree-sitter-cpp
"""

from __future__ import annotations

import re

import tree_sitter_cpp
from fault import NUMBER, Edit, Fault, another, one_line, place
from tree_sitter import Language, Node, Parser

COMPARISONS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*"}
BOOLEAN = {"&&": "||", "||": "&&"}
# Code that the compiler must know, and text that is not code.
SKIPPED = {
    "template_argument_list", "static_assert_declaration", "array_declarator", "enumerator_list", "preproc_if",
    "preproc_def", "preproc_call", "parameter_list", "noexcept", "type_descriptor", "field_initializer_list",
}  # fmt: skip
PURE_CALLS = {
    "size", "empty", "x", "y", "z", "norm", "squaredNorm", "dot", "front", "back", "rows", "cols", "begin", "end",
    "abs", "fabs", "hypot", "sqrt", "isfinite", "isnan", "min", "max", "has_value", "cos", "sin", "value_of",
}  # fmt: skip
PARSER = Parser(Language(tree_sitter_cpp.language()))


def candidates(file: str, source: bytes) -> list[Fault]:
    """Return all faults of a file."""
    return _File(file, source).faults


def _pure(text: str) -> bool:
    """Return whether an expression may be evaluated twice."""
    if re.search(r"\+\+|--|(?<![=!<>])=(?!=)|[{};\[]\s*[&=]", text):
        return False
    return all(name in PURE_CALLS for name in re.findall(r"(\w+)\s*\(", text))


class _File:
    def __init__(self, file: str, source: bytes):
        self.file, self.source = file, source
        self.faults: list[Fault] = []
        self.uses: dict[str, list[Node]] = {}
        self.constants: list[tuple[Node, Node]] = []  # names and values
        self._visit(PARSER.parse(source).root_node, False)
        if file.endswith(".cpp"):  # other files also know the constants of a header
            self._constants()

    def _text(self, node: Node) -> str:
        return self.source[node.start_byte : node.end_byte].decode()

    def _add(self, kind: str, node: Node, mutated: str, *texts: str, original: str | None = None) -> None:
        """Add a fault. texts hold the node with the switch, one for each way to write it."""
        original = original or self._text(node)
        if any(mark in original for mark in ("//", "#", "/*")):
            return
        variants = [[Edit(node.start_byte, node.end_byte, text)] for text in texts]
        change = one_line(original), one_line(mutated)
        self.faults.append(Fault(self.file, *place(self.source, node.start_byte), kind, *change, variants))

    def _visit(self, node: Node, inside: bool) -> None:
        if node.type in SKIPPED:
            return
        if node.type in ("declaration", "field_declaration") and any(
            self._text(each) == "constexpr" for each in node.children
        ):
            if not inside and node.type == "declaration":
                self._declared(node)
            return
        if node.type == "function_definition":
            body = node.child_by_field_name("body")
            # Bindings run once, on import, except for their lambdas.
            binds = "bindings/" in self.file and re.match(r"\w+ bind_?\w*\(", self._text(node))
            if body:
                self._visit(body, not binds)
            return
        if node.type == "lambda_expression":
            inside = True
        if inside:
            self._mutate(node)
        for child in node.named_children:
            if node.type == "case_statement" and child == node.child_by_field_name("value"):
                continue
            self._visit(child, inside)

    def _mutate(self, node: Node) -> None:
        text = self._text(node)
        match node.type:
            case "identifier":
                self.uses.setdefault(text, []).append(node)
            case "binary_expression":
                self._operator(node)
            case "number_literal":
                self._number(node)
            case "if_statement" | "conditional_expression" | "while_statement":
                test = node.child_by_field_name("condition")
                if test is not None and test.type == "condition_clause":
                    test = test.child_by_field_name("value") if len(test.named_children) == 1 else None
                if test is not None and "declaration" not in test.type:
                    inner = self._text(test)
                    self._add(
                        "condition",
                        test,
                        f"!({inner})",
                        f"(brushsvg_faults::fault({NUMBER}) != static_cast<bool>({inner}))",
                    )
            case "expression_statement" if node.named_children and node.named_children[0].type == "call_expression":
                self._add("call removed", node, ";", f"{{ if (!brushsvg_faults::fault({NUMBER})) {text} }}")
            case "return_statement" if node.named_children and text not in ("return {};", "return false;"):
                if text == "return true;" or self._text(node.named_children[0]).startswith("!"):
                    return  # a condition, or equivalent to one
                self._add(
                    "return value",
                    node,
                    "return {};",
                    f"{{ if (brushsvg_faults::fault({NUMBER})) return {{}}; {text} }}",
                )

    def _operator(self, node: Node) -> None:
        left, right = node.child_by_field_name("left"), node.child_by_field_name("right")
        operator = self._text(node.child_by_field_name("operator"))
        if any(each.type in ("string_literal", "concatenated_string") for each in (left, right)):
            return
        if re.search(r"\bto_string\b|\bstring\b|\btext\b", self._text(node)) and operator == "+":
            return
        for kind, table in (("comparison", COMPARISONS), ("arithmetic", ARITHMETIC), ("boolean", BOOLEAN)):
            if operator not in table:
                continue
            original = self._text(node)
            mutated = f"({one_line(self._text(left))}) {table[operator]} ({one_line(self._text(right))})"
            shown = f"{self._text(left)} {table[operator]} {self._text(right)}"
            texts = [f"(brushsvg_faults::fault({NUMBER}) ? ({mutated}) : ({original}))"]
            plain = re.fullmatch(r"[\w\s.!<>=&|+-]+", original)  # the other form of a boolean may read a missing value
            if (kind == "comparison" and _pure(original)) or (kind == "boolean" and plain):
                both = f"[&] {{ return {one_line(original)}; }}, [&] {{ return {mutated}; }}"
                texts.insert(0, f"(brushsvg_faults::fault({NUMBER}, {both}) ? ({mutated}) : ({original}))")
            if operator in "+-":  # `?:` cannot choose between two types of Eigen
                sign = f"(brushsvg_faults::fault({NUMBER}) ? -1.0 : 1.0)"
                texts.append(f"({self._text(left)} {operator} {sign} * ({self._text(right)}))")
            self._add(kind, node, shown, *texts)

    def _number(self, node: Node) -> None:
        text = self._text(node)
        digits = re.fullmatch(r"([0-9][0-9.']*(?:e[-+]?[0-9]+)?)([uUlLfF]*)", text)
        other = digits and another(digits[1].replace("'", ""))
        if other:
            other += digits[2]
            self._add("number", node, other, f"(brushsvg_faults::fault({NUMBER}) ? {other} : {text})")

    def _declared(self, node: Node) -> None:
        for each in node.named_children:
            if each.type != "init_declarator":
                continue
            name, value = each.child_by_field_name("declarator"), each.child_by_field_name("value")
            if name.type == "identifier" and value is not None and value.type == "number_literal":
                self.constants.append((name, value))

    def _constants(self) -> None:
        """Change constants of the file where its functions use them."""
        for name, value in self.constants:
            word, number = self._text(name), self._text(value)
            other = another(number.replace("'", ""))
            uses = self.uses.get(word, [])
            if not other or not uses:
                continue
            where = place(self.source, name.start_byte)
            edits = [
                Edit(use.start_byte, use.end_byte, f"(brushsvg_faults::fault({NUMBER}) ? {other} : {word})")
                for use in uses
            ]
            self.faults.append(Fault(self.file, *where, "constant", f"{word} = {number}", f"{word} = {other}", [edits]))

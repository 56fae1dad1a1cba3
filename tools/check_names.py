#!/usr/bin/env python3
"""Checks that a name is defined once in the tree: the linker does not tell two types of one name apart, nor two functions
or variables of one name in headers ("one definition rule" of C++), and a program that has both is undefined.

Types, functions and variables that other sources see have one definition each. A type or function that only its source sees
(in an unnamed namespace) does not have the name of one that others see, and is the only one of its name in its folder, whose
sources may be compiled together (cmake/victorious.cmake). The check reads the text before the preprocessor: what is defined
in namespaces, not in classes or functions. Overloads are other functions. "using A = B" twice with the same B is one type.

Usage: check_names.py [ROOT]
Prints one line per finding, "path:line: problem: remedy"; exits with 1 if there is any.
"""

import re
import sys
from collections import defaultdict
from pathlib import Path
from typing import Iterator, NamedTuple

import findings
from findings import Finding

CODE_FOLDERS = ("src", "experiments", "assets/make", "testing", "tests", "bench", "examples")
CODE_ENDINGS = (".h", ".cc", ".cu")
# Functions that each program defines for itself.
OF_EACH_PROGRAM = ("main", "LLVMFuzzerTestOneInput", "FuzzSeeds")
# Pairs of sources of which CMake compiles one.
CHOSEN_SOURCES = ({"nearest_cuda.cu", "nearest_no_cuda.cc"},)

TOKEN = re.compile(
    r"""
      (?P<skip>\s+|//[^\n]*|/\*.*?\*/|\[\[.*?\]\])
    | (?P<directive>^[ \t]*\#(?:[^\n\\]|\\.)*)
    | (?P<text>(?:u8|[uUL])?R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"|(?:u8|[uUL])?"(?:[^"\\\n]|\\.)*")
    | (?P<number>\.?\d(?:'?[\w.]|(?<=[eEpP])[+-])*)
    | (?P<character>(?:u8|[uUL])?'(?:[^'\\\n]|\\.)+')
    | (?P<name>[A-Za-z_]\w*)
    | (?P<sign>::|->|.)
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
OPENING = {"(": ")", "{": "}", "[": "]"}
CLOSING = frozenset(OPENING.values())
TYPE_KEYWORDS = ("struct", "class", "union", "enum")
BASIC_TYPES = ("int", "char", "bool", "float", "double", "long", "short", "unsigned", "signed", "const", "auto")
WORD = re.compile(r"\w")
SPECIFIERS = ("inline", "constexpr", "consteval", "constinit", "static", "extern", "explicit", "virtual", "thread_local")


class Token(NamedTuple):
    text: str
    line: int  # from 1


class Definition(NamedTuple):
    kind: str  # "type", "function" or "variable"
    name: str  # with its namespaces, without unnamed ones; a function's with the types of its parameters
    is_internal: bool  # other sources do not see it: in an unnamed namespace, static, or another name of a type in a .cc
    path: Path
    line: int
    target: str = ""  # of another name of a type ("using A = target")

    @property
    def place(self) -> str:
        return f"{self.path.as_posix()}:{self.line}"


def tokens_of(text: str) -> list[Token]:
    """The tokens of a source, without comments, attributes and preprocessor directives; a text literal is '""'."""
    tokens, line = [], 1
    for match in TOKEN.finditer(text):
        if match.lastgroup not in ("skip", "directive"):
            tokens.append(Token('""' if match["text"] else match[0], line))
        line += match[0].count("\n")
    return tokens


def past_block(tokens: list[Token], at: int) -> int:
    """The index after the bracket that closes the one at `at`."""
    depth = 0
    while at < len(tokens):
        if tokens[at].text in OPENING:
            depth += 1
        elif tokens[at].text in CLOSING:
            depth -= 1
            if depth == 0:
                return at + 1
        at += 1
    return at


def past_angles(tokens: list[Token], at: int) -> int:
    """The index after the ">" of the "<" at `at`; brackets within are skipped."""
    depth = 0
    while at < len(tokens):
        text = tokens[at].text
        if text in OPENING:
            at = past_block(tokens, at)
            continue
        depth += {"<": 1, ">": -1}.get(text, 0)
        at += 1
        if depth == 0:
            return at
    return at


def parameter_types(tokens: list[Token]) -> str:
    """The types of a parameter list without its brackets: no names of parameters, no defaults."""
    parameters, current, at, has_default = [], [], 0, False
    while at < len(tokens):
        text = tokens[at].text
        end = at + 1
        if text in OPENING:
            end = past_block(tokens, at)
        elif text == "<":
            end = past_angles(tokens, at)
        if text == ",":
            parameters.append(current)
            current, has_default = [], False
        elif text == "=":
            has_default = True
        elif not has_default:
            current.extend(token.text for token in tokens[at:end])
        at = end
    if current:
        parameters.append(current)
    return ", ".join(filter(None, (type_of(parameter) for parameter in parameters)))


def type_of(words: list[str]) -> str:
    """The type of a parameter: its last word is a name if a type stands before it."""
    types = [word for word in words if WORD.match(word) and word not in ("const", "volatile", *TYPE_KEYWORDS)]
    if len(types) > 1 and WORD.match(words[-1]) and words[-2] != "::" and words[-1] not in BASIC_TYPES:
        words = words[:-1]
    text = joined(words)
    return "" if text == "void" else text


def joined(words: list[str]) -> str:
    """The words with a space only between two names."""
    text = ""
    for word in words:
        text += " " + word if text and WORD.match(word) and WORD.match(text[-1]) else word
    return text


class Reader:
    """Reads the definitions at the level of namespaces from one source."""

    def __init__(self, text: str, path: Path):
        self.tokens = tokens_of(text)
        self.path = path
        self.found: list[Definition] = []

    def read(self) -> list[Definition]:
        self.read_scope(0, (), False)
        return self.found

    def read_scope(self, at: int, namespaces: tuple[str, ...], is_internal: bool) -> int:
        """Reads from `at` to the brace that closes the scope, and returns the index after it."""
        while at < len(self.tokens):
            if self.tokens[at].text == "}":
                return at + 1
            at = self.read_statement(at, namespaces, is_internal)
        return at

    def read_statement(self, at: int, namespaces: tuple[str, ...], is_internal: bool) -> int:
        at = self.past_templates(at)
        texts = [token.text for token in self.tokens[at : at + 3]]
        if texts[:1] == ["namespace"] or texts[:2] == ["inline", "namespace"]:
            return self.read_namespace(at, namespaces, is_internal)
        if texts == ["extern", '""', "{"]:
            return self.read_scope(at + 3, namespaces, is_internal)
        if texts[:1] == ["using"]:
            end = self.past_statement(at)
            if len(texts) > 2 and texts[2] == "=":
                target = joined([token.text for token in self.tokens[at + 3 : end - 1]])
                is_hidden = is_internal or self.path.suffix != ".h"
                self.add("type", namespaces, texts[1], is_hidden, self.tokens[at + 1].line, target)
            return end
        if texts[:1] in (["typedef"], ["static_assert"], ["friend"]):
            return self.past_statement(at)
        if texts[:1] and texts[0] in TYPE_KEYWORDS:
            return self.read_type(at, namespaces, is_internal)
        return self.read_declaration(at, namespaces, is_internal)

    def past_templates(self, at: int) -> int:
        while self.text(at) == "template" and self.text(at + 1) == "<":
            at = past_angles(self.tokens, at + 1)
            if self.text(at) == "requires":  # requires (...), or requires Concept<T>
                at += 1
                while self.text(at + 1) == "::":
                    at += 2
                at = past_block(self.tokens, at) if self.text(at) == "(" else past_angles(self.tokens, at + 1)
        return at

    def text(self, at: int) -> str:
        return self.tokens[at].text if at < len(self.tokens) else ""

    def past_statement(self, at: int) -> int:
        """The index after the next ";" outside brackets."""
        while at < len(self.tokens) and self.text(at) != ";":
            at = past_block(self.tokens, at) if self.text(at) in OPENING else at + 1
        return at + 1

    def read_namespace(self, at: int, namespaces: tuple[str, ...], is_internal: bool) -> int:
        at += 2 if self.text(at) == "inline" else 1
        names = []
        while self.text(at) not in ("{", "="):
            if self.text(at) != "::":
                names.append(self.text(at))
            at += 1
        if self.text(at) == "=":  # an alias
            return self.past_statement(at)
        return self.read_scope(at + 1, namespaces + tuple(names), is_internal or not names)

    def read_type(self, at: int, namespaces: tuple[str, ...], is_internal: bool) -> int:
        """A type, or what begins as one: a declaration, or a variable of a type that stands in full."""
        start = at
        at += 2 if self.text(at + 1) in ("class", "struct") else 1
        if self.text(at) == "alignas":
            at = past_block(self.tokens, at + 1)
        name, line = "", self.tokens[min(at, len(self.tokens) - 1)].line
        while self.text(at) not in ("{", ";", ":", "(", "="):
            if self.text(at) == "<":
                end = past_angles(self.tokens, at)
                name += "".join(token.text for token in self.tokens[at:end])
                at = end
            elif self.text(at) == "final":
                at += 1
            elif re.match(r"[A-Za-z_]", self.text(at)) and name and not name.endswith("::"):
                return self.read_declaration(start, namespaces, is_internal)  # struct Type Function(
            else:
                name += self.text(at)
                at += 1
        if self.text(at) in ("(", "="):
            return self.read_declaration(start, namespaces, is_internal)
        while self.text(at) not in ("{", ";"):
            at = past_angles(self.tokens, at) if self.text(at) == "<" else at + 1
        if self.text(at) == "{":
            if name:
                self.add("type", namespaces, name, is_internal, line)
            at = past_block(self.tokens, at)
        return self.past_statement(at)

    def read_declaration(self, at: int, namespaces: tuple[str, ...], is_internal: bool) -> int:
        """A function or a variable."""
        specifiers, name, line, size = set(), "", self.tokens[at].line, 0
        while at < len(self.tokens):
            text = self.text(at)
            if text == "operator":
                line, name = self.tokens[at].line, self.qualified(at)
                at += 1
                while self.text(at) != "(" or (self.text(at - 1) == "operator"):
                    name += self.text(at)
                    at += 2 if self.text(at) == "(" else 1
                return self.read_function(at, namespaces, name, is_internal or "static" in specifiers, line)
            if text == "<":
                at = past_angles(self.tokens, at)
            elif text in (";", "=", "{", "["):
                is_constant = "const" in specifiers or "constexpr" in specifiers
                is_hidden = "static" in specifiers or is_constant and not {"inline", "extern"} & specifiers
                is_defined = text != ";" or "extern" not in specifiers
                if name and size > 1 and is_defined:
                    self.add("variable", namespaces, name, is_internal or is_hidden, line)
                return self.past_statement(at)
            elif text == "(":
                if name in ("decltype", "alignas", "__attribute__", "noexcept", "declspec"):
                    at = past_block(self.tokens, at)
                elif size < 2 and "::" not in name:  # TEST(A, B) { } and other macros
                    at = past_block(self.tokens, at)
                    if self.text(at) == "{":
                        return past_block(self.tokens, at)
                    if self.text(at) == ";":
                        return at + 1
                    size = 0
                else:
                    return self.read_function(at, namespaces, name, is_internal or "static" in specifiers, line)
            else:
                if re.match(r"[A-Za-z_]", text):
                    if text in SPECIFIERS or text == "const":
                        specifiers.add(text)
                    else:
                        if self.text(at - 1) != "::":
                            size += 1
                        line, name = self.tokens[at].line, self.qualified(at)
                elif text == "*":
                    specifiers.discard("const")  # of what is pointed to
                at += 1
        return at

    def qualified(self, at: int) -> str:
        """The name whose last part stands at `at`, with the classes before it: Class::Function."""
        name = self.text(at)
        if self.text(at - 1) == "~":
            at, name = at - 1, "~" + name
        while self.text(at - 1) == "::":
            if self.text(at - 2) == ">":
                depth, end = 0, at - 1
                at -= 2
                while at >= 0:
                    depth += {">": 1, "<": -1}.get(self.text(at), 0)
                    if depth == 0:
                        break
                    at -= 1
                at -= 1
                name = "".join(token.text for token in self.tokens[at:end]) + "::" + name
            elif re.match(r"\w", self.text(at - 2)):
                at -= 2
                name = self.text(at) + "::" + name
            else:
                break
        return name

    def read_function(self, at: int, namespaces: tuple[str, ...], name: str, is_internal: bool, line: int) -> int:
        """From the "(" of the parameters."""
        end = past_block(self.tokens, at)
        types = parameter_types(self.tokens[at + 1 : end - 1])
        at = end
        suffix = ""
        while at < len(self.tokens):
            text = self.text(at)
            if text == "const":
                suffix = " const"
            if text == ";":
                return at + 1
            if text == "=":  # = default, = 0; or a variable with a function's type
                if self.text(at + 1) in ("default",):
                    self.add("function", namespaces, f"{name}({types}){suffix}", is_internal, line)
                return self.past_statement(at)
            if text == ":":
                at = self.past_initialisers(at + 1)
                continue
            if text == "{":
                self.add("function", namespaces, f"{name}({types}){suffix}", is_internal, line)
                return past_block(self.tokens, at)
            if text == "<":
                at = past_angles(self.tokens, at)
            elif text in OPENING:
                at = past_block(self.tokens, at)
            else:
                at += 1
        return at

    def past_initialisers(self, at: int) -> int:
        """The index of the body after the initialisers of a constructor."""
        while at < len(self.tokens):
            while self.text(at) not in ("(", "{", "<"):
                at += 1
            if self.text(at) == "<":
                at = past_angles(self.tokens, at)
            at = past_block(self.tokens, at)
            if self.text(at) == ".":  # a pack
                at += 3
            if self.text(at) != ",":
                return at
            at += 1
        return at

    def add(
        self, kind: str, namespaces: tuple[str, ...], name: str, is_internal: bool, line: int, target: str = ""
    ) -> None:
        self.found.append(Definition(kind, "::".join((*namespaces, name)), is_internal, self.path, line, target))


def definitions_of(text: str, path: Path) -> list[Definition]:
    return Reader(text, path).read()


def are_alternatives(a: Definition, b: Definition) -> bool:
    """Whether one program never has both, or has both as one: of one file (#if), another name of the same type, or one of
    two sources that CMake chooses from."""
    return a.path == b.path or bool(a.target) and a.target == b.target or {a.path.name, b.path.name} in CHOSEN_SOURCES


def findings_of(definitions: list[Definition]) -> Iterator[Finding]:
    by_name = defaultdict(list)
    for definition in definitions:
        if definition.name.split("(")[0] not in OF_EACH_PROGRAM:
            by_name[definition.name].append(definition)
    for name, all_of_name in by_name.items():
        seen = [definition for definition in all_of_name if not definition.is_internal]
        for i, definition in enumerate(seen):
            if other := next((other for other in seen[:i] if not are_alternatives(definition, other)), None):
                problem = f"{definition.kind} {name} is also defined in {other.place}"
                yield Finding(definition.path, definition.line, f"{problem}: rename one, or share one definition")
        hidden = [definition for definition in all_of_name if definition.is_internal and definition.kind != "variable"]
        for i, definition in enumerate(hidden):
            if other := next((other for other in seen if not are_alternatives(definition, other)), None):
                problem = f"{definition.kind} {name} has the name of the {other.kind} in {other.place}"
                yield Finding(definition.path, definition.line, f"{problem}: rename it, or use that one")
            elif other := next((other for other in hidden[:i] if collide_in_folder(definition, other)), None):
                problem = f"{definition.kind} {name} is also defined in {other.place}, of the same folder"
                yield Finding(definition.path, definition.line, f"{problem}: rename one, or share one definition")


def collide_in_folder(a: Definition, b: Definition) -> bool:
    """Of functions, only those that may be compiled in one batch collide: the sources of a library."""
    is_in_batch = a.path.parts[0] == "src" and not any(one.path.stem.endswith("_test") for one in (a, b))
    is_alias = bool(a.target or b.target)
    return a.path.parent == b.path.parent and not is_alias and (a.kind == "type" or is_in_batch) and not are_alternatives(a, b)


def check(root: Path) -> list[Finding]:
    definitions = [
        definition
        for folder in CODE_FOLDERS
        for path in sorted((root / folder).rglob("*"))
        if path.suffix in CODE_ENDINGS
        for definition in definitions_of(path.read_text(encoding="utf-8"), path.relative_to(root))
    ]
    return sorted(findings_of(definitions))


def main(arguments: list[str]) -> int:
    return findings.run(check, arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

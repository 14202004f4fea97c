#!/usr/bin/env python3
"""bumpshadow.glsl: the functions of bumpshadow.h for shaders, made from it, so there is no second text to keep true.

    scripts/venv python -m scripts.glsl            write include/bumpshadow.glsl
    scripts/venv python -m scripts.glsl --check    exit status 1 where it is not what would be written

The header is parsed (pycparser) and written again with the types of GLSL. Comments stay where they are, and the
examples in them are written again, too. One text is right for GLSL ES 3.00, GLSL 3.30 and later, and Vulkan's GLSL
4.50. Where the languages differ:

- bs_real is float, bs_vec3 the built-in vec3, bs_bool is bool; cross, dot, sqrt and abs are built in, too. Three
  statements that do the same to x, y and z become one of vectors.
- Nothing is converted to float silently: 2 becomes 2.0 where a float is wanted, (bs_real)i becomes float(i).
- Conditions are bool: & and | of them become && and ||, x == 0 becomes !x, 0 and 1 become false and true.
- There is no infinity. What is as large as BS_INFINITY, 1e30, counts as infinite.
- {a, b} becomes the constructor of its type.

What the header may use is what this file knows; all else is an error with its line.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pycparser import c_ast  # type: ignore[import-untyped]
from pycparser.c_parser import CParser  # type: ignore[import-untyped]

TOP = Path(__file__).resolve().parent.parent
SOURCE, TARGET = TOP / "include/bumpshadow.h", TOP / "include/bumpshadow.glsl"
WIDTH = 120

HEAD = """\
/* bumpshadow.glsl: shadows of other objects on a bump-mapped surface.
 * SPDX-License-Identifier: MIT (the text is at the end)
 *
 * Made from bumpshadow.h by scripts/glsl.py: change that file, not this one. The formulas of K. Sumi and T. Noma, "A
 * Shadowing Method for Bump-Mapped Surfaces", and kage's additions (marked "ours"). For GLSL ES 3.00, GLSL 3.30 and
 * later, and Vulkan's GLSL 4.50; paste it below #version, or include it. It declares structs, functions and
 * BS_INFINITY, no uniform and no extension.
"""
GUARD = """
#ifndef BUMPSHADOW_GLSL
#define BUMPSHADOW_GLSL

#ifdef GL_ES
precision highp float;
precision highp int;
#endif

/* GLSL need not have infinities. What is as large counts as infinite: where P has no bounds, give -1e38 and 1e38. */
const float BS_INFINITY = 1e30;
"""
#: Where the header's own text begins that follows HEAD and GUARD.
HEAD_GOES_ON, BODY_BEGINS = " *\n * A ray r + s t meets", "typedef struct bs_vec3"

TYPES = {"bs_real": "float", "bs_vec3": "vec3", "bs_bool": "bool", "int": "int"}
BUILT_IN = {"bs_cross": "cross", "bs_dot": "dot", "BS_SQRT": "sqrt", "BS_ABS": "abs"}
#: The built-in functions' types: the result, the arguments.
SIGNATURES = {"cross": ("vec3", ["vec3", "vec3"]), "dot": ("float", ["vec3", "vec3"]), "sqrt": ("float", ["float"]),
              "abs": ("float", ["float"])}
#: What the examples in comments take for given.
GIVEN = """
bs_vec3 s, Qu, Qw, Quu, Quw, Qww, X, light, n, np; bs_real P, Pu, Pw, Pmin, Pmax, t0, t_hit, u, w, u0, w0, curvature;
bs_slab slab; bs_view v; int N; bs_real height(bs_real u, bs_real w);
"""
#: Words of GLSL, some kept for later, that C has not.
RESERVED = re.findall(r"\w+", """
    attribute uniform varying in out inout layout centroid flat smooth noperspective patch sample buffer shared
    coherent volatile restrict readonly writeonly subroutine precise invariant discard lowp mediump highp
    precision mat2 mat3 mat4 vec2 vec3 vec4 ivec2 bvec2 sampler2D common partition active asm class union
    template this resource goto inline noinline public external interface long short half fixed unsigned superp
    input output filter image1D image2D using namespace cast packed texture mix fract mod step sign floor cross
    dot sqrt abs
""")

PRECEDENCE = {"||": 1, "^^": 2, "&&": 3, "==": 5, "!=": 5, "<": 6, ">": 6, "<=": 6, ">=": 6, "+": 7, "-": 7, "*": 8,
              "/": 8, "%": 8}
CONDITIONAL, UNARY, WHOLE = 0, 9, 10


class CannotSayError(Exception):
    """What the header says, and this script can't say in GLSL."""

    def __init__(self, node: c_ast.Node, what: str) -> None:
        line = node.coord.line if node.coord else "?"
        super().__init__(f"{SOURCE.relative_to(TOP)}:{line}: {what}")


@dataclass
class Text:
    """An expression in GLSL, its type, and how tightly its outermost operator binds."""

    text: str
    type: str
    binds: int = WHOLE

    def within(self, binds: int) -> str:
        return self.text if self.binds >= binds else f"({self.text})"


@dataclass
class Known:
    """Types: of variables, of the fields of structs, of functions (the result, the arguments)."""

    variables: dict[str, str] = field(default_factory=dict)
    structs: dict[str, dict[str, str]] = field(default_factory=dict)
    functions: dict[str, tuple[str, list[str]]] = field(default_factory=lambda: dict(SIGNATURES))


def type_of(node: c_ast.Node) -> str:
    """The type of a declaration."""
    if isinstance(node, c_ast.TypeDecl | c_ast.Typename | c_ast.Decl | c_ast.FuncDecl):
        return type_of(node.type)
    if isinstance(node, c_ast.IdentifierType):
        (name,) = node.names
        if name in TYPES or name.startswith("bs_"):
            return TYPES.get(name, str(name))
    raise CannotSayError(node, "a type that is not bs_..., or int")


def named(node: c_ast.Node, name: str) -> str:
    if name in RESERVED:
        raise CannotSayError(node, f"the name '{name}', which GLSL keeps for itself")
    return name


# Expressions ----------------------------------------------------------------------------------------------------


class Expressions:
    """Writes expressions, given what is known."""

    def __init__(self, known: Known) -> None:
        self.known = known

    def write(self, node: c_ast.Node, wanted: str | None = None) -> Text:
        """`wanted`: the type that is needed there; None: whichever it has."""
        method = getattr(self, f"write_{type(node).__name__.lower()}", None)
        if not method:
            raise CannotSayError(node, f"a {type(node).__name__}")
        done: Text = method(node, wanted)
        if wanted and done.type != wanted:
            raise CannotSayError(node, f"a {done.type} where a {wanted} is wanted: {done.text}")
        return done

    def write_constant(self, node: c_ast.Constant, wanted: str | None) -> Text:
        if node.type != "int":
            return Text(node.value, "float")
        if wanted == "float":
            return Text(node.value + ".0", "float")
        if wanted == "bool" and node.value in "01":
            return Text("true" if node.value == "1" else "false", "bool")
        return Text(node.value, "int")

    def write_id(self, node: c_ast.ID, _wanted: str | None) -> Text:
        if node.name == "INFINITY":
            return Text("BS_INFINITY", "float")
        if node.name not in self.known.variables:
            raise CannotSayError(node, f"the unknown name '{node.name}'")
        return Text(node.name, self.known.variables[node.name])

    def write_structref(self, node: c_ast.StructRef, _wanted: str | None) -> Text:
        base = self.write(node.name)
        if base.type == "vec3":
            return Text(f"{base.within(WHOLE)}.{node.field.name}", "float")
        fields = self.known.structs.get(base.type, {})
        if node.field.name not in fields:
            raise CannotSayError(node, f"the unknown field '{node.field.name}' of {base.type}")
        return Text(f"{base.within(WHOLE)}.{node.field.name}", fields[node.field.name])

    def write_funccall(self, node: c_ast.FuncCall, _wanted: str | None) -> Text:
        name = BUILT_IN.get(node.name.name, node.name.name)
        if name not in self.known.functions:
            raise CannotSayError(node, f"the unknown function '{name}'")
        result, wanted = self.known.functions[name]
        arguments = [self.write(a, w).text for a, w in zip(node.args.exprs, wanted, strict=True)]
        return Text(f"{name}({', '.join(arguments)})", result)

    def write_cast(self, node: c_ast.Cast, _wanted: str | None) -> Text:
        to = type_of(node.to_type)
        inner = self.write(node.expr, to if isinstance(node.expr, c_ast.Constant | c_ast.UnaryOp) else None)
        return inner if inner.type == to else Text(f"{to}({inner.text})", to)

    def write_unaryop(self, node: c_ast.UnaryOp, wanted: str | None) -> Text:
        if node.op not in "-!":
            raise CannotSayError(node, f"the operator {node.op}")
        inner = self.write(node.expr, "bool" if node.op == "!" else wanted)
        return Text(node.op + inner.within(UNARY), inner.type, UNARY)

    def write_ternaryop(self, node: c_ast.TernaryOp, wanted: str | None) -> Text:
        wanted = wanted or self.common(node.iftrue, node.iffalse)
        parts = [self.write(node.cond, "bool").within(1), self.write(node.iftrue, wanted).within(1),
                 self.write(node.iffalse, wanted).text]
        return Text("{} ? {} : {}".format(*parts), wanted, CONDITIONAL)

    def common(self, a: c_ast.Node, b: c_ast.Node) -> str:
        """The type of both: that of the one that is not just a number."""
        one, two = self.write(a).type, self.write(b).type
        return two if one == "int" else one

    def write_binaryop(self, node: c_ast.BinaryOp, wanted: str | None) -> Text:
        op = {"&": "&&", "|": "||"}.get(node.op, node.op)
        if op in ("&&", "||"):
            sides = [self.write(side, "bool") for side in (node.left, node.right)]
            # both kinds in one expression: with brackets, though GLSL would not need them
            text = f" {op} ".join(s.within(UNARY if s.binds < 4 and f" {op} " not in s.text else 1) for s in sides)
            return Text(text, "bool", PRECEDENCE[op])
        if op not in PRECEDENCE:
            raise CannotSayError(node, f"the operator {op}")
        compares = PRECEDENCE[op] < PRECEDENCE["+"]
        kinds = {self.write(side).type for side in (node.left, node.right)}
        if compares and kinds == {"bool", "int"} and op == "==" and self.is_zero(node.right):
            return Text("!" + self.write(node.left).within(UNARY), "bool", UNARY)
        # of vectors and numbers: each as it is, but for int
        each = [("float" if kinds - {"int"} and self.write(s).type == "int" else None) for s in (node.left, node.right)]
        left, right = self.write(node.left, each[0]), self.write(node.right, each[1])
        if not kinds - {"int"} and wanted == "float":
            left, right = self.write(node.left, "float"), self.write(node.right, "float")
        binds = PRECEDENCE[op]
        kind = "bool" if compares else "vec3" if "vec3" in (left.type, right.type) else left.type
        return Text(f"{left.within(binds)} {op} {right.within(binds + 1)}", kind, binds)

    @staticmethod
    def is_zero(node: c_ast.Node) -> bool:
        return isinstance(node, c_ast.Constant) and node.value == "0"

    def write_initlist(self, node: c_ast.InitList, wanted: str | None) -> Text:
        fields = ["float"] * 3 if wanted == "vec3" else list(self.known.structs.get(wanted or "", {}).values())
        if len(fields) != len(node.exprs):
            raise CannotSayError(node, f"{len(node.exprs)} values where {wanted} has {len(fields)}")
        values = [self.write(value, kind).text for value, kind in zip(node.exprs, fields, strict=True)]
        return Text(f"{wanted}({', '.join(values)})", wanted or "")


# x, y and z at once ---------------------------------------------------------------------------------------------


def same(nodes: Sequence[c_ast.Node], known: Known) -> c_ast.Node | None:
    """What does to vectors what the three do to their x, y and z; None where there is no such thing."""
    first = nodes[0]
    if any(type(node) is not type(first) for node in nodes):
        return None
    if isinstance(first, c_ast.StructRef):
        bases = [node.name for node in nodes]
        if [node.field.name for node in nodes] == ["x", "y", "z"] and all(alike(bases[0], b) for b in bases):
            return bases[0] if Expressions(known).write(bases[0]).type == "vec3" else None
        return first if all(alike(first, node) for node in nodes) else None
    if isinstance(first, c_ast.BinaryOp):
        left, right = same([n.left for n in nodes], known), same([n.right for n in nodes], known)
        if left and right and all(n.op == first.op for n in nodes):
            return c_ast.BinaryOp(first.op, left, right, first.coord)
        return None
    return first if all(alike(first, node) for node in nodes) else None


def alike(a: c_ast.Node, b: c_ast.Node) -> bool:
    """The same text."""
    def values(node: c_ast.Node) -> list[object]:
        return [getattr(node, name) for name in node.attr_names]

    return (type(a) is type(b) and values(a) == values(b) and len(a.children()) == len(b.children())
            and all(alike(x, y) for (_, x), (_, y) in zip(a.children(), b.children(), strict=True)))


def vector(nodes: Sequence[c_ast.Node], known: Known) -> c_ast.Node | None:
    """As `same`, where something of it is a vector."""
    found = same(nodes, known)
    return found if found and Expressions(known).write(found).type == "vec3" else None


# Statements -----------------------------------------------------------------------------------------------------


@dataclass
class Comment:
    line: int
    text: str
    alone: bool  # nothing else is on its line


def fitting(line: str, node: c_ast.Node) -> str:
    if len(line) > WIDTH:
        raise CannotSayError(node, f"a line that gets longer than {WIDTH} columns: break it into two statements")
    return line


class Statements:
    """Writes the statements of one function or example, with their comments."""

    def __init__(self, known: Known, comments: Sequence[Comment]) -> None:
        self.known, self.comments = known, list(comments)
        self.expressions = Expressions(known)

    def value(self, node: c_ast.Node, wanted: str) -> str:
        if isinstance(node, c_ast.InitList) and wanted == "vec3":
            node = vector(node.exprs, self.known) or node
        return self.expressions.write(node, wanted).text

    def block(self, nodes: Sequence[c_ast.Node], indent: int) -> list[str]:
        lines: list[str] = []
        for node in nodes:
            if isinstance(node, c_ast.Decl):
                self.known.variables[named(node, node.name)] = type_of(node)
        groups = self.groups(self.folded(nodes))
        starts = [group[0].coord.line for group in groups]
        for group, start, following in zip(groups, starts, [*starts[1:], None], strict=True):
            lines += [" " * indent + c.text for c in self.taken(start - 1)]
            text = self.statement(group, indent)
            after = [c.text for c in self.taken(following - 1 if following else group[-1].coord.line, False)]
            text[-1] += "".join("  " + c for c in after)
            lines += text
        return lines

    def taken(self, last: int, alone: bool = True) -> list[Comment]:
        """The comments up to a line, which are then written."""
        found = [c for c in self.comments if c.line <= last and c.alone == alone]
        self.comments = [c for c in self.comments if c not in found]
        return found

    def folded(self, nodes: Sequence[c_ast.Node]) -> list[c_ast.Node]:
        """With one statement for the x, y and z of a vector: its declaration, or what is returned, where it can be."""
        done: list[c_ast.Node] = []
        rest = list(nodes)
        while rest:
            node = self.of_a_vector(rest[:3])
            if not node:
                done.append(rest.pop(0))
                continue
            rest = rest[3:]
            name = getattr(node.lvalue, "name", None)
            bare = [d for d in done if isinstance(d, c_ast.Decl) and not d.init and d.name == name]
            if bare:
                done.remove(bare[0])
                if rest and isinstance(rest[0], c_ast.Return) and getattr(rest[0].expr, "name", "") == name:
                    node = c_ast.Return(node.rvalue, node.coord)
                    rest.pop(0)
                else:
                    kind = c_ast.TypeDecl(name, [], [], c_ast.IdentifierType(["bs_vec3"], node.coord), node.coord)
                    node = c_ast.Decl(name, [], [], [], [], kind, node.rvalue, None, node.coord)
            done.append(node)
        return done

    def of_a_vector(self, nodes: Sequence[c_ast.Node]) -> c_ast.Assignment | None:
        """`a = f(b)` of `a.x = f(b.x), a.y = f(b.y), a.z = f(b.z)`."""
        if len(nodes) < 3 or not all(isinstance(n, c_ast.Assignment) and n.op == "=" for n in nodes):
            return None
        left = vector([n.lvalue for n in nodes], self.known)
        right = vector([n.rvalue for n in nodes], self.known)
        return c_ast.Assignment("=", left, right, nodes[0].coord) if left and right else None

    @staticmethod
    def groups(nodes: Sequence[c_ast.Node]) -> list[list[c_ast.Node]]:
        """The declarations of one statement together, all else one by one."""
        found: list[list[c_ast.Node]] = []
        for node in nodes:
            declares = isinstance(node, c_ast.Decl) and found and isinstance(found[-1][0], c_ast.Decl)
            if declares and str(node.type.type.coord) == str(found[-1][0].type.type.coord):
                found[-1].append(node)
            else:
                found.append([node])
        return found

    def statement(self, group: Sequence[c_ast.Node], indent: int) -> list[str]:
        node, margin = group[0], " " * indent
        if isinstance(node, c_ast.Decl):
            return [fitting(f"{margin}{self.declaration(group)};", node)]
        if isinstance(node, c_ast.Return):
            text = self.value(node.expr, self.known.variables["return"])
            return [fitting(f"{margin}return {text};", node)]
        if isinstance(node, c_ast.Assignment):
            return [fitting(f"{margin}{self.assignment(node)};", node)]
        if isinstance(node, c_ast.If) and not node.iffalse:
            head = f"{margin}if ({self.expressions.write(node.cond, 'bool').text}) {{"
            return [fitting(head, node), *self.block(node.iftrue.block_items, indent + 4), f"{margin}}}"]
        if isinstance(node, c_ast.For):
            first, after = self.declaration(node.init.decls), self.expressions.write(node.next.expr).text
            head = f"{margin}for ({first}; {self.condition(node)}; {after}++) {{"
            return [head, *self.block(node.stmt.block_items, indent + 4), f"{margin}}}"]
        raise CannotSayError(node, f"a statement of the kind {type(node).__name__}")

    def condition(self, node: c_ast.For) -> str:
        if not isinstance(node.next, c_ast.UnaryOp) or node.next.op != "p++":
            raise CannotSayError(node, "a loop that does not end with ++")
        return self.expressions.write(node.cond, "bool").text

    def declaration(self, group: Sequence[c_ast.Decl]) -> str:
        kind, parts = type_of(group[0]), []
        for node in group:
            self.known.variables[named(node, node.name)] = kind
            parts.append(f"{node.name} = {self.value(node.init, kind)}" if node.init else node.name)
        return f"{kind} {', '.join(parts)}"

    def assignment(self, node: c_ast.Assignment) -> str:
        left = self.expressions.write(node.lvalue)
        right = self.expressions.write(node.rvalue, left.type)
        if node.op == "|=" and left.type == "bool":
            return f"{left.text} = {left.text} || {right.within(4)}"
        if node.op != "=":
            raise CannotSayError(node, f"the operator {node.op}")
        return f"{left.text} = {right.text}"


# The file -------------------------------------------------------------------------------------------------------


COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)
TYPEDEFS = "typedef float bs_real; typedef int bs_bool;"


def blanked(text: str) -> str:
    """Spaces for all but the line ends."""
    return re.sub(r"[^\n]", " ", text)


def comments_of(text: str) -> tuple[str, list[Comment]]:
    """The text with blanks for its comments, and the comments."""
    found = []
    for m in COMMENT.finditer(text):
        alone = not text[text.rfind("\n", 0, m.start()) + 1:m.start()].strip()
        found.append(Comment(text.count("\n", 0, m.start()) + 1, m.group(), alone))
    return COMMENT.sub(lambda m: blanked(m.group()), text), found


@dataclass
class Piece:
    """A type or a function of the header, with its lines."""

    first: int
    last: int
    node: c_ast.Node


def pieces_of(code: str) -> list[Piece]:
    """Of text without comments and directives."""
    spans, begin, depth = [], None, 0
    for i, c in enumerate(code):
        begin = i if begin is None and not c.isspace() else begin
        depth += (c == "{") - (c == "}")
        if begin is not None and depth == 0 and c == (";" if code.startswith("typedef", begin) else "}"):
            spans.append((begin, i))
            begin = None
    nodes = CParser().parse(TYPEDEFS + code, str(SOURCE.relative_to(TOP))).ext[TYPEDEFS.count(";"):]
    return [Piece(code.count("\n", 0, a) + 1, code.count("\n", 0, b) + 1, node)
            for (a, b), node in zip(spans, nodes, strict=True)]


class Writer:
    """Writes the file."""

    def __init__(self, header: str) -> None:
        begin = header.index(BODY_BEGINS)
        self.head = header[header.index(HEAD_GOES_ON):header.index("*/") + 2]
        code, self.comments = comments_of(blanked(header[:begin]) + header[begin:])
        self.pieces = pieces_of(re.sub(r"^#.*$", "", code, flags=re.MULTILINE))
        self.blank = {i for i, line in enumerate(header.split("\n"), 1) if not line.strip()}
        self.known = Known()
        for piece in self.pieces:
            self.declare(piece.node)

    def declare(self, node: c_ast.Node) -> None:
        """A struct or a function, for all that comes after it and for all examples."""
        if isinstance(node, c_ast.FuncDef):
            wanted = [type_of(p) for p in node.decl.type.args.params]
            self.known.functions[node.decl.name] = (type_of(node.decl.type), wanted)
        elif isinstance(node, c_ast.Typedef) and isinstance(node.type.type, c_ast.Struct):
            self.known.structs[node.name] = {named(f, f.name): type_of(f) for f in node.type.type.decls}
        else:
            raise CannotSayError(node, "what is neither a struct nor a function")

    def write(self) -> str:
        lines = (HEAD + self.comment(self.head) + GUARD).split("\n")
        inside = {c.line for c in self.comments for p in self.pieces if p.first <= c.line <= p.last}
        items = [(c.line, self.comment(c.text)) for c in self.comments if c.line not in inside]
        items += [(p.first, self.piece(p)) for p in self.pieces]
        for first, text in sorted(item for item in items if item[1]):
            if first - 1 in self.blank and lines[-1]:
                lines.append("")
            lines += text.split("\n")
        return "\n".join([*lines, "", "#endif"]) + "\n"

    def piece(self, piece: Piece) -> str:
        node, own = piece.node, [c for c in self.comments if piece.first <= c.line <= piece.last]
        if isinstance(node, c_ast.Typedef):
            if node.name in TYPES:
                return ""
            writer = Statements(Known(), own)
            text = [f"struct {node.name} {{", *aligned(writer.block(node.type.type.decls, 4)), "};"]
        else:
            if node.decl.name in BUILT_IN:
                return ""
            text, writer = self.function(node, own)
        if writer.comments:
            raise CannotSayError(node, f"a comment at a place where it can't be kept: {writer.comments[0].text}")
        return "\n".join(text)

    def function(self, node: c_ast.FuncDef, own: Sequence[Comment]) -> tuple[list[str], Statements]:
        params = {named(p, p.name): type_of(p) for p in node.decl.type.args.params}
        result = type_of(node.decl.type)
        known = Known({**params, "return": result}, self.known.structs, self.known.functions)
        writer = Statements(known, own)
        body = writer.block(node.body.block_items, 4)
        head = f"{result} {node.decl.name}({', '.join(f'{kind} {name}' for name, kind in params.items())})"
        one = f"{head} {{ {body[0].strip()} }}"
        if len(body) == 1 and len(one) <= WIDTH:
            return [one], writer
        return [fitting(head, node), "{", *aligned(body), "}"], writer

    def comment(self, text: str) -> str:
        """With its examples in GLSL: the indented parts that have a statement in them."""
        def example(m: re.Match[str]) -> str:
            if not re.search(r";\s*(//.*)?$", m.group(), re.MULTILINE):
                return m.group()
            return "".join(f" *     {line}\n" for line in self.example(re.sub(r"^ \* {5}", "", m.group(), flags=re.M)))

        return re.sub(r"(^ \* {5}.*\n)+", example, text, flags=re.MULTILINE)

    def example(self, text: str, given: str = GIVEN, functions: Mapping[str, tuple[str, list[str]]] | None = None,
                ) -> list[str]:
        """Statements in GLSL; `given`: what is declared before them, beside the header; `functions`: GLSL's own."""
        code, comments = comments_of(text)
        types = TYPEDEFS + "".join(f"typedef int {name};" for name in self.known.structs)
        declared = f"{types}{given}".replace("\n", " ")
        tree = CParser().parse(f"{declared} void example(void) {{{code}}}", "an example").ext
        known = Known({}, self.known.structs, {**self.known.functions, **(functions or {})})
        for node in tree[:-1]:
            if isinstance(node, c_ast.Decl) and isinstance(node.type, c_ast.FuncDecl):
                known.functions[node.name] = (type_of(node.type), [type_of(p) for p in node.type.args.params])
            elif isinstance(node, c_ast.Decl):
                known.variables[node.name] = type_of(node)
        writer = Statements(known, comments)
        lines = writer.block(tree[-1].body.block_items, 0)
        return aligned([*lines, *(c.text for c in writer.comments)])


def aligned(lines: Sequence[str]) -> list[str]:
    """Comments at the ends of lines next to each other begin in one column."""
    def code(line: str) -> int:
        found = re.search(r"\S  (?=/\*|//)", line)
        return found.end() - 1 if found else 0

    done: list[str] = []
    for i, line in enumerate(lines):
        first, last = i, i
        while first > 0 and code(lines[first - 1]):
            first -= 1
        while last + 1 < len(lines) and code(lines[last + 1]):
            last += 1
        at = max(map(code, lines[first:last + 1]))
        done.append(line[:code(line)].rstrip().ljust(at) + line[code(line) + 1:] if code(line) else line)
    return done


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m scripts.glsl", description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--check", action="store_true", help="write nothing; exit status 1 where the file is stale")
    check = parser.parse_args(words).check
    try:
        text = Writer(SOURCE.read_text(encoding="utf-8")).write()
    except CannotSayError as error:
        sys.stderr.write(f"{error}\n")
        return 2
    if not check:
        TARGET.write_text(text, encoding="utf-8")
    elif not TARGET.exists() or TARGET.read_text(encoding="utf-8") != text:
        sys.stderr.write(f"{TARGET.name} is stale: scripts/venv python -m scripts.glsl\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""What can be mutated in a C++ source, found by libclang, and the source with
some of its mutants woven in: each stays asleep until ALIDADE_MUTANT names it.

A site is one token of a function's body: an operator of arithmetic, comparison
or logic, a sign, or a number. Messages, constant expressions, template arguments
and array sizes are left out.
"""

import collections
import os
import re

HELPERS = {"+": "Plus", "-": "Minus", "*": "Times", "/": "Over",
           "+=": "PlusAssign", "-=": "MinusAssign", "*=": "TimesAssign",
           "/=": "OverAssign"}
OPPOSITE = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*",
            "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=",
            "&&": "||", "||": "&&"}
FUNCTORS = {"<": "std::less<>", "<=": "std::less_equal<>",
            ">": "std::greater<>", ">=": "std::greater_equal<>",
            "==": "std::equal_to<>", "!=": "std::not_equal_to<>",
            "%": "std::modulus<>", "*": "std::multiplies<>"}
# The comparison that is true where the first is not, and the one that differs
# where both operands are equal.
NEGATION = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
BOUNDARY = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
# Vector functions whose last operand takes the sign.
VECTOR = {"hn::Add": "hn::Sub", "hn::Sub": "hn::Add",
          "hn::MulAdd": "hn::MulSub", "hn::MulSub": "hn::MulAdd",
          "hn::NegMulAdd": "hn::NegMulSub", "hn::Mul": "-hn::Mul",
          "hn::Neg": "-hn::Neg"}
NUMBER = re.compile(r"(0[xX][0-9a-fA-F.]+([pP][+-]?\d+)?"
                    r"|(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?)([uUlLfF]*)")
# Calls that write text for people, and what they are given.
MESSAGE = re.compile(
    r"^(Format\w*|FixedNumber|InputError|Quote|Join\w*|to_string|format|"
    r"Describe\w*|operator<<)$")

# One place and what it becomes: offsets are in bytes; `edits` are what weaving
# inserts or replaces, as (offset, length, text, depth); "@" is the number.
Site = collections.namedtuple(
    "Site", "file line column end_line old choices forms")


class Collector:
    """The sites of the files below one directory, from one source's tree."""

    def __init__(self, root, directory, cindex):
        self.root = root
        self.directory = os.path.join(root, directory) + os.sep
        self.kinds = cindex.CursorKind
        self.types = cindex.TypeKind
        self.sites = {}
        self.texts = {}

    def collect(self, unit):
        self.enter(unit.cursor)
        return self.sites

    # ------------------------------------------------------------ where

    def text_of(self, path):
        if path not in self.texts:
            with open(path, "rb") as file:
                self.texts[path] = file.read()
        return self.texts[path]

    def is_ours(self, cursor):
        file = cursor.location.file
        return file is not None and os.path.normpath(file.name).startswith(
            self.directory)

    def enter(self, cursor):
        """Looks for functions with bodies, in namespaces and classes."""
        k = self.kinds
        functions = {k.FUNCTION_DECL, k.CXX_METHOD, k.CONSTRUCTOR,
                     k.DESTRUCTOR, k.FUNCTION_TEMPLATE, k.CONVERSION_FUNCTION}
        scopes = {k.NAMESPACE, k.CLASS_DECL, k.STRUCT_DECL, k.CLASS_TEMPLATE,
                  k.CLASS_TEMPLATE_PARTIAL_SPECIALIZATION, k.UNEXPOSED_DECL,
                  k.LINKAGE_SPEC}
        for child in cursor.get_children():
            if not self.is_ours(child):
                continue
            if child.kind in functions:
                self.function(child)
            elif child.kind in scopes:
                self.enter(child)

    def slice(self, begin, end, path):
        return self.text_of(path)[begin:end].decode()

    def source(self, cursor):
        extent = cursor.extent
        return self.slice(extent.start.offset, extent.end.offset,
                          extent.start.file.name)

    def function(self, cursor):
        k = self.kinds
        children = list(cursor.get_children())
        bodies = [c for c in children if c.kind == k.COMPOUND_STMT]
        if not bodies:
            return
        head = self.slice(cursor.extent.start.offset,
                          bodies[-1].extent.start.offset,
                          cursor.extent.start.file.name)
        if re.search(r"\bconstexpr\b", head):
            return
        for child in children:
            if child.kind.is_expression() or child.kind == k.COMPOUND_STMT:
                self.walk(child)

    # ------------------------------------------------------------- what

    def walk(self, cursor):
        k = self.kinds
        kind = cursor.kind
        if kind in (k.CXX_THROW_EXPR, k.STATIC_ASSERT, k.PARM_DECL,
                    k.TYPE_REF, k.TEMPLATE_REF, k.CXX_UNARY_EXPR,
                    k.TYPE_ALIAS_DECL):
            return
        if kind == k.CALL_EXPR and self.is_message(cursor):
            return
        children = list(cursor.get_children())
        if kind == k.VAR_DECL and re.search(
                r"\bconstexpr\b", self.source(cursor).split("=")[0]):
            return
        if kind == k.CASE_STMT or (
                kind == k.IF_STMT and
                re.match(r"if\s+constexpr", self.source(cursor))):
            children = children[1:]
        self.look_at(cursor, children)
        for child in children:
            self.walk(child)

    def is_message(self, cursor):
        if MESSAGE.match(cursor.spelling or ""):
            return True
        spelling = cursor.type.get_canonical().spelling
        return cursor.spelling.startswith("operator") and (
            "basic_string" in spelling or "ostream" in spelling)

    def look_at(self, cursor, children):
        k = self.kinds
        if cursor.kind in (k.BINARY_OPERATOR, k.COMPOUND_ASSIGNMENT_OPERATOR):
            if len(children) == 2:
                self.binary(cursor, children[0], children[1])
        elif cursor.kind == k.CALL_EXPR:
            if self.source(cursor).startswith("hn::"):
                self.vector(cursor, children)
            elif len(children) == 3:
                self.binary(cursor, children[0], children[2])
            elif len(children) == 2:
                self.unary(cursor, children[1])
        elif cursor.kind == k.UNARY_OPERATOR:
            self.unary(cursor, children[0])
        elif cursor.kind in (k.INTEGER_LITERAL, k.FLOATING_LITERAL):
            self.number(cursor)

    def add(self, cursor, offset, old, choices, forms):
        """Keeps a site whose token `old` is at `offset`."""
        path = cursor.extent.start.file.name
        text = self.text_of(path)
        key = (os.path.relpath(path, self.root), offset)
        if key in self.sites:
            return
        self.sites[key] = Site(
            key[0], text.count(b"\n", 0, offset) + 1,
            offset - text.rfind(b"\n", 0, offset),
            text.count(b"\n", 0, cursor.extent.end.offset) + 1,
            old, choices, forms)

    def is_vector_source(self, path):
        return b"HWY_NAMESPACE" in self.text_of(path)

    def is_builtin(self, cursor):
        return cursor.type.get_canonical().kind.value in range(3, 24) or (
            cursor.type.get_canonical().kind == self.types.POINTER)

    def binary(self, cursor, left, right):
        path = cursor.extent.start.file.name
        begin, end = left.extent.end.offset, right.extent.start.offset
        between = re.sub(r"//[^\n]*|/\*.*?\*/",
                         lambda match: " " * len(match.group()),
                         self.slice(begin, end, path), flags=re.S)
        old = between.strip()
        if old not in OPPOSITE and old not in NEGATION:
            return
        # Functions of one instruction set cannot be called from without.
        if self.is_vector_source(path) and not (
                self.is_builtin(left) and self.is_builtin(right)):
            return
        at = begin + between.index(old)
        first, last = left.extent.start.offset, right.extent.end.offset
        if old in ("&&", "||"):
            flip = "(::alidade_mutation::Active(@) != static_cast<bool>("
            forms = {OPPOSITE[old]: [
                (first, 0, "(::alidade_mutation::Active(@) != (" + flip),
                (at, 2, f")) {old} {flip}"), (last, 0, "))))")]}
        elif old in HELPERS:
            # Two matrices have no quotient: the product becomes negative.
            both_classes = old == "*" and all(
                side.type.get_canonical().kind == self.types.RECORD
                for side in (left, right))
            forms = {"* -" if both_classes else OPPOSITE[old]: [
                (first, 0, f"::alidade_mutation::{HELPERS[old]}(@, "),
                (at, len(old), ","), (last, 0, ")")]}
        else:
            forms = {new: [
                (first, 0, "::alidade_mutation::Choose<"
                           f"{FUNCTORS[old]}, {FUNCTORS[new]}>(@, "),
                (at, len(old), ","), (last, 0, ")")]
                for new in self.comparisons(old, left, right)}
        self.add(cursor, at, old, list(forms), forms)

    def comparisons(self, old, left, right):
        """Equal floating-point numbers come about by chance, but where one of
        them is a number of the source."""
        if old == "%":
            return ["*"]
        floating = {self.types.FLOAT, self.types.DOUBLE, self.types.LONGDOUBLE}
        is_integer = all(
            self.is_builtin(side) and
            side.type.get_canonical().kind not in floating
            for side in (left, right))
        has_number = any(NUMBER.fullmatch(self.source(side))
                         for side in (left, right))
        if old in BOUNDARY and (is_integer or has_number):
            return [BOUNDARY[old], NEGATION[old]]
        return [NEGATION[old]]

    def unary(self, cursor, operand):
        path = cursor.extent.start.file.name
        begin, end = cursor.extent.start.offset, operand.extent.start.offset
        old = self.slice(begin, end, path).strip()
        if old not in ("-", "!"):
            return
        if self.is_vector_source(path) and not self.is_builtin(operand):
            return
        helper = "Negate" if old == "-" else "Not"
        last = operand.extent.end.offset
        self.add(cursor, begin, old, [""], {"": [
            (begin, 1, f"::alidade_mutation::{helper}(@, "), (last, 0, ")")]})

    def vector(self, cursor, children):
        """Of the arithmetic of vectors the last operand changes its sign."""
        name = self.source(cursor).split("(")[0]
        if name not in VECTOR or len(children) < 2:
            return
        begin = children[-1].extent.start.offset
        end = children[-1].extent.end.offset
        new = VECTOR[name]
        self.add(cursor, cursor.extent.start.offset, name, [new], {new: [
            (begin, 0, "hn::Mul(hn::Set(kTag, ::alidade_mutation::Sign(@)), "),
            (end, 0, ")")]})

    def number(self, cursor):
        path = cursor.extent.start.file.name
        begin, end = cursor.extent.start.offset, cursor.extent.end.offset
        old = self.slice(begin, end, path)
        match = NUMBER.fullmatch(old)
        text = self.text_of(path)
        line = text[text.rfind(b"\n", 0, begin) + 1:begin].decode()
        rest = text[end:text.find(b"\n", end)].decode()
        is_argument = re.search(r"\w<[^<>();&|]*$", line) and re.match(
            r"[^<>();&|]*>", rest)
        if not match or is_argument:
            return
        forms = {}
        for new in mutated_numbers(old, match):
            forms[new] = [(begin, end - begin,
                           f"::alidade_mutation::Literal(@, {old}, {new})")]
        self.add(cursor, begin, old, list(forms), forms)


def mutated_numbers(old, match):
    """One more or less; twice a large one, which would hardly change."""
    digits, suffix = match.group(1), match.group(5)
    is_hex = digits[:2] in ("0x", "0X")
    is_float = "." in digits or "e" in digits.lower() and not is_hex or (
        is_hex and "p" in digits.lower())
    if not is_float:
        value = int(digits, 0)
        lower = [f"{value - 1}{suffix}"] if value > 0 else []
        return [f"{value + 1}{suffix}"] + lower
    value = float.fromhex(digits) if is_hex else float(digits)
    if value >= 1000.0:
        return [f"({old} * 2)"]
    news = []
    for step in (1, -1):
        exact = repr(value + step)
        news.append(exact + suffix if len(exact) <= 6 and not suffix
                    else f"({old} {step:+d})".replace("+", "+ ").replace(
                        " -", " - "))
    return news


def weave(text, mutants):
    """The source with its mutants, (number, forms) of one file; lines stay."""
    inserts = collections.defaultdict(lambda: ([], []))
    replaced = {}
    for number, edits in mutants:
        begin = min(offset for offset, _, _ in edits)
        end = max(offset + length for offset, length, _ in edits)
        for offset, length, new in edits:
            new = new.replace("@", str(number))
            if length:
                replaced[offset] = (length, new)
            elif offset == end and offset != begin:
                # What began last is closed first.
                inserts[offset][0].append((-begin, new))
            else:
                inserts[offset][1].append((-end, new))
    pieces = []
    done = 0
    for offset in sorted(set(inserts) | set(replaced)):
        pieces.append(text[done:offset].decode())
        done = offset
        closing, opening = inserts.get(offset, ([], []))
        pieces += [new for _, new in sorted(closing)]
        pieces += [new for _, new in sorted(opening)]
        if offset in replaced:
            length, new = replaced[offset]
            pieces.append(new)
            done = offset + length
    pieces.append(text[done:].decode())
    return ('#include "tests/mutation/mutation.h"\n#line 1\n' +
            "".join(pieces))

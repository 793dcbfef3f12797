# SPDX-License-Identifier: Apache-2.0
"""Small changes of C++ headers, all compiled into one program, of which one at a time is in force.

Where the source has ``a < b``, the changed copy has ``(mutant(17) ? (a <= b) : (a < b))``. What the
compiler computes itself, such as a `constexpr` table, has no such choice and is left out.
"""

import random
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from clang import cindex

_BINARY = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&",
    "+": "-", "-": "+", "*": "/", "/": "*", "%": "/", "&": "|", "|": "&", "^": "&", "<<": ">>",
    ">>": "<<",
}  # fmt: skip
_K: Any = cindex.CursorKind  # its members are made at run time
# What is in these is computed by the compiler, or is no expression.
_FIXED = {
    _K.STATIC_ASSERT, _K.ENUM_CONSTANT_DECL, _K.CONCEPT_DECL, _K.TEMPLATE_TYPE_PARAMETER,
    _K.TEMPLATE_NON_TYPE_PARAMETER, _K.TEMPLATE_TEMPLATE_PARAMETER,
}  # fmt: skip

HEADER = """\
#pragma once
// Which mutant is in force: the number in PALMBOTS_MUTANT. With PALMBOTS_REACHED, the numbers of
// the mutants that were asked for are appended to that file.
#include <cstdio>
#include <cstdlib>
#include <type_traits>

namespace palmbots_mutation {

struct Choice {
  int active = 0;
  unsigned char reached[4096] = {};
  Choice() {
    if (const char* text = std::getenv("PALMBOTS_MUTANT")) active = std::atoi(text);
  }
  ~Choice() {
    const char* path = std::getenv("PALMBOTS_REACHED");
    std::FILE* file = path != nullptr ? std::fopen(path, "a") : nullptr;
    if (file == nullptr) return;
    for (int k = 0; k < 4096; ++k) {
      if (reached[k] != 0) std::fprintf(file, "%d\\n", k);
    }
    std::fclose(file);
  }
};

inline Choice choice;

inline bool is_active(int number) {
  choice.reached[number] = 1;
  return choice.active == number;
}

constexpr bool mutant(int number) {
  if (std::is_constant_evaluated()) return false;
  return is_active(number);
}

}  // namespace palmbots_mutation
"""


@dataclass(frozen=True)
class Mutant:
    """One change of a header."""

    header: str
    """Relative to the folder of headers."""
    line: int
    start: int
    end: int
    """Bytes of the expression."""
    operator: str
    """What is changed, and into what, as ``< to <=``."""
    parts: tuple[tuple[int, int], ...]
    """Bytes of the operands."""

    def row(self, include: Path) -> dict[str, str]:
        """How a list describes it: header, line and its text, place and length of the expression
        in the line, change."""
        source = (include / self.header).read_bytes()
        begin = source.rfind(b"\n", 0, self.start) + 1
        line = source[begin : source.find(b"\n", self.start)]
        column = self.start - begin - (len(line) - len(line.lstrip()))
        return {
            "header": self.header, "line": str(self.line), "text": line.decode().strip(),
            "column": str(column), "length": str(self.end - self.start), "operator": self.operator,
        }  # fmt: skip


def mutants_of(include: Path, header: str) -> list[Mutant]:
    """All changes of one header that may be made while a program runs."""
    resources = subprocess.check_output(["clang", "-print-resource-dir"], text=True).strip()
    arguments = ["-x", "c++", "-std=c++20", f"-I{include}", f"-isystem{resources}/include"]
    unit = cindex.Index.create().parse(str(include / header), arguments)
    source = (include / header).read_bytes()
    found = {(m.start, m.end): m for m in _walk(unit.cursor, include / header, header, source)}
    return [found[key] for key in sorted(found)]


def _walk(cursor: Any, path: Path, header: str, source: bytes) -> Iterator[Mutant]:
    for child in cursor.get_children():
        place = child.location.file
        if cursor.kind == _K.TRANSLATION_UNIT and (place is None or Path(place.name) != path):
            continue
        if child.kind in _FIXED or _is_constant(child, source):
            continue
        if cursor.kind == _K.IF_STMT and _is_chosen_early(cursor, child, source):
            continue
        change = _change(child, source)
        if change is not None:
            start, end = child.extent.start.offset, child.extent.end.offset
            yield Mutant(header, child.extent.start.line, start, end, *change)
        yield from _walk(child, path, header, source)


def _text(cursor: Any, source: bytes) -> str:
    return source[cursor.extent.start.offset : cursor.extent.end.offset].decode()


def _is_constant(cursor: Any, source: bytes) -> bool:
    """A constant that the compiler computes."""
    if cursor.kind != _K.VAR_DECL:
        return False
    return "constexpr" in _text(cursor, source).partition("=")[0].partition("{")[0]


def _is_chosen_early(statement: Any, part: Any, source: bytes) -> bool:
    """Whether the part is the condition of a branch that the compiler chooses."""
    before = source[statement.extent.start.offset : part.extent.start.offset].decode()
    return before.startswith("if constexpr") and before.endswith("(")


def _change(cursor: Any, source: bytes) -> tuple[str, tuple[tuple[int, int], ...]] | None:
    text = _text(cursor, source)
    parts = tuple((c.extent.start.offset, c.extent.end.offset) for c in cursor.get_children())
    if cursor.kind == _K.BINARY_OPERATOR and len(parts) == 2:
        operator = source[parts[0][1] : parts[1][0]].decode().strip()
        return (f"{operator} to {_BINARY[operator]}", parts) if operator in _BINARY else None
    if cursor.kind == _K.INTEGER_LITERAL and text.isdigit():
        return f"{text} to {int(text) + 1}", ()
    if cursor.kind == _K.CXX_BOOL_LITERAL_EXPR and text in ("true", "false"):
        return f"{text} to {'false' if text == 'true' else 'true'}", ()
    if cursor.kind == _K.UNARY_OPERATOR and text.startswith("!") and len(parts) == 1:
        return "! to nothing", parts
    return None


def sample(mutants: list[Mutant], size: int, seed: int) -> list[Mutant]:
    """Some of the mutants, each as likely as another, in their order."""
    chosen = random.Random(seed).sample(range(len(mutants)), min(size, len(mutants)))
    return [mutants[k] for k in sorted(chosen)]


def found_again(include: Path, listed: dict[int, dict[str, str]]) -> dict[int, Mutant]:
    """The mutants of a list, by their numbers, in headers that may have changed since.

    A mutant is where its line is, character by character: the nearest such line of its header or,
    if there is none, the only one of all headers.
    """

    def key(row: dict[str, str]) -> tuple[str, ...]:
        return row["text"], row["column"], row["length"], row["operator"]

    places: dict[tuple[str, ...], list[Mutant]] = {}
    texts = {row["text"] for row in listed.values()}
    for path in sorted((include / "palmbots").glob("*/*.hpp")):
        if texts.isdisjoint(line.strip() for line in path.read_text().splitlines()):
            continue
        for mutant in mutants_of(include, str(path.relative_to(include))):
            places.setdefault(key(mutant.row(include)), []).append(mutant)
    found: dict[int, Mutant] = {}
    for number, row in listed.items():
        there = places.get(key(row), [])
        own = [mutant for mutant in there if mutant.header == row["header"]]
        if own:
            found[number] = min(own, key=lambda mutant: abs(mutant.line - int(row["line"])))
        elif len(there) == 1:
            found[number] = there[0]
    return found


def changed(source: bytes, chosen: dict[int, Mutant]) -> bytes:
    """The header with these mutants, by their numbers, in it."""
    spans = sorted(chosen.items(), key=lambda item: (item[1].start, -item[1].end))

    def text(start: int, end: int, numbers: list[tuple[int, Mutant]]) -> bytes:
        out, at = b"", start
        while numbers:
            (number, mutant), rest = numbers[0], numbers[1:]
            inside = [one for one in rest if one[1].end <= mutant.end]
            numbers = [one for one in rest if one[1].end > mutant.end]
            out += source[at : mutant.start] + choice(number, mutant, inside)
            at = mutant.end
        return out + source[at:end]

    def choice(number: int, mutant: Mutant, inside: list[tuple[int, Mutant]]) -> bytes:
        def part(start: int, end: int) -> bytes:
            return text(start, end, [m for m in inside if start <= m[1].start and m[1].end <= end])

        before, _, after = mutant.operator.partition(" to ")
        if len(mutant.parts) == 2:
            left, right = (part(*span) for span in mutant.parts)
            new, old = (left + f" {op} ".encode() + right for op in (after, before))
        elif len(mutant.parts) == 1:
            new = part(*mutant.parts[0])
            old = b"!" + new
        else:
            new, old = after.encode(), before.encode()
        call = f"(::palmbots_mutation::mutant({number}) ? ".encode()
        return call + b"(" + new + b") : (" + old + b"))"

    out = text(0, len(source), spans)
    return out.replace(b"#pragma once\n", b'#pragma once\n#include "palmbots_mutation.hpp"\n', 1)

# SPDX-License-Identifier: Apache-2.0
"""What `palmbots derive` finds: the rules of a policy, and how controllers refine it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from palmbots._types import SIDES
from palmbots._util.plain_values import NOT_IN_JSON, derived
from palmbots._util.results import Result
from palmbots.derivation.local_rules import Derivation
from palmbots.derivation.permissions import LEVELS
from palmbots.derivation.refinement import Departure, Refinement


@dataclass(frozen=True)
class MoveRow:
    """A move of the policy."""

    direction: str
    until: tuple[str, ...]


@dataclass(frozen=True)
class CaseRow:
    """A case of the policy."""

    case: int
    signs: tuple[int, int]
    tilt: str | None
    """The palm to tilt up."""
    moves: tuple[MoveRow, ...]


@dataclass(frozen=True)
class GuardRow:
    """A condition of a move that its owner does not sense."""

    case: int
    move: int
    owner: str
    guard: str
    dropped: bool
    reason: str


@dataclass(frozen=True)
class RuleRow:
    """The program of a rule."""

    when: str
    lines: tuple[str, ...]
    robots: tuple[str, ...]
    """Those that have it."""
    sources: tuple[tuple[int, int], ...]
    """The moves (case, number) from which it follows."""


@dataclass(frozen=True)
class ConflictRow:
    """Two rules of both robots that hold at once."""

    rules: tuple[str, str]
    signs: tuple[tuple[int, int], ...]
    palms_clash: bool
    moves_clash: bool
    cases: tuple[int, ...]
    order: str


@dataclass(frozen=True)
class DepartureRow:
    """A kind of motion that the policy does not permit, with the shortest run to one."""

    differs: str
    case: str
    permitted_by: str | None
    strays: bool
    motions: int
    start: tuple[int, int]
    explanation: str
    run: tuple[str, ...]


@dataclass(frozen=True)
class RefinementRow:
    """One controller compared with the policy."""

    states: int
    motions: dict[str, int]
    """The motions in every run, by what permits them."""
    weakest_permission: str | None
    stuck: int
    falls: int
    departures: tuple[DepartureRow, ...]


def rule_rows(derivation: Derivation) -> dict[str, RuleRow]:
    """The programs, with the robots that have them and where they come from."""
    return {
        name: RuleRow(
            program.when,
            tuple(program.lines),
            tuple(SIDES[robot] for robot in derivation.robots.get(name, (0, 1))),
            derivation.sources.get(name, ()),
        )
        for name, program in derivation.programs.items()
    }


def counts_by_permission(found: Refinement) -> dict[str, int]:
    """The number of motions, by what permits them."""
    return {level or "nothing": len(found.permitted.get(level, ())) for level in (*LEVELS, None)}


def sorted_departures(found: Refinement) -> list[Departure]:
    """Departures that the narrowest weakening permits first, those that nothing permits last."""
    order = (*LEVELS, None)
    return sorted(found.departures, key=lambda d: (order.index(d.kind.level), d.kind.case))


@dataclass(frozen=True, repr=False)
class DerivedRules(Result):
    """The rules that follow from a policy of the paper."""

    lines_of = "palmbots.derivation.rule_lines:rule_lines"

    name: str
    """Of the policy."""
    derivation: Derivation = field(metadata=NOT_IN_JSON)
    refinements: Mapping[str, Refinement] = field(metadata=NOT_IN_JSON)
    """By controller."""
    shows_runs: bool = field(default=False, metadata=NOT_IN_JSON)
    """Whether people read the runs to the departures, too."""

    @derived
    def policy(self) -> tuple[CaseRow, ...]:
        """The cases of the policy."""
        return tuple(
            CaseRow(
                number,
                case.signs,
                None if case.tilt is None else SIDES[case.tilt],
                tuple(MoveRow(m.direction, tuple(map(str, m.until))) for m in case.moves),
            )
            for number, case in enumerate(self.derivation.policy, 1)
        )

    @derived
    def guards(self) -> tuple[GuardRow, ...]:
        """The conditions that an owner does not sense."""
        return tuple(
            GuardRow(g.case, g.step, SIDES[g.owner], str(g), g.dropped, g.reason)
            for g in self.derivation.guards
        )

    @derived
    def rules(self) -> dict[str, RuleRow]:
        """The programs by name."""
        return rule_rows(self.derivation)

    @derived
    def conflicts(self) -> tuple[ConflictRow, ...]:
        """The rules of both robots that hold at once."""
        return tuple(
            ConflictRow(c.rules, c.signs, c.palms_clash, c.moves_clash, c.cases, c.order)
            for c in self.derivation.conflicts
        )

    @derived
    def findings(self) -> tuple[str, ...]:
        """What cannot be derived, and errors of the policy."""
        return tuple(self.derivation.findings)

    @derived
    def is_table_2(self) -> bool:
        """Whether the rules are (a), (c) and (d) of Table 2."""
        return self.derivation.is_table_2

    @derived
    def refinement(self) -> dict[str, RefinementRow]:
        """The comparison of each controller with the policy."""
        return {
            name: RefinementRow(
                found.states,
                counts_by_permission(found),
                found.needs,
                found.stuck,
                found.falls,
                tuple(
                    DepartureRow(
                        d.kind.differs,
                        d.kind.case,
                        d.kind.level,
                        d.kind.strays,
                        len(d.motions),
                        d.start,
                        d.explanation,
                        tuple(d.transcript()),
                    )
                    for d in sorted_departures(found)
                ),
            )
            for name, found in self.refinements.items()
        }

    @property
    def holds(self) -> bool:
        """Whether these are the rules of Table 2, and the policy has no error."""
        return self.is_table_2 and not self.findings

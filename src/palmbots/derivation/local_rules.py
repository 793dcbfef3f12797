# SPDX-License-Identifier: Apache-2.0
"""Derives rules for each robot from a global policy.

1. *Split* each case at its moves, and follow the signs through each move.
2. The *owner* of a move is the robot that senses its until-condition.
3. *Guards*: a condition on a contact that the owner does not sense may be dropped if no tick in
   that configuration of the palms can move that contact (`contact_motion`).
4. *Merge*: seen from the owner, outward positive, a rule of the left and one of the right robot are
   the same.
5. *Messages*: turning a palm of the other robot becomes a request, a reply and a release; the robot
   that receives a request serves it. In a policy file (policy_file.py) the partner may also have to
   drive; that becomes part of the request.
6. *Conflicts*: signs at which a rule of each robot applies, and what orders the two.

The result lists what cannot be derived: moves without effect or without end, guards that must stay,
signs that no rule corrects, rules that only one robot has.

Source: section 6 of the paper asks for this transformation, from section 2 to section 4.
"""

from dataclasses import dataclass, field, replace
from itertools import product
from typing import NamedTuple

from palmbots._types import SIDES
from palmbots.derivation.contact_motion import improves, passed_through, sliders, why
from palmbots.derivation.global_policy import (
    Angles,
    Drives,
    Move,
    Policy,
    Signs,
    Wiring,
    signs_text,
)
from palmbots.derivation.robot_rule import Rule
from palmbots.derivation.table2_programs import Program, table_2

SIGNS: tuple[Signs, ...] = tuple(product((-1, 0, 1), (-1, 0, 1)))
_RELATION = {-1: "<", 0: "=", 1: ">"}
_BY_SIGN = {1: "a", -1: "d"}  # as in Table 2: the cases of an outward and of an inward contact


@dataclass(frozen=True)
class Step:
    """One move of a case: the signs at its start, during it and at its end."""

    case: int
    number: int
    palms: Angles
    move: Move
    entry: frozenset[Signs]
    during: frozenset[Signs]
    ends: frozenset[Signs]
    owners: tuple[int, ...]


@dataclass(frozen=True)
class Guard:
    """A condition of a step on a contact that its owner does not sense."""

    case: int
    step: int
    owner: int
    contact: int
    sign: int
    dropped: bool
    reason: str

    def __str__(self) -> str:
        return f"p_{'LR'[self.contact]} {_RELATION[self.sign]} 0"


@dataclass(frozen=True)
class Conflict:
    """Two rules that apply at the same time, one of each robot."""

    rules: tuple[str, str]
    signs: tuple[Signs, ...]
    palms_clash: bool
    moves_clash: bool
    cases: tuple[int, ...]
    """The cases of the policy for these signs."""
    asking: int

    @property
    def order(self) -> str:
        """How the messages alone order the two rules."""
        if self.asking == 2:
            return (
                "requests cross: each waits for the other, and a case of its own must break the tie"
            )
        if self.asking == 1:
            return "the server is one thread: it finishes its own correction first, or serves first"
        return "no message between them: nothing orders them, they run at once"


@dataclass
class Derivation:
    """The result of a derivation."""

    policy: Policy
    wiring: Wiring
    rest: Angles = ("steep", "steep")
    """The angles of the palms while nothing is corrected."""
    steps: list[Step] = field(default_factory=list)
    guards: list[Guard] = field(default_factory=list)
    joint: list[Step] = field(default_factory=list)
    """Steps that need the sensors of both robots."""
    rules: dict[str, Rule] = field(default_factory=dict)
    """By name: the case of Table 2 with the same program, or a number."""
    robots: dict[str, tuple[int, ...]] = field(default_factory=dict)
    """The robots that have each rule."""
    sources: dict[str, tuple[tuple[int, int], ...]] = field(default_factory=dict)
    """The steps (case, number) from which each rule follows."""
    servers: dict[str, Program] = field(default_factory=dict)
    """What a robot does when it is asked, by name."""
    conflicts: list[Conflict] = field(default_factory=list)
    findings: list[str] = field(default_factory=list)
    """Parts that cannot be derived, and errors of the policy."""
    one_sided: list[str] = field(default_factory=list)
    """Rules that only one robot has. In Table 1, which treats the robots alike, a finding too."""
    table_2: dict[str, Program] = field(default_factory=table_2)

    @property
    def programs(self) -> dict[str, Program]:
        """All programs of a robot by name, the server included."""
        return {name: rule.program() for name, rule in self.rules.items()} | self.servers

    @property
    def server(self) -> Program | None:
        """The first of `servers`; None: no rule asks for anything."""
        return next(iter(self.servers.values()), None)

    @property
    def is_table_2(self) -> bool:
        """Whether these are (a), (c) and (d) of Table 2, equal for both robots."""
        cases = {name: self.table_2[name] for name in "acd"}
        return self.programs == cases and all(owners == (0, 1) for owners in self.robots.values())


def derive(policy: Policy, wiring: Wiring | None = None, rest: Angles | None = None) -> Derivation:
    """Derive the rules of each robot from a policy, the wiring and the palms at rest.

    By default each robot senses its own contact and turns its own palm, and palms rest steep.
    """
    done = Derivation(policy, wiring or Wiring(), rest or ("steep", "steep"))
    _split(done)
    parts = [part for step in done.steps for part in _parts_of(done, step)]
    found: dict[Rule, dict[int, list[tuple[int, int]]]] = {}
    for owner, rule, sources in _joined(done, parts):
        found.setdefault(rule, {}).setdefault(owner, []).extend(sources)
    _name_rules(done, found)
    _name_servers(done)
    _find_conflicts(done)
    _find_gaps(done)
    return done


def _split(done: Derivation) -> None:
    """Split the cases into steps, each with the signs during it."""
    for number, case in enumerate(done.policy, 1):
        palms = case.palms
        entry = frozenset({case.signs})
        moved = False
        label = case.label(number)
        for k, move in enumerate(case.moves, 1):
            during, ends = passed_through(entry, palms, move)
            owners = tuple(sorted({done.wiring.senses[u.contact] for u in move.until}))
            done.steps.append(Step(number, k, palms, move, entry, during, ends, owners))
            where = label if case.angles is not None else f"{label}, move {k}"
            if not during:
                done.findings.append(f"{where} never moves: {move.end} holds when it begins")
            elif not ends:
                done.findings.append(f"{where} never ends: it does not bring about {move.end}")
            astray = [s for s in sorted(during) if not improves(s, palms, move.direction)]
            if astray:
                at = ", ".join(map(signs_text, astray))
                done.findings.append(f"{where} can move a contact away from 0, at {at}")
            moved = moved or bool(during)
            entry = ends
        if not moved:
            at = signs_text(case.signs)
            done.findings.append(f"{label} never moves anything: {at} stays forever")


class _Part(NamedTuple):
    """The rule that follows from one beginning of a step, and which robots drive there."""

    owner: int
    rule: Rule
    partner: int
    """The sign of the partner's contact."""
    drives: Drives
    """(own, partner's)."""
    source: tuple[int, int]


def _parts_of(done: Derivation, step: Step) -> list[_Part]:
    """The rules of a step, one for each of its possible beginnings."""
    begins = sorted(step.entry & step.during)
    parts = []
    movable = sliders(step.palms, step.move.direction)
    joint = len(step.owners) > 1
    for owner, signs in product(step.owners, begins):
        guard: list[int | None] = list(signs)
        for contact in (0, 1):
            if done.wiring.senses[contact] == owner:
                continue
            dropped = contact not in movable and not joint
            reason = why(step.palms, step.move.direction)
            done.guards.append(
                Guard(step.case, step.number, owner, contact, signs[contact], dropped, reason)
            )
            joint = joint or not dropped
            guard[contact] = None
        if joint or not step.ends:
            continue
        own = slice(None) if owner == 0 else slice(None, None, -1)
        palms, rest = step.palms[own], done.rest[own]
        turners = done.wiring.turns[own]
        turned = [k for k in (0, 1) if palms[k] != rest[k]]
        by_owner = [palms[k] for k in turned if turners[k] == owner]
        asked = next((k for k in turned if turners[k] != owner), 1)
        rule = Rule(
            (guard[owner], guard[1 - owner]),
            (palms[0], palms[1]),
            step.move.direction,
            tuple((int(u.contact != owner), u.relation) for u in step.move.until),
            len(by_owner) < len(turned),
            (palms[asked], rest[asked]),
            by_owner[0] if by_owner else None,
        )
        drives = (done.policy[step.case - 1].drives or (owner == 0, owner == 1))[own]
        source = (step.case, step.number)
        parts.append(_Part(owner, rule, signs[1 - owner], (drives[0], drives[1]), source))
    if joint:
        done.joint.append(step)
    return parts


def _joined(done: Derivation, parts: list[_Part]) -> list[tuple[int, Rule, list[tuple[int, int]]]]:
    """The rules (owner, rule, sources), with the drives of the partner at each of its signs."""
    alike: dict[tuple[int, Rule], list[_Part]] = {}
    for part in parts:
        alike.setdefault((part.owner, part.rule), []).append(part)
    rules = []
    for (owner, rule), those in alike.items():
        if len({part.drives[0] for part in those}) > 1:
            labels = [done.policy[p.source[0] - 1].label(p.source[0]) for p in those]
            done.findings.append(
                f"{' and '.join(labels)} differ in whether the {SIDES[owner]} robot drives, and it "
                f"does not sense p_{'LR'[1 - owner]}"
            )
            continue
        assist = tuple(sorted({part.partner for part in those if part.drives[1]}))
        whole = replace(
            rule, asks=rule.asks or bool(assist), drives=those[0].drives[0], assist=assist
        )
        rules.append((owner, whole, [part.source for part in those]))
    return rules


def _name_rules(done: Derivation, found: dict[Rule, dict[int, list[tuple[int, int]]]]) -> None:
    """Name the rules after the cases of Table 2 with the same program, and list their owners."""
    of_file = _is_file(done)
    for number, (rule, by_owner) in enumerate(found.items(), 1):
        program = rule.program()
        names = [name for name, case in done.table_2.items() if case == program]
        name = names[0] if names else str(number)
        if of_file:
            name = _BY_SIGN.get(rule.signs[0] or 0, name)
            if any(other != rule and other.signs[0] == rule.signs[0] for other in found):
                name += " " + " and ".join(SIDES[owner] for owner in sorted(by_owner))
        done.rules[name] = rule
        done.robots[name] = tuple(sorted(by_owner))
        done.sources[name] = tuple(sorted(s for steps in by_owner.values() for s in steps))
        if len(by_owner) == 1 and done.wiring.alike and done.rest[0] == done.rest[1]:
            (owner,) = by_owner
            done.one_sided.append(
                f"rule ({name}) is the {SIDES[owner]} robot's alone: the policy has no mirror "
                "image of " + ", ".join(_source_text(done, *one) for one in done.sources[name])
            )
    done.rules = dict(sorted(done.rules.items()))
    if not of_file:
        done.findings += done.one_sided


def _is_file(done: Derivation) -> bool:
    """Whether the policy is one from a file."""
    return any(case.angles is not None for case in done.policy)


def _name_servers(done: Derivation) -> None:
    """Find what each robot does when it is asked, and name it as Table 2 does."""
    services = {}
    for name, rule in done.rules.items():
        if rule.asks:
            servers = {1 - owner for owner in done.robots[name]}
            services[name] = rule.service(_free_to_serve(done, servers))
    distinct = set(services.values())
    if len(distinct) == 1:
        (server,) = distinct
        of_table_2 = [name for name, case in done.table_2.items() if case == server]
        done.servers = {
            of_table_2[0] if of_table_2 else "c" if _is_file(done) else "server": server
        }
    else:
        done.servers = {f"c for {name}": service for name, service in services.items()}


def _source_text(done: Derivation, number: int, move: int) -> str:
    case = done.policy[number - 1]
    return case.label(number) + (f", move {move}" if case.angles is None else "")


def _free_to_serve(done: Derivation, servers: set[int]) -> str:
    """The signs at which robots serve: those at which no rule of their own makes them ask."""
    asking = {
        rule.signs[0]
        for name, rule in done.rules.items()
        if rule.asks and servers & set(done.robots[name])
    }
    free = tuple(sign for sign in (-1, 0, 1) if sign not in asking and None not in asking)
    texts = {(-1, 0): "p ≤ 0, ", (0, 1): "p ≥ 0, ", (0,): "p = 0, ", (-1, 0, 1): ""}
    return texts.get(free, "not asking, ")


def _find_conflicts(done: Derivation) -> None:
    """Find every pair of rules that apply at the same signs."""
    at: dict[tuple[str, str], list[Signs]] = {}
    clash: dict[tuple[str, str], tuple[bool, bool]] = {}
    for signs, (left, one), (right, two) in product(SIGNS, done.rules.items(), done.rules.items()):
        if 0 not in done.robots[left] or 1 not in done.robots[right]:
            continue
        if one.holds(0, signs) and two.holds(1, signs):
            pair = (left, right) if left <= right else (right, left)
            at.setdefault(pair, []).append(signs)
            clash[pair] = one.palms != two.palms[::-1], one.direction != two.direction
    for pair, where in sorted(at.items()):
        cases = tuple(n for n, case in enumerate(done.policy, 1) if case.signs in where)
        asking = sum(done.rules[name].asks for name in pair)
        done.conflicts.append(Conflict(pair, tuple(where), *clash[pair], cases, asking))


def _find_gaps(done: Derivation) -> None:
    """Find signs without a case or with several, and signs that no rule corrects."""
    for signs in SIGNS:
        cases = [n for n, case in enumerate(done.policy, 1) if case.signs == signs]
        ruled = any(
            rule.holds(robot, signs)
            for name, rule in done.rules.items()
            for robot in done.robots[name]
        )
        if len(cases) > 1:
            done.findings.append(f"{signs_text(signs)} has several cases: {cases}")
        if signs != (0, 0) and not cases:
            cover = "the rules correct it" if ruled else "and no rule corrects it"
            done.findings.append(f"{signs_text(signs)} has no case in the policy; {cover}")
        elif signs != (0, 0) and not ruled:
            text = f"{signs_text(signs)} is corrected by no rule"
            if any(step.case in cases for step in done.joint):
                text += ": either contact may slide, and no robot senses both"
            done.findings.append(text)

"""Motion programmes: the legs of a scene, each its keys and the steps it turns into.

A new leg is one class here: a subclass of :class:`Leg` whose first field is its key in a scene.
What the planner and the checks of a programme ask of legs are its attributes; nothing outside this
module asks which leg it is.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from inspect import get_annotations
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, field_serializer, model_validator
from pydantic.json_schema import SkipJsonSchema

from fingerpad.documents import Problem, Strict, nearest
from fingerpad.fields import Length, OneOf, Time, listed, quantity
from fingerpad.stimuli.columns import read_file
from fingerpad.stimuli.course import Course, read_course
from fingerpad.units import format_quantity

#: Duration (s) that stands for "until nothing changes any more": every Prony branch has relaxed
#: after it.
STEADY = 1e9
INSTANT, NO_TIME = 1e-12, 1e-6
"""s: by so much stand the states of a history apart of which the later takes no time; a leg that
takes less than the latter takes none.
"""
MAXIMUM_STEPS = 100_000
MAXIMUM_STROKE = 10.0


@dataclass(frozen=True)
class Step:
    """One step: leg number, end time s, duration s (:data:`STEADY`: to the steady state), and what
    is reached at its end.

    Exactly one of ``force`` (N per m of contact length) and ``depth`` (m) is given. ``distance``
    (m) is how far the pad has come along the surface. A ``fresh`` step lifts the pad, lets it
    recover fully and presses it there again. One that is not ``solved`` is an output on the way,
    where no state needs to be found.
    """

    leg: int
    time: float
    dt: float
    force: float | None = None
    depth: float | None = None
    distance: float = 0.0
    fresh: bool = False
    solved: bool = True


class Goal(NamedTuple):
    """What is prescribed: force (N/m) or depth (m), the other None, and the place along the surface
    (m).
    """

    force: float | None = None
    depth: float | None = None
    distance: float = 0.0


class Reached(NamedTuple):
    """Where a leg finds the pad: force (N/m), depth (m), and the depth (m) at which the undeformed
    skin is just touched.
    """

    force: float
    depth: float
    touching: float = 0.0


class Stepping(NamedTuple):
    """How finely: steps of a leg, m of contact length (N to N/m), does time matter, longest step of
    a slide (m), increments of a steady press, and into how many parts the longest steps of a slide
    are cut by outputs.
    """

    steps: int
    contact_length: float
    timed: bool
    slide_step: float | None
    increments: int = 1
    parts: Callable[[np.ndarray], np.ndarray] | None = None

    def way(self, start: float, way: float) -> np.ndarray:
        """Places (m) along the surface of a slide's outputs: every ``slide_step``, and each of
        these in as many ``parts`` as are wanted of one with its middle at a place (k,) m.
        """
        if not self.slide_step:
            return start + way * np.arange(1, self.steps + 1) / self.steps
        count = math.ceil(abs(way) / self.slide_step * (1 - 1e-9))
        ends = start + way * np.arange(count + 1) / count
        if self.parts is None:
            return ends[1:]
        parts = self.parts((ends[1:] + ends[:-1]) / 2)
        return np.concatenate(
            [np.linspace(a, b, n + 1)[1:] for a, b, n in zip(ends, ends[1:], parts, strict=False)]
        )


class Leg(Strict):
    """Base of all legs.

    Attributes
    ----------
    key
        Its name in a scene.
    presses
        Does it press to a target, so that a programme may begin with it? needs_contact: is it
        senseless when nothing is pressed? releases: is nothing pressed after it? loads: does it
        deform the skin? strokes: does it rub the skin? fresh: are its steps? early: share of its
        outputs, from the first, that need a state each.
    force, depth
        N, m, which it presses to.
    along
        m, its way along the surface.
    kept
        "force" or "depth" on that way. speed: m/s, None for a steady leg, or one that has none;
        every leg says it.
    quickest
        s, that its load would take at its fastest, where that is not its duration.
    """

    key: ClassVar[str]
    presses: ClassVar[bool] = False
    needs_contact: ClassVar[bool] = False
    releases: ClassVar[bool] = False
    loads: ClassVar[bool] = True
    strokes: ClassVar[bool] = False
    fresh: ClassVar[bool] = False
    early: ClassVar[float] = 1.0
    force: ClassVar[float | None] = None
    depth: ClassVar[float | None] = None
    along: ClassVar[float] = 0.0
    kept: ClassVar[str | None] = None
    quickest: ClassVar[float | None] = None

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        cls.key = next(iter(cls.model_fields))
        if cls.key in get_annotations(cls):
            LEGS[cls.key] = cls

    @property
    def target(self) -> Any:
        """Value of its key."""
        return getattr(self, self.key)

    def path(
        self, at: Goal, last: float | None, reached: Reached, how: Stepping
    ) -> tuple[np.ndarray, list[Goal]]:
        """Durations (s) of its steps and what each reaches.

        Parameters
        ----------
        at
            What is prescribed when it begins.
        last
            s, duration of the last step of the loading before; None: steady.
        reached
            Where the pad is.
        how
            Finely.
        """
        raise NotImplementedError

    def jump(self, before: tuple[str, float] | None) -> tuple[str, str] | None:
        """What is wrong with its start, and what is allowed, after a leg that left `before`."""
        return None

    def leaves(self, target: tuple[str, float] | None) -> tuple[str, float] | None:
        """The key and value that are prescribed after it, if those before it were `target`."""
        if self.presses:
            return self.key, self.target
        return None if self.releases else target


#: key in a scene -> leg
LEGS: dict[str, type[Leg]] = {}

_PUSH = ": the stimulus must press into the skin"
_EARLY = 0.25
"""Of a press, in which the contact grows as the root of what has passed, and a curve through few of
its states would be off.
"""


def _ramp(
    kept: str, start: float, end: float, speed: float | None, at: Goal, how: Stepping
) -> tuple[np.ndarray, list[Goal]]:
    """The `path` of a leg that takes the force or the depth (`kept`) from one value to another;
    steady without a speed.
    """
    count = how.increments if speed is None else how.steps
    values = [start + (end - start) * k / count for k in range(1, count)] + [end]
    goals = [Goal(distance=at.distance, **{kept: value}) for value in values]
    return np.full(count, STEADY if speed is None else abs(end - start) / speed / count), goals


class PressToForce(Leg):
    """Press until the force is reached."""

    presses = True
    early = _EARLY

    press_to_force: quantity("force", note=_PUSH)
    """Normal force at the end of the leg."""
    rate: quantity("force_rate", note=_PUSH) | None = None
    """Rate of the force; left out for the steady state."""

    speed: ClassVar[None] = None

    @property
    def force(self) -> float:
        """Normal force at the end, N."""
        return self.press_to_force

    def path(self, at, last, reached, how):
        length = how.contact_length
        rate = self.rate and self.rate / length
        return _ramp("force", reached.force, self.press_to_force / length, rate, at, how)


class PressToDepth(Leg):
    """Press until the indentation depth is reached."""

    presses = True
    early = _EARLY

    press_to_depth: quantity("length", note=_PUSH)
    """Depth of the stimulus below first touch at the end of the leg."""
    speed: quantity("speed", note=_PUSH) | None = None
    """Speed of the stimulus; left out for the steady state."""

    @property
    def depth(self) -> float:
        """Depth at the end, m."""
        return self.press_to_depth

    def path(self, at, last, reached, how):
        return _ramp("depth", reached.depth, self.press_to_depth, self.speed, at, how)


class Hold(Leg):
    """Keep what the leg before prescribed."""

    loads = False
    early = 0.0

    hold: Time
    """Duration."""

    speed: ClassVar[None] = None

    def path(self, at, last, reached, how):
        even = self.hold / how.steps
        sizes = np.array([self.hold])
        if how.timed:
            sizes = geometric(self.hold, how.steps, min(last or even, even))
        return sizes, [at] * len(sizes)


class Lift(Leg):
    """Let the finger go: raise the stimulus to where it no more than touches the undeformed skin; a
    hold then is recovery.
    """

    needs_contact = releases = True

    lift: quantity("speed", note=_PUSH, words=("steady",))
    """Speed of the stimulus, or steady for a release so slow that all is relaxed."""

    @property
    def speed(self) -> float | None:
        """Speed of the stimulus, m/s; None for the steady state."""
        return None if self.lift == "steady" else self.lift

    def path(self, at, last, reached, how):
        return _ramp("depth", reached.depth, reached.touching, self.speed, at, how)


class Follow(Leg):
    """Press as a table says: depth or force over time, as an instrument writes them."""

    presses = True
    internal: ClassVar = frozenset({"course"})
    follows: ClassVar = {"table": ("course",)}

    table: Path | None
    """CSV file with the columns `time (s)` and `depth (mm)` or `force (gf)`, or other units in
    them.
    """
    course: SkipJsonSchema[Course]

    speed: ClassVar[None] = None
    rate: ClassVar[None] = None

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Reads the course from the file."""
        if "course" not in data:
            data["table"], data["course"] = read_file(data, "table", context, read_course)
        return data

    @field_serializer("table")
    def _named(self, table: Path | None) -> str | None:
        return table and table.name

    @property
    def force(self) -> float | None:
        """Largest force, N, of a course of force."""
        return max(self.course.values) if self.course.kept == "force" else None

    @property
    def depth(self) -> float | None:
        """Largest depth, m, of a course of depth."""
        return max(self.course.values) if self.course.kept == "depth" else None

    def jump(self, before):
        kept, start = self.course.kept, self.course.values[0]
        if before is None or before[0] != self.leaves(None)[0]:
            return None
        if abs(start - before[1]) <= _APART * max(self.course.values):
            return None
        dimension = "length" if kept == "depth" else "force"
        starts, there = (format_quantity(value, dimension) for value in (start, before[1]))
        return f"starts at {starts}, where the finger is at {there}", f"a first row at {there}"

    @property
    def quickest(self) -> float:
        """How long (s) its whole load would take at its fastest."""
        times, values = np.array(self.course.times), np.array(self.course.values)
        return float(values.max() / np.max(np.abs(np.diff(values)) / np.diff(times)))

    def path(self, at, last, reached, how):
        kept, times, values = self.course.kept, *map(np.array, self.course[:2])
        if kept == "force":  # under no force at all there is no depth
            values = np.maximum(values, _LEAST_FORCE * values.max()) / how.contact_length
        sizes: list[float] = []
        ends: list[float] = []
        before = getattr(reached, kept)
        for duration, value in zip(np.diff(times), values[1:], strict=True):
            share = abs(value - before) / values.max()
            count = max(1, round(how.steps * share)) if how.timed else 1
            first = sizes[-1] if sizes else duration / count
            if share < _UNCHANGED and how.timed:  # what is held relaxes ever more slowly
                count = max(count, how.steps)
                sizes += geometric(duration, count, min(first, duration / count)).tolist()
            else:
                sizes += [duration / count] * count
            ends += [before + (value - before) * k / count for k in range(1, count)]
            ends.append(float(value))
            before = value
        goals = [Goal(distance=at.distance, **{kept: end}) for end in ends]
        return np.array(sizes), goals

    def leaves(self, target):
        return f"press_to_{self.course.kept}", self.course.values[-1]


_APART = 0.02
"""Of the largest value of a course, by which it may start beside where the leg before ended."""
_LEAST_FORCE = 1e-3
"""Of the largest force of a course: less is taken for this."""
_UNCHANGED = 0.01
"""Of the largest value of a course: a piece that changes by less is held."""


class Slide(Leg):
    """Stroke the skin: the pad moves along the surface while force or depth is kept."""

    needs_contact = strokes = True

    slide: quantity("length", "nonzero")
    """Distance the pad moves along x of the surface; negative towards its start."""
    speed: quantity("speed", note=": the sign of slide is its direction") | None = None
    """Speed along the surface; left out for a stroke so slow that all is relaxed."""
    keep: Literal["force", "depth"] = "force"
    """What is kept as it is when the stroke begins: the normal force, or the height of the
    surface.
    """

    @property
    def along(self) -> float:
        """Way along the surface, m."""
        return self.slide

    @property
    def kept(self) -> str:
        """What is kept on the way."""
        return self.keep

    def path(self, at, last, reached, how):
        places = how.way(at.distance, self.slide)
        value = getattr(at, self.keep)
        kept = {self.keep: getattr(reached, self.keep) if value is None else value}
        goals = [Goal(distance=float(place), **kept) for place in places]
        if self.speed is None:
            return np.full(len(places), STEADY), goals
        return np.abs(np.diff(places, prepend=at.distance)) / self.speed, goals

    def leaves(self, target):
        return target if target and target[0] == f"press_to_{self.keep}" else None


class StepAndRepeat(Leg):
    """Move on without stroking: lift, recover, press again to what the leg before reached, over and
    over.
    """

    needs_contact = fresh = True

    step: quantity("length", "nonzero")
    """Distance covered in all; negative towards the start of the surface."""
    every: Length
    """Distance from one indentation to the next."""

    speed: ClassVar[None] = None

    @model_validator(mode="after")
    def _check(self) -> StepAndRepeat:
        whole = format_quantity(abs(self.step), "length")
        count = abs(self.step) / self.every
        if count < 1 - 1e-9:
            raise Problem("is more than the whole distance", f"up to {whole}", ("every",))
        if count > MAXIMUM_STEPS:
            raise Problem(
                f"makes more than {MAXIMUM_STEPS} indentations", "a larger distance", ("every",)
            )
        if abs(count - round(count)) > 1e-6 * count:
            raise Problem(
                "does not divide the whole distance", f"a whole fraction of {whole}", ("every",)
            )
        return self

    @property
    def along(self) -> float:
        """Way along the surface, m."""
        return self.step

    def path(self, at, last, reached, how):
        count = round(abs(self.step) / self.every)
        places = [at.distance + self.step * k / count for k in range(1, count + 1)]
        return np.full(count, STEADY), [at._replace(distance=place) for place in places]


# --- programmes ---------------------------------------------------------------------------------

LEG_EXAMPLE = 'legs such as {press_to_force: "20 gf", rate: "40 gf/s"} and {hold: "2 s"}'


def _leg_of(value: Any) -> type[Leg]:
    """The kind of a leg, or of the mapping that describes one."""
    if isinstance(value, Leg):
        return type(value)
    if not isinstance(value, Mapping):
        raise Problem("is not a leg", LEG_EXAMPLE)
    kinds = [key for key in LEGS if key in value]
    if not kinds:
        first = next(iter(value), None)
        near = nearest(first, LEGS) if isinstance(first, str) else ""
        raise Problem(f"is not a known leg{near}", f"a leg of {', '.join(LEGS)}")
    if len(kinds) > 1:
        both = " and ".join(kinds)
        raise Problem(f"is two legs in one: {both}", "one of them in each entry of motion")
    return LEGS[kinds[0]]


def _check_motion(legs: Any) -> Any:
    if isinstance(legs, Mapping) and "table" in legs:  # a motion that is one table
        legs = [legs]
    if not listed(legs):
        raise Problem("is empty", LEG_EXAMPLE)
    return legs


_Motion = tuple[Annotated[Leg, OneOf(_leg_of, LEGS)], ...]
Motion = Annotated[_Motion, BeforeValidator(_check_motion, json_schema_input_type=_Motion | Follow)]
"""Field type: legs, one after the other."""


def check_programme(legs: Sequence[Leg], length: float = math.inf) -> None:
    """Refuses legs that make no sense one after the other, on a surface of `length` m; `Problem`
    with the key below motion.
    """
    last: tuple[str, float] | None = None
    way, pressed = 0.0, False
    for i, leg in enumerate(legs):
        way += leg.along
        wrong = None
        if i == 0 and not leg.presses:
            first = "a press_to_force or press_to_depth leg first"
            wrong = "comes before anything is pressed", first
        elif leg.needs_contact and not pressed:
            wrong = "comes when nothing is pressed any more", "a press before it, or a hold"
        elif abs(leg.along) > MAXIMUM_STROKE:
            wrong = "is too long a way", f"up to {MAXIMUM_STROKE:g} m"
        elif leg.along and math.isfinite(length) and not -1e-9 <= way <= length + 1e-9:
            end = format_quantity(length, "length")
            wrong = "leads off the surface", f"to stay from 0 mm to {end} along it"
        elif leg.presses and (leg.key, leg.target) == last:
            wrong = "is where the leg before ended", "another target, or a hold"
        else:
            wrong = leg.jump(last if i else (leg.leaves(None)[0], 0.0))
        if wrong:
            raise Problem(*wrong, (i, leg.key))
        last = leg.leaves(last)
        pressed = leg.presses or (pressed and not leg.releases)


def end_time(legs: Sequence[Leg]) -> float | None:
    """Duration of a programme, s, steady legs taking none; None if a change of control leaves it
    open.
    """
    time, at, reached, moved = 0.0, Goal(), Reached(0.0, 0.0), False
    for leg in legs:
        sizes, goals = leg.path(at, None, reached, Stepping(1, 1.0, False, None))
        time += float(sizes[~(sizes >= STEADY)].sum())
        at, moved = goals[-1], moved or leg.along != 0
        if leg.loads:  # what a leg does not prescribe is not known after it
            force, depth = (math.nan if value is None else value for value in at[:2])
            # where the skin is touched depends on the surface there
            touching = math.nan if moved else 0.0
            reached = Reached(0.0 if leg.releases else force, depth, touching)
    return None if math.isnan(time) else time


def geometric(duration: float, count: int, first: float) -> np.ndarray:
    """``count`` step sizes (s) that sum to ``duration``, start at ``first`` and grow by a constant
    ratio (never shrink).
    """
    many = count >= 500
    if count == 1 or first * count >= duration * (1 - 1e-9 * (count if many else 1)):
        return np.full(count, duration / count)
    most = (duration / first) ** (1 / (count - 1))  # or the last step alone were longer
    high = most * (1 + 1e-12) if many else 1 + most
    from scipy.optimize import brentq  # a third of a second

    ratio = brentq(lambda q: first * (q**count - 1) / (q - 1) - duration, 1 + 1e-9, high)
    steps = first * ratio ** np.arange(count)
    return steps * (duration / steps.sum())


def programme(
    legs: Sequence[Leg],
    *,
    steps: int,
    contact_length: float,
    timed: bool = True,
    snapshots: Sequence[float] = (),
    present: Callable[[], tuple[float, ...]] | None = None,
    slide_step: float | None = None,
    increments: int = 1,
    parts: Callable[[np.ndarray], np.ndarray] | None = None,
    stride: int = 1,
    every: int = 1,
) -> Iterator[Step]:
    """Steps of a motion programme, leg by leg.

    Parameters
    ----------
    legs
        SI, newtons.
    steps
        Per leg.
    contact_length
        m, turns N into N/m.
    timed
        Does time matter? If not, a press is load increments and a hold one step.
    snapshots
        Times (s) at which a step must end.
    present
        Asked when a leg begins for what has been :class:`Reached` so far, which a change between
        force and depth control needs, and a lift; without it such a leg is taken to start from
        zero, and a lift to end there.
    slide_step
        m, longest step of a slide; without it a slide has ``steps`` of them.
    increments
        Of a steady press. Without friction its end does not depend on them.
    parts
        Into how many (k,) the longest steps of a slide are cut by outputs, by their place (k,) m
        along the surface. Where it is given, states need to be found only at the end of a slide and
        at snapshots.
    stride
        So many steps of a leg are made one, but for those that press anew.
    every
        Of a press or hold that takes time, a state must be found at one of so many outputs, once
        the early ones are over, and at snapshots.
    """
    how = Stepping(steps, contact_length, timed, slide_step, increments, parts)
    time, at, last, wanted = 0.0, Goal(None, None, 0.0), None, sorted(snapshots)
    for number, leg in enumerate(legs):
        reached = Reached(*present()) if present else Reached(at.force or 0.0, at.depth or 0.0)
        sizes, goals = leg.path(at, last, reached, how)
        if leg.loads:
            last = float(sizes[-1]) if sizes[-1] < STEADY else None
        if stride > 1 and not leg.fresh:
            sizes, goals = _joined(sizes, goals, stride)
        passes = leg.strokes and parts is not None
        for count, (dt, goal) in enumerate(zip(sizes, goals, strict=True), start=1):
            begin, time = time, time + (float(dt) if dt < STEADY else 0.0)
            for cut in wanted[
                bisect_right(wanted, begin + 1e-9 * time) : bisect_left(wanted, time * (1 - 1e-9))
            ]:
                at = _between(at, goal, (cut - begin) / (time - begin))
                yield Step(number, cut, cut - begin, *at)
                begin = cut
            left, early = len(goals) - count, count <= leg.early * len(goals)
            needed = not left if passes else early or dt >= STEADY or left % every == 0
            solved = bool(needed or among(wanted, time))
            yield Step(
                number,
                time,
                time - begin if dt < STEADY else STEADY,
                *goal,
                fresh=leg.fresh,
                solved=solved,
            )
            at = goal


def apart(times: np.ndarray) -> np.ndarray:
    """Times (n,) s that do not fall, made to rise: states at the same time stand :data:`INSTANT`
    apart, in their order.
    """
    out = np.array(times, float)
    for k in range(1, len(out)):
        least = out[k - 1] + max(INSTANT, 4 * np.spacing(out[k - 1]))
        out[k] = max(out[k], least)
    return out


def among(times: Sequence[float], time: float) -> bool:
    """Is ``time`` one of ascending ``times`` (s), but for rounding?"""
    next_one = bisect_left(times, time * (1 - 1e-9))
    return next_one < len(times) and times[next_one] <= time * (1 + 1e-9)


def _joined(sizes: np.ndarray, goals: list[Goal], stride: int) -> tuple[np.ndarray, list[Goal]]:
    """Durations (s) and goals of a leg's steps when so many are made one; the last may be of
    fewer.
    """
    starts = np.arange(0, len(goals), stride)
    ends = np.minimum(starts + stride, len(goals)) - 1
    return np.minimum(np.add.reduceat(sizes, starts), STEADY), [goals[k] for k in ends]


def _between(before: Goal, after: Goal, share: float) -> Goal:
    ways = zip(before, after, strict=True)
    return Goal(*(b if None in (a, b) else a + share * (b - a) for a, b in ways))

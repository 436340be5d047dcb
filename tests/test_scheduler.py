"""Calls at steps to come: their order, their errors, and what may be done in them."""

import gc
import weakref
from dataclasses import dataclass, field

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

import osgode as oo

DELAYS, PRIORITIES = st.integers(1, 9), st.integers(-2, 2)


def world_with(count):
    """A World with so many bodies in a space."""
    world = oo.World(name="world")
    space = world.attach(oo.HashSpace(name="space"))
    bodies = [space.attach(oo.Body(name=f"body{k}", position=(2 * k, 0, 0))) for k in range(count)]
    for body in bodies:
        body.attach(oo.Placeable()).attach(oo.Sphere(0.5))
    return world, space, bodies


def raised_by(act):
    """The errors that a call lets out, taken out of their group."""
    try:
        act()
    except ExceptionGroup as group:
        return list(group.exceptions)
    except Exception as error:  # noqa: BLE001 - whatever it is
        return [error]
    return []


@given(st.lists(st.tuples(DELAYS, PRIORITIES), max_size=30), st.integers(1, 4))
def test_calls_come_by_step_priority_and_order(wanted, chunk):
    """The order is that of a list sorted by due step, falling priority, and order of scheduling."""
    world, _, (body,) = world_with(1)
    made = []
    for number, (delay, priority) in enumerate(wanted):
        body.schedule(lambda node, number=number: made.append((world.steps, number)), delay, priority)
    while world.steps < 10:
        world.step(chunk)
    expected = sorted((delay, -priority, number) for number, (delay, priority) in enumerate(wanted))
    assert made == [(delay, number) for delay, _, number in expected]


@given(
    st.lists(st.tuples(DELAYS, PRIORITIES, st.integers(0, 5)), max_size=12),
    st.lists(st.integers(1, 7), min_size=1, max_size=6),
)
def test_many_steps_in_one_call(wanted, parts):
    """However the steps are divided into calls of `step`, the same calls are made at the same steps."""
    logs = []
    for counts in ([sum(parts)], parts, [1] * sum(parts)):
        world, _, (body,) = world_with(1)
        log = []
        for number, (delay, priority, repeats) in enumerate(wanted):
            left = [repeats]

            def call(node, number=number, left=left, world=world, log=log):
                log.append((world.steps, number, node.position))
                left[0] -= 1
                return left[0] >= 0

            body.schedule(call, delay, priority)
        for count in counts:
            world.step(count)
        logs.append((log, world.steps))
    assert logs[0] == logs[1] == logs[2]


@dataclass(order=True)
class Entry:
    """What the model knows of a call."""

    due: int
    rank: int
    number: int
    node: int = field(compare=False)
    delay: int = field(compare=False)
    repeats: int = field(compare=False)
    fails: bool = field(compare=False)
    label: int = field(compare=False)


class SchedulerMachine(RuleBasedStateMachine):
    """Schedules, cancels, takes nodes out and back, and steps; a sorted list says what has to come out."""

    @initialize()
    def begin(self):
        self.world, self.space, self.bodies = world_with(3)
        self.other = self.world.attach(oo.SimpleSpace())
        self.entries, self.calls, self.number, self.label = [], {}, 0, 0
        self.made, self.expected = [], []

    def _here(self, index):
        return self.bodies[index].is_live

    @rule(node=st.integers(0, 2), delay=DELAYS, priority=PRIORITIES, repeats=st.integers(0, 3), fails=st.booleans())
    def schedule(self, node, delay, priority, repeats, fails):
        if not self._here(node):
            with pytest.raises(oo.StateError, match=f"body{node}"):
                self.bodies[node].schedule(print)
            return
        label, left = self.label, [repeats]

        def call(told):
            assert told is self.bodies[node]
            self.made.append((self.world.steps, label))
            left[0] -= 1
            if left[0] < 0 and fails:
                raise ValueError(label)
            return left[0] >= 0

        self.calls[label] = self.bodies[node].schedule(call, delay, priority)
        self.number += 1
        due = self.world.steps + delay
        self.entries.append(Entry(due, -priority, self.number, node, delay, repeats, fails, label))
        self.label += 1

    @precondition(lambda self: self.calls)
    @rule(data=st.data())
    def cancel(self, data):
        label = data.draw(st.sampled_from(sorted(self.calls)))
        self.calls[label].cancel()
        self.entries = [entry for entry in self.entries if entry.label != label]

    @rule(node=st.integers(0, 2))
    def leave_or_come(self, node):
        body = self.bodies[node]
        if self._here(node):
            body.parent.detach(body)
            self.entries = [entry for entry in self.entries if entry.node != node]
        else:
            self.space.attach(body)

    @rule(node=st.integers(0, 2))
    def move_within(self, node):
        body = self.bodies[node]
        if self._here(node):
            body.move_to(self.other if body.parent is self.space else self.space)

    @rule(count=st.integers(0, 12))
    def step(self, count):
        before = self.world.steps
        errors = raised_by(lambda: self.world.step(count))
        failed = []
        for now in range(before + 1, before + count + 1):
            while self.entries and (entry := min(self.entries)).due <= now:
                self.entries.remove(entry)
                self.expected.append((now, entry.label))
                entry.repeats -= 1
                if entry.repeats >= 0:
                    self.number += 1
                    entry.due, entry.number = now + entry.delay, self.number
                    self.entries.append(entry)
                elif entry.fails:
                    failed.append((entry.label, entry.node))
            if failed:
                assert self.world.steps == now, "the steps after the one that failed are not done"
                break
        assert [error.args[0] for error in errors] == [label for label, _ in failed]
        for error, (_, node) in zip(errors, failed, strict=True):
            assert any(f"world/{self.bodies[node].parent.name or 'SimpleSpace'}" in n for n in error.__notes__)
            assert any(f"Body 'body{node}'" in note for note in error.__notes__)

    @invariant()
    def agrees(self):
        assert self.made == self.expected
        pending = {label for label, call in self.calls.items() if call.pending}
        assert pending == {entry.label for entry in self.entries}
        for entry in self.entries:
            call = self.calls[entry.label]
            assert (call.due, call.delay, call.priority) == (entry.due, entry.delay, -entry.rank)


SchedulerMachine.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestSchedulerMachine = SchedulerMachine.TestCase


def test_a_call_may_take_its_own_node_out():
    """A node that leaves in its call is not called again, though it wished for that; the World goes on."""
    world, space, (body, other) = world_with(2)
    heard = []

    def go(node):
        heard.append("gone")
        space.detach(node)
        return True

    call = body.schedule(go)
    body.schedule(lambda node: heard.append("never"), 1, -1)
    other.schedule(lambda node: heard.append("other"), 1, -2)
    world.step(3)
    assert heard == ["gone", "other"]
    assert not call.pending
    assert body.world is None


def test_out_and_in_again_within_a_call():
    """Leaving drops the call for good, also for a node that comes back within the same call."""
    world, space, (body,) = world_with(1)
    heard = []

    def away_and_back(node):
        heard.append(world.steps)
        space.attach(space.detach(node))
        return True

    call = body.schedule(away_and_back)
    world.step(4)
    assert heard == [1]
    assert not call.pending


def test_a_call_may_do_anything_to_the_tree():
    """Destroying others, adding bodies, scheduling more, cancelling what is due in this very step."""
    world, space, (body, doomed, friend) = world_with(3)
    heard = []
    late = friend.schedule(lambda node: heard.append("cancelled"), 1, -5)

    def act(node):
        space.detach(doomed)
        late.cancel()
        new = space.attach(oo.Body(position=(0, 9, 0)))
        new.attach(oo.Placeable()).attach(oo.Sphere(0.2))
        new.schedule(lambda child: heard.append((world.steps, "new", child.is_live)))
        node.position = (0, 50, 0)

    body.schedule(act)
    doomed.schedule(lambda node: heard.append("doomed"), 1, -1)
    world.step(3)
    assert heard == [(2, "new", True)]
    assert len(world.bodies) == 3
    assert body.position.y > 49


def test_the_world_itself_can_be_told():
    """A World schedules as any other node; a step inside of a call is refused and reported."""
    world = oo.World(name="earth")
    world.schedule(lambda node: node.step())
    with pytest.raises(oo.StateError, match="inside a step") as caught:
        world.step()
    assert "earth" in str(caught.value.__notes__)
    world.step()
    assert world.steps == 2


def test_errors_lose_nothing():
    """All calls of a step are made, all errors come out with node and path, and the rest stays scheduled."""
    world, _, (body, other) = world_with(2)
    heard = []

    def fail(node):
        raise ValueError(node.name)

    def repeat(node):
        heard.append(world.steps)
        return True

    failing = body.schedule(fail)
    other.schedule(fail, priority=-1)
    other.schedule(repeat, priority=-2)
    body.schedule(heard.append, 3)
    with pytest.raises(ExceptionGroup) as caught:
        world.step(5)
    assert world.steps == 1
    assert heard == [1]
    assert [str(error) for error in caught.value.exceptions] == ["body0", "body1"]
    assert "Body 'body0' (world/space/body0)" in caught.value.exceptions[0].__notes__[0]
    assert "Body 'body1' (world/space/body1)" in caught.value.exceptions[1].__notes__[0]
    assert not failing.pending, "what failed is not called again"
    world.step(2)
    assert heard == [1, 2, body, 3], "by priority"


def test_an_interrupt_goes_through():
    """KeyboardInterrupt leaves at once; what was due is made up for, and the World is usable."""
    world, _, (body,) = world_with(1)
    heard = []

    def interrupt(node):
        raise KeyboardInterrupt

    body.schedule(interrupt)
    body.schedule(lambda node: heard.append(world.steps), 1, -1)
    with pytest.raises(KeyboardInterrupt):
        world.step(4)
    assert world.steps == 1
    world.step()
    assert heard == [2]


def test_listeners_hear_before_scheduled_calls():
    """What happened in the step is told first, then comes what was scheduled."""
    world, space, (body, other) = world_with(2)
    world.gravity = (0, 0, 0)
    world.collide(space)
    other.position = (0.9, 0, 0)
    heard = []
    body.on_touch(lambda touch: heard.append("touch"))
    body.schedule(lambda node: heard.append("scheduled"))
    world.step()
    assert heard == ["touch", "scheduled"]


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ({"delay": 0}, "delay"),
        ({"delay": -1}, "delay"),
        ({"delay": 1.5}, "delay"),
        ({"delay": "soon"}, "delay"),
        ({"delay": True}, "delay"),
        ({"delay": 10**12}, "delay"),
        ({"priority": 0.5}, "priority"),
        ({"priority": float("nan")}, "priority"),
        ({"seconds": -1.0}, "seconds"),
        ({"seconds": float("inf")}, "seconds"),
        ({"delay": 3, "seconds": 1.0}, "either delay or seconds"),
        ({"callback": 3}, "callback"),
    ],
)
def test_bad_schedules_are_refused(arguments, word):
    """A wrong value is named with its node, and nothing is scheduled."""
    world, _, (body,) = world_with(1)
    with pytest.raises(oo.FieldError, match=word) as caught:
        body.schedule(**{"callback": print} | arguments)
    assert "body0" in str(caught.value)
    assert len(world._agenda) == 0


def test_scheduling_needs_a_world():
    """Outside of a World there are no steps."""
    with pytest.raises(oo.StateError, match=r"Body 'alone'.*schedule"):
        oo.Body(name="alone").schedule(print)


@pytest.mark.parametrize(("seconds", "steps"), [(0.0, 1), (0.001, 1), (0.05, 5), (0.054, 5), (0.056, 6), (1.0, 100)])
def test_seconds_are_rounded_to_steps(seconds, steps):
    """A time is the nearest number of steps, one at least."""
    world, _, (body,) = world_with(1)
    world.step_size = 0.01
    world.step(2)
    call = body.schedule(print, seconds=seconds)
    assert call.due == 2 + steps
    assert call.delay == steps


def test_a_call_tells_of_itself():
    """What is asked of a call can't be set: a delay of 0 would never end."""
    _world, _, (body,) = world_with(1)
    call = body.schedule(print, 7, 2)
    assert (call.due, call.delay, call.priority, call.pending) == (7, 7, 2, True)
    assert "body0" in repr(call)
    assert "after step 7" in repr(call)
    for name in ("due", "delay", "priority", "pending"):
        with pytest.raises(AttributeError):
            setattr(call, name, 0)
    call.cancel()
    call.cancel()
    assert not call.pending
    assert "done" in repr(call)


def test_cancelled_from_within():
    """A call that cancels itself is not made again, though it returns True."""
    world, _, (body,) = world_with(1)
    heard = []

    def once(node):
        heard.append(world.steps)
        call.cancel()
        return True

    call = body.schedule(once)
    world.step(3)
    assert heard == [1]


@pytest.mark.parametrize("answer", [1, "yes", np.True_, None, False])
def test_only_true_repeats(answer):
    """What a callback happens to return doesn't make it a controller; only True does."""
    world, _, (body,) = world_with(1)
    heard = []

    def call(node):
        heard.append(world.steps)
        return answer

    body.schedule(call)
    world.step(3)
    assert heard == [1]


def test_calls_stay_on_a_move_within_the_world():
    """To another space of the same World the calls go along; to another World they don't."""
    world, _, (body,) = world_with(1)
    other = world.attach(oo.SimpleSpace())
    heard = []
    body.schedule(lambda node: heard.append("kept"), 2)
    body.move_to(other)
    world.step(2)
    assert heard == ["kept"]
    call = body.schedule(lambda node: heard.append("lost"))
    elsewhere = oo.World()
    body.move_to(elsewhere)
    assert not call.pending
    world.step()
    elsewhere.step()
    assert heard == ["kept"]


def test_calls_of_everything_below_are_dropped():
    """When a space leaves, the calls of what stands in it go too."""
    world, space, (body,) = world_with(1)
    geom = body.geoms[0]
    calls = [node.schedule(print) for node in (space, body, geom)]
    world.detach(space)
    assert not any(call.pending for call in calls)
    assert len(world._agenda) == 0
    world.step(2)


def test_a_dropped_world_takes_its_calls_along():
    """Calls that refer to their World and their nodes don't keep it."""
    world, _, (body,) = world_with(1)
    ref = weakref.ref(world)
    body.schedule(lambda node, world=world: world.steps, 100)
    world.schedule(lambda node, body=body: body.position, 100)
    calls = [body.schedule(print, 5), world.schedule(lambda node, world=world: None)]
    del world, _
    gc.collect()
    assert ref() is None
    assert not body.is_live
    for call in calls:
        assert not call.pending
        assert repr(call)
        call.cancel()
    with pytest.raises(oo.StateError):
        body.schedule(print)


def test_what_has_left_is_not_kept():
    """Nodes that left with far calls pending are not kept by their old World, nor much of their calls."""
    world, space, _ = world_with(1)
    refs = []
    for _ in range(500):
        body = space.attach(oo.Body())
        body.schedule(print, 10**9)
        refs.append(weakref.ref(body))
        space.detach(body)
    del body
    gc.collect()
    assert not any(ref() for ref in refs)
    assert len(world._agenda._queue) <= 65


def test_cancelling_far_calls_keeps_the_others():
    """Clearing out what was cancelled leaves order and calls of the others as they are."""
    world, _, (body,) = world_with(1)
    heard = []
    calls = [body.schedule(lambda node, k=k: heard.append(k), 1 + k % 7, k % 3) for k in range(400)]
    for k, call in enumerate(calls):
        if k % 5:
            call.cancel()
    world.step(8)
    left = range(0, 400, 5)
    assert heard == sorted(left, key=lambda k: (k % 7, -(k % 3), k))


def falling(scheduled):
    """Bodies that fall on one another, as tables after 200 steps; with calls that do nothing, or without."""
    world, space, bodies = world_with(6)
    world.collide(space)
    floor = world.attach(oo.SimpleSpace())
    floor.attach(oo.Plane())
    world.collide(space, floor)
    for k, body in enumerate(bodies):
        body.position = (0.1 * k, 1 + 1.1 * k, 0.05 * k)
    if scheduled:
        for body in bodies:
            body.schedule(lambda node: True, 1)
            body.schedule(lambda node: True, 3, 5)
    world.step(200)
    return world.poses.tobytes() + world.previous_poses.tobytes() + world.velocities.tobytes()


def test_calls_that_do_nothing_change_no_bit():
    """Dividing a call of `step` for the sake of scheduled calls leaves the physics the same."""
    assert falling(scheduled=True) == falling(scheduled=False)

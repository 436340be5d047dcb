"""The demo game: everything in one place, and somebody to be in it."""

from __future__ import annotations

import logging
import math
from functools import partial

import numpy as np

import osgode as oo
from osgode.engine import AppConfig, CompositeObject, ControllableObject, EventsConfig, Scene, VideoConfig
from osgode.examples.game.car import Car
from osgode.examples.game.driver import Driver, Patrol
from osgode.examples.game.flail import Flail
from osgode.examples.game.gun import ConstructorGun
from osgode.examples.game.hud import GameHud
from osgode.examples.game.level import furnish
from osgode.examples.game.player import Player
from osgode.examples.game.rocket import RocketLauncher
from osgode.examples.game.track import Track
from osgode.examples.game.weapon import Weapon
from osgode.examples.runner import look

log = logging.getLogger("osgode.game")

BINDINGS = {
    "weapon_1": "1",
    "weapon_2": "2",
    "weapon_3": "3",
    "fire_left": "mouse_left",
    "fire_right": "mouse_right",
    "controls_window": "f1",
    "hints_window": "f2",
    "upright": "r",
}
"""What the game has beside the actions of every scene."""
START = oo.Vec3(0.0, 0.0, 3.0)
"""Where the player begins."""
TRACK = oo.Vec3(34.0, 0.0, 6.0)
"""The start line of the track."""
STACKS = ((-1.5, -13.0), (0.8, -17.0), (-2.2, -19.5))
"""x and z of the stacks of crates."""
CRATE, CRATE_MASS = 0.6, 12.0
"""Edge, metres, and mass, kg."""
PATROL = ((-4.6, 0.0, -3.0), (-4.6, 0.0, -23.0), (2.9, 0.0, -23.0), (2.9, 0.0, -3.0))
"""Where the walker goes."""
ASIDE = 0.55
"""How far to the right the camera looks over the shoulder, metres."""
REACH = 4.0
"""How near a car must be to get into, metres."""
DEEPEST, FARTHEST = -20.0, 1500.0
"""What is lower, or farther from the middle, has fallen out of the world, metres."""
ITERATIONS = 30
"""Of the quick solver: the hanging bridge and the flail want more than the 20 of a heap."""
RESTING = (0.1, 0.2)
"""What is slower, m/s and rad/s, lies still: in a stack everything trembles a little."""
AVERAGED, RESTS = 10, 30
"""Over how many steps these speeds are averaged, and for how many it must lie still: no ball rests where it turns."""


def config(**video: object) -> AppConfig:
    """The game's settings; keywords are those of `VideoConfig`."""
    settings: dict[str, object] = {"title": "osgode", "size": (1024, 640), **video}
    return AppConfig(
        events=EventsConfig(bindings=BINDINGS, capture=True),
        video=VideoConfig(**settings),  # type: ignore[arg-type]
    )


class Game(Scene):
    """House, course, track, cars, weapons, crates, a walker, and the player."""

    def populate_world(self) -> None:
        """Put everything into the World, and the camera onto the player."""
        self.world.iterations = ITERATIONS
        self._let_rest()
        grass = look("grass", (0.9, 0.95, 0.85), scale=4.0, shine=0.0)
        self.static.attach(oo.Plane(material="earth", name="ground", appearance=grass))
        self.parts = furnish(self.dynamic, self.static)
        self.track = Track(TRACK)
        self.static.attach(self.track)
        self.crates: list[oo.Body] = []
        for x, z in STACKS:
            self._stack(x, z)
        self.car = self.dynamic.attach(Car(*self.track.spot(4.0, -2.5), name="red car"))
        self.rival = self.dynamic.attach(Car(*self.track.spot(12.0, 2.5), colour=(0.1, 0.25, 0.75), name="blue car"))
        self.driver = Driver(self.rival, self.track.line)
        self.driver.begin()
        self._lay_out_weapons()
        self.walker = self.dynamic.attach(Player(PATROL[0], math.pi, name="walker"))
        Patrol(self.walker, PATROL, wait=1.0).begin()
        self.player = self.dynamic.attach(Player(START))
        self.camera.aside = ASIDE
        self.camera.ride(self.player)
        cast = (self.player, self.walker, self.car, self.rival, *self.weapons)
        self.homes: dict[oo.PhysicsNode, oo.Pose] = {thing: thing.pose for thing in cast}
        """Where what can't be done without began."""
        self.world.schedule(lambda _: self.catch_the_lost(), seconds=1.0)

    def _let_rest(self) -> None:
        """What lies still costs nothing: it falls asleep until something touches it."""
        world = self.world
        world.auto_disable = True
        world.auto_disable_linear_threshold, world.auto_disable_angular_threshold = RESTING
        world.auto_disable_samples, world.auto_disable_steps = AVERAGED, RESTS

    def _stack(self, x: float, z: float) -> None:
        """A pyramid of crates."""
        looks = look("crate")
        for row in range(4):
            for k in range(4 - row):
                place = (x + (k - (3 - row) / 2) * (CRATE + 0.02), CRATE * (row + 0.5), z)
                # A full shot would carry it through walls.
                crate = oo.Body(name=f"crate {len(self.crates)}", position=place, tunnelling="sweep")
                crate.attach(oo.Placeable()).attach(
                    oo.Box((CRATE, CRATE, CRATE), material="wood", mass=CRATE_MASS, appearance=looks)
                )
                self.crates.append(self.dynamic.attach(crate))

    def _lay_out_weapons(self) -> None:
        """Where the hints say."""
        house, course = self.parts.house, self.parts.course
        self.weapons = (
            ConstructorGun(house.table + oo.Vec3(0.0, 0.12, 0.0)),
            RocketLauncher(course.lookout + oo.Vec3(0.0, 0.2, 0.0)),
            Flail(course.island + oo.Vec3(0.0, 0.3, 0.0)),
        )
        for weapon in self.weapons:
            self.dynamic.attach(weapon)

    def populate_hud(self) -> None:
        """Figures, crosshair, windows."""
        self.board = GameHud(self.hud)

    # -- keys

    def bind_actions(self) -> None:
        """What every scene has, and what this game adds."""
        super().bind_actions()
        events, arsenal = self.events, self.player.arsenal
        for slot in (1, 2, 3):
            events.on_press(f"weapon_{slot}")(partial(arsenal.switch, slot))
        for button in ("left", "right"):
            events.on_press(f"fire_{button}")(partial(self._press, button))
        events.on_press("upright")(self._put_upright)

        @events.on_press("controls_window")
        def controls_window() -> None:
            self.board.toggle(self.board.controls)

        @events.on_press("hints_window")
        def hints_window() -> None:
            self.board.toggle(self.board.hints)

    def _press(self, button: str) -> None:
        if self.camera.carrier is self.player:
            self.player.arsenal.press(button)

    def _put_upright(self) -> None:
        carrier = self.camera.carrier
        if isinstance(carrier, Car):
            carrier.put_upright()

    def each_frame(self) -> None:
        """Buttons that came up shoot where the camera looks."""
        if self.camera.carrier is self.player:
            for button in ("left", "right"):
                if self.events.released(f"fire_{button}"):
                    self.player.arsenal.release(button, self.camera.aiming_ray)

    def attach(self) -> None:
        """Get into the nearest car, or out of the one that is ridden."""
        carrier = self.camera.carrier
        if isinstance(carrier, Car):
            self.get_out(carrier)
        elif carrier is self.player:
            place = self.player.torso.position
            near = [car for car in (self.car, self.rival) if car.hull.position.distance(place) < REACH]
            if near:
                self.get_in(min(near, key=lambda car: car.hull.position.distance(place)))

    def get_in(self, car: Car) -> None:
        """The player leaves the simulation and rides on the car."""
        if car is self.rival:
            self.driver.end()
        self.camera.ride(car, "delta")
        self.player.leave()

    def get_out(self, car: Car) -> None:
        """The player stands beside the car; a car that has a driver of its own goes on."""
        feet = car.way_out()
        yaw = self.player.controls.yaw = self.heading(car)
        turn = oo.Quat.from_yaw_pitch_roll(yaw)
        self.player.enter(pose=oo.Pose(feet + oo.Vec3(0.0, self.player.reach, 0.0), turn))
        self.camera.ride(self.player)
        if car is self.rival:
            self.driver.begin()

    @staticmethod
    def heading(thing: ControllableObject) -> float:
        """The yaw of where something's first body looks."""
        ahead = thing.main_body.vector_to_world((0.0, 0.0, -1.0))
        return math.atan2(-ahead.x, -ahead.z)

    # -- frames

    def update(self) -> None:
        """Say in the overlay what has become of everything."""
        super().update()
        clock, carrier = self.clock, self.camera.carrier
        pace = "paused" if clock.paused else "" if clock.speed == 1.0 else f"time x {clock.speed:g}"
        weapon = self.player.arsenal.in_hand if carrier is self.player else None
        speed = carrier.main_body.linear_velocity.length if carrier is not None else 0.0
        charge = 0.0 if weapon is None else max(weapon.charge(button) for button in ("left", "right"))
        if carrier is self.player and charge == 0.0:
            charge = self.player.charge
        self.board.show(
            frame_rate=clock.frame_rate,
            speed=speed,
            pace=pace,
            weapon="" if weapon is None else weapon.TITLE,
            charge=charge,
            damage=carrier.wheel_damage if isinstance(carrier, Car) else (),
        )

    def catch_the_lost(self) -> bool:
        """The floor of the world: what has fallen out of it is reported.

        The player, the walker, cars and weapons begin anew where they were; anything else is taken away.
        """
        poses = self.world.poses
        lost = (poses[:, 1] < DEEPEST) | (np.abs(poses[:, :3]).max(axis=1) > FARTHEST)
        bodies = self.world.bodies
        for thing in dict.fromkeys(_whole(bodies[row]) for row in np.flatnonzero(lost).tolist()):
            self._catch(thing)
        return True

    def _catch(self, thing: oo.Body | CompositeObject) -> None:
        if isinstance(thing, Weapon) and thing.held:
            return  # it comes along with whoever holds it
        body = thing if isinstance(thing, oo.Body) else thing.main_body
        kept = isinstance(thing, oo.Body) or thing in self.homes
        level = logging.WARNING if kept else logging.INFO  # a rocket shot into the sky is no fault
        log.log(level, "%s has fallen out of the world, at %s", thing.path, body.position)
        if isinstance(thing, CompositeObject):
            if thing in self.homes:
                thing.place(self.homes[thing], at_rest=True)
            else:
                thing.leave()
        elif thing.parent is not None:
            thing.parent.detach(thing)


def _whole(body: oo.Body) -> oo.Body | CompositeObject:
    """What a body is a part of; never only a wheel, or an arm."""
    return next((each for each in body.ancestors if isinstance(each, CompositeObject)), body)

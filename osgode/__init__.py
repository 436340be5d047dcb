"""A scene graph joined with the Open Dynamics Engine: rigid bodies as nodes of a tree."""

from osgode.assemblies.base import Assembly
from osgode.assemblies.chains import Chain, chain
from osgode.assemblies.ragdolls import Ragdoll, ragdoll
from osgode.assemblies.wheels import Wheel, suspension_wheel
from osgode.errors import (
    FieldError,
    MissingExtraError,
    ModelError,
    OsgodeError,
    ParameterError,
    PhysicsError,
    StateError,
    TreeError,
)
from osgode.graph.appearance import Appearance, Texture, load_texture
from osgode.graph.cull import CullVisitor
from osgode.graph.drawable import Drawable
from osgode.graph.frame import Bin, Drawer, Frame, Light, Lines, Rectangle, Sky, Sprites, Sun, Text, View
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.lights import PointLight, SpotLight
from osgode.graph.lines import LineSet
from osgode.graph.lod import LevelOfDetail, bounding_box
from osgode.graph.mesh import Mesh
from osgode.graph.models import Model, load_model
from osgode.graph.node import Group, Node
from osgode.graph.particles import Particles
from osgode.graph.picking import Pick
from osgode.graph.projection import Area, OverlayNode, Projection
from osgode.graph.shapes import (
    box_drawable,
    capsule_drawable,
    centre_of_mass_drawable,
    cylinder_drawable,
    sphere_drawable,
)
from osgode.graph.spray import DUST, FIRE, SMOKE, SPARKS, Spray
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform, Transform
from osgode.graph.visitors import UpdateVisitor, Visitor
from osgode.joints.ball import Ball
from osgode.joints.base import Joint
from osgode.joints.double import DoubleBall, DoubleHinge
from osgode.joints.events import LetGo, Reaction
from osgode.joints.fixed import Fixed
from osgode.joints.hinge import Hinge
from osgode.joints.hinge2 import Hinge2
from osgode.joints.marks import joint_marks
from osgode.joints.motors import AngularMotor, LinearMotor
from osgode.joints.plane2d import Plane2D
from osgode.joints.servo import Servo
from osgode.joints.slider import Slider
from osgode.joints.sliding import PR, PU, Piston
from osgode.joints.transmission import Transmission
from osgode.joints.universal import Universal
from osgode.mass import Mass
from osgode.materials import PUBLISHED, Surface, SurfaceTable, define_kind, define_material
from osgode.maths import Pose, Quat, QuatLike, Vec3, Vec3Like, look_at
from osgode.native import live_natives
from osgode.nodes.base import PhysicsNode
from osgode.nodes.body import Body
from osgode.nodes.centreofmass import CentreOfMass
from osgode.nodes.colliders import colliders
from osgode.nodes.convex import ConvexHull
from osgode.nodes.exports import StepTimings
from osgode.nodes.feedback import CollisionFeedback
from osgode.nodes.geom import Geom
from osgode.nodes.heightdata import HeightData
from osgode.nodes.heightfield import Heightfield
from osgode.nodes.hit import Closest, Hit, Sweep
from osgode.nodes.meshdata import MeshData
from osgode.nodes.placeable import Placeable
from osgode.nodes.plane import Plane
from osgode.nodes.primitives import Box, Capsule, Cylinder, Sphere
from osgode.nodes.queries import RayHits
from osgode.nodes.ray import Ray
from osgode.nodes.spaces import HashSpace, QuadTreeSpace, SimpleSpace, Space, SweepAndPruneSpace
from osgode.nodes.touch import Touch
from osgode.nodes.trimesh import Trimesh
from osgode.nodes.world import World
from osgode.scheduler import ScheduledCall

__version__ = "0.1.0"

__all__ = [
    "DUST",
    "FIRE",
    "PR",
    "PU",
    "PUBLISHED",
    "SMOKE",
    "SPARKS",
    "AngularMotor",
    "Appearance",
    "Area",
    "Assembly",
    "Ball",
    "Bin",
    "Body",
    "Box",
    "Capsule",
    "CentreOfMass",
    "Chain",
    "Closest",
    "CollisionFeedback",
    "ConvexHull",
    "CullVisitor",
    "Cylinder",
    "DoubleBall",
    "DoubleHinge",
    "Drawable",
    "Drawer",
    "FieldError",
    "Fixed",
    "Frame",
    "Geom",
    "Group",
    "HashSpace",
    "HeightData",
    "Heightfield",
    "Hinge",
    "Hinge2",
    "Hit",
    "Joint",
    "Leaf",
    "LetGo",
    "LevelOfDetail",
    "Light",
    "LineSet",
    "LinearMotor",
    "Lines",
    "Mass",
    "MatrixTransform",
    "Mesh",
    "MeshData",
    "MissingExtraError",
    "Model",
    "ModelError",
    "Node",
    "OsgodeError",
    "OverlayNode",
    "ParameterError",
    "Particles",
    "PhysicsError",
    "PhysicsNode",
    "Pick",
    "Piston",
    "Placeable",
    "Plane",
    "Plane2D",
    "PointLight",
    "Pose",
    "PositionAttitudeTransform",
    "Projection",
    "QuadTreeSpace",
    "Quat",
    "QuatLike",
    "Ragdoll",
    "Ray",
    "RayHits",
    "Reaction",
    "Rectangle",
    "ScheduledCall",
    "Servo",
    "SimpleSpace",
    "Sky",
    "Slider",
    "Space",
    "Sphere",
    "SpotLight",
    "Spray",
    "Sprites",
    "StateError",
    "StepTimings",
    "Sun",
    "Surface",
    "SurfaceTable",
    "Sweep",
    "SweepAndPruneSpace",
    "Switch",
    "Text",
    "Texture",
    "Touch",
    "Transform",
    "Transmission",
    "TreeError",
    "Trimesh",
    "Universal",
    "UpdateVisitor",
    "Vec3",
    "Vec3Like",
    "View",
    "Visitor",
    "Wheel",
    "World",
    "bounding_box",
    "box_drawable",
    "capsule_drawable",
    "centre_of_mass_drawable",
    "chain",
    "colliders",
    "cylinder_drawable",
    "define_kind",
    "define_material",
    "joint_marks",
    "live_natives",
    "load_model",
    "load_texture",
    "look_at",
    "ragdoll",
    "sphere_drawable",
    "suspension_wheel",
]

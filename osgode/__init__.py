"""A scene graph joined with the Open Dynamics Engine: rigid bodies as nodes of a tree."""

from osgode.errors import (
    FieldError,
    MissingExtraError,
    ModelError,
    OsgodeError,
    PhysicsError,
    StateError,
    TreeError,
)
from osgode.graph.appearance import Appearance, Texture, load_texture
from osgode.graph.cull import CullVisitor
from osgode.graph.drawable import Drawable
from osgode.graph.frame import Bin, Drawer, Frame, Rectangle, Sky, Sun, Text, View
from osgode.graph.leaf import Leaf, Switch
from osgode.graph.mesh import Mesh
from osgode.graph.models import Model, load_model
from osgode.graph.node import Group, Node
from osgode.graph.shapes import box_drawable, capsule_drawable, cylinder_drawable, sphere_drawable
from osgode.graph.transforms import MatrixTransform, PositionAttitudeTransform, Transform
from osgode.graph.visitors import UpdateVisitor, Visitor
from osgode.joints.ball import Ball
from osgode.joints.base import Joint
from osgode.joints.fixed import Fixed
from osgode.joints.hinge import Hinge
from osgode.joints.slider import Slider
from osgode.mass import Mass
from osgode.materials import PUBLISHED, Surface, SurfaceTable, define_kind, define_material
from osgode.maths import Pose, Quat, QuatLike, Vec3, Vec3Like, look_at
from osgode.native import live_natives
from osgode.nodes.base import PhysicsNode
from osgode.nodes.body import Body
from osgode.nodes.colliders import colliders
from osgode.nodes.convex import ConvexHull
from osgode.nodes.geom import Geom
from osgode.nodes.heightdata import HeightData
from osgode.nodes.heightfield import Heightfield
from osgode.nodes.meshdata import MeshData
from osgode.nodes.placeable import Placeable
from osgode.nodes.plane import Plane
from osgode.nodes.primitives import Box, Capsule, Cylinder, Sphere
from osgode.nodes.ray import Hit, Ray
from osgode.nodes.spaces import HashSpace, QuadTreeSpace, SimpleSpace, Space, SweepAndPruneSpace
from osgode.nodes.touch import Touch
from osgode.nodes.trimesh import Trimesh
from osgode.nodes.world import World

__version__ = "0.1.0"

__all__ = [
    "PUBLISHED",
    "Appearance",
    "Ball",
    "Bin",
    "Body",
    "Box",
    "Capsule",
    "ConvexHull",
    "CullVisitor",
    "Cylinder",
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
    "Hit",
    "Joint",
    "Leaf",
    "Mass",
    "MatrixTransform",
    "Mesh",
    "MeshData",
    "MissingExtraError",
    "Model",
    "ModelError",
    "Node",
    "OsgodeError",
    "PhysicsError",
    "PhysicsNode",
    "Placeable",
    "Plane",
    "Pose",
    "PositionAttitudeTransform",
    "QuadTreeSpace",
    "Quat",
    "QuatLike",
    "Ray",
    "Rectangle",
    "SimpleSpace",
    "Sky",
    "Slider",
    "Space",
    "Sphere",
    "StateError",
    "Sun",
    "Surface",
    "SurfaceTable",
    "SweepAndPruneSpace",
    "Switch",
    "Text",
    "Texture",
    "Touch",
    "Transform",
    "TreeError",
    "Trimesh",
    "UpdateVisitor",
    "Vec3",
    "Vec3Like",
    "View",
    "Visitor",
    "World",
    "box_drawable",
    "capsule_drawable",
    "colliders",
    "cylinder_drawable",
    "define_kind",
    "define_material",
    "live_natives",
    "load_model",
    "load_texture",
    "look_at",
    "sphere_drawable",
]

"""Types of the entries of scenes and problems, to annotate and to complete dicts with.

Written by `python/generate.py` from the JSON Schema of problems.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from typing_extensions import NotRequired

    from proboscis._part import Part

Quantity: TypeAlias = "float | str | np.number[Any]"
"""A number in SI units, or a text with a unit."""
Numbers: TypeAlias = "npt.NDArray[Any]"
"""An array in place of a list of numbers."""
Text: TypeAlias = "str | Part | PathLike[str]"
"""A text; a part stands for its name, a result for its folder."""


class Annulus(TypedDict):
    """A ring of triangles."""

    elements: Sequence[Division]
    """Elements from the inner edge to the outer one, a number or a list of layers, and around."""

    radii: Sequence[Quantity] | Numbers
    """Inner and outer radius, SI unit m."""


class Axes(TypedDict):
    """Two axes."""

    axes: Sequence[Sequence[float] | Numbers]
    """Directions of any length, perpendicular to each other: that of the parent, then that of the child."""


AxisName: TypeAlias = "Literal['x', 'y', 'z']"
"""An axis of the ground frame."""


class Axis(TypedDict):
    """An axis."""

    axis: Sequence[float] | Numbers
    """Direction, of any length."""


BlockLoadKind: TypeAlias = "Literal['traction', 'pressure', 'surface_charge', 'body_force']"
"""Kind of a load of an elastic block. Areas and volumes are those of the reference configuration but for a pressure that follows."""


class BodyMesh(TypedDict):
    """A surface from an STL file."""

    at: NotRequired[Sequence[Quantity] | Numbers]
    """Place of its origin, SI unit m; that of the ground frame where not written."""

    file: Text
    """STL file, binary or text; its path is relative to the scene file."""

    rotation: NotRequired[Rotation]
    """Rotation about its origin; where not written its axes are those of the ground frame."""

    unit: NotRequired[Quantity]
    """Length of its unit, SI unit m; 1 m where not written."""


class BoxShape(TypedDict):
    """A box, or a plate."""

    at: Sequence[Quantity] | Numbers
    """Centre, SI unit m."""

    axes: NotRequired[Sequence[Sequence[float] | Numbers]]
    """Directions of the edges of the first two lengths in the ground frame; x and y where not written."""

    radius: NotRequired[Quantity]
    """Radius of its edges, no more than half of the least length, SI unit m; sharp where not written."""

    size: Sequence[Quantity] | Numbers
    """Lengths of its edges, SI unit m."""


class Box(TypedDict):
    """A box."""

    size: Sequence[Quantity] | Numbers
    """Edge lengths along x, y, z, SI unit m."""


CapsuleShape = TypedDict(
    "CapsuleShape",
    {
        "from": "Sequence[Quantity] | Numbers",
        "radius": "Quantity",
        "to": "Sequence[Quantity] | Numbers",
    },
)
"""A capsule."""


class Circuit(TypedDict):
    """Circuit between a source and the electrodes of a muscle or a block: a resistor, a leak or both."""

    leakage: NotRequired[Quantity]
    """Resistance of a leak parallel to the electrodes, SI unit Ohm."""

    resistance: NotRequired[Quantity]
    """Resistance in series, SI unit Ohm; without it the electrodes have the voltage of the source."""


class ContactPlane(TypedDict):
    """A plane of a body."""

    at: Sequence[Quantity] | Numbers
    """A point of it, SI unit m."""

    body: NotRequired[Text]
    """Name of the body; the ground where not written."""

    normal: Sequence[float] | Numbers
    """Normal in the ground frame, of any length, towards the sphere."""


class ContactSphere(TypedDict):
    """A sphere of a body."""

    at: Sequence[Quantity] | Numbers
    """Centre, SI unit m."""

    body: Text
    """Name of the body, or `ground`."""

    radius: NotRequired[Quantity]
    """Radius, SI unit m; a point where not written."""


class Corners(TypedDict):
    """Two corners of a box."""

    max: Sequence[Quantity] | Numbers
    """Upper corner, SI unit m."""

    min: Sequence[Quantity] | Numbers
    """Lower corner, SI unit m."""


class Cylinder(TypedDict):
    """A cylinder."""

    axis: Sequence[float] | Numbers
    """Direction of the axis, of any length."""

    length: Quantity
    """Length along the axis, SI unit m."""

    radius: Quantity
    """Radius, SI unit m."""


Dielectric: TypeAlias = "Literal['first_order', 'ideal']"
"""Law by which the relative permittivity enters the energy."""


class Disc(TypedDict):
    """A disc of triangles."""

    elements: Division
    """Elements from the centre to the edge: a number, or a list of layers."""

    radius: Quantity
    """Radius, SI unit m."""


Division: TypeAlias = "int | Sequence[Layer]"
"""Division of a direction of a box."""


class ElasticSolid(TypedDict):
    """Elastic constants of a solid."""

    modulus: Quantity
    """Young's modulus, SI unit Pa."""

    poisson_ratio: float
    """Poisson ratio, up to 0.5."""


class Electrode(TypedDict):
    """An electrode: nodes of one potential, at exactly one of `face`, `plane`, `box`.

    Driven electrodes of one name are connected: they share the voltage `block.name`.
    """

    box: NotRequired[Corners]
    """All nodes in a box."""

    circuit: NotRequired[Circuit]
    """Circuit between its source and a driven electrode."""

    face: NotRequired[Text]
    """All nodes of a face."""

    name: Text
    """Name, unique in the block except for driven electrodes."""

    plane: NotRequired[Plane]
    """All nodes of a plane."""

    potential: Potential
    """Its potential."""


Element: TypeAlias = "Literal['hex8', 'hex8_q1p0', 'tet10', 'tet10_p2p0', 'membrane']"
"""Kind of element: its interpolation, and its treatment of volume."""


Fixed: TypeAlias = "Text | Held"
"""A face that is clamped, or a place that is held in some directions."""


class Function(TypedDict):
    """A function of time: exactly one of the four."""

    csv: NotRequired[SignalCsv]
    """The same, with times and values from columns of a CSV file."""

    ramp: NotRequired[Ramp]
    """Linear between two values, constant before and after."""

    sine: NotRequired[Sine]
    """A sine."""

    table: NotRequired[SignalTable]
    """Linear between values at times, constant before and after."""


class Gent(TypedDict):
    """Gent's law."""

    limit: float
    """Limit Jm of I₁ − 3, a positive ratio."""


class Grid(TypedDict):
    """A box cut into hexahedra, each of them into six tetrahedra where the kind of its elements is one of these."""

    corner: NotRequired[Sequence[Quantity] | Numbers]
    """Lower corner, SI unit m; the origin where not written."""

    elements: Sequence[Division]
    """Elements along x, y, z: a number, or a list of layers."""

    size: Sequence[Quantity] | Numbers
    """Edge lengths along x, y, z, SI unit m."""


class Held(TypedDict):
    """A `face`, `plane` or `box` whose nodes are held in some directions: a roller is held in one."""

    box: NotRequired[Corners]
    """All nodes in a box."""

    directions: NotRequired[Sequence[AxisName]]
    """Directions in which it is held; all three where not written."""

    face: NotRequired[Text]
    """All nodes of a face."""

    plane: NotRequired[Plane]
    """All nodes of a plane."""


class Law(TypedDict):
    """Law of elasticity: exactly one of the four. The `shear_modulus` of the material is that of small strains in each of them."""

    gent: NotRequired[Gent]
    """Gent's law, −μ/2 Jm ln(1 − (I₁ − 3)/Jm): it stiffens without bound towards a greatest stretch."""

    mooney_rivlin: NotRequired[MooneyRivlin]
    """Mooney and Rivlin's law, μ/2 [(1 − s)(I₁ − 3) + s (I₂ − 3)]."""

    ogden: NotRequired[Ogden]
    """Ogden's law with two terms, of lumped muscles only, 2μ [(1 − s)/α₁² Σ(λ^α₁ − 1) + s/α₂² Σ(λ^α₂ − 1)]."""

    yeoh: NotRequired[Yeoh]
    """Yeoh's law, μ/2 (I₁ − 3) + c₂ (I₁ − 3)² + c₃ (I₁ − 3)³."""


class Layer(TypedDict):
    """A layer of a box."""

    elements: int
    """Elements through the thickness."""

    region: NotRequired[Text]
    """Name of the region that the layer belongs to; in one direction only, and there for every layer."""

    thickness: Quantity
    """Thickness, SI unit m."""


class Maxwell(TypedDict):
    """A Maxwell branch."""

    relaxation_time: Quantity
    """Relaxation time τ in which small stresses fall to 1/e, SI unit s."""

    shear_modulus: Quantity
    """Shear modulus μ₁ of its spring, SI unit Pa."""


class MooneyRivlin(TypedDict):
    """Mooney and Rivlin's law."""

    share: float
    """Part s of the shear modulus that belongs to I₂, from 0 to 1: C₀₁ = s μ/2, C₁₀ = (1 − s) μ/2."""


MuscleModel: TypeAlias = "Literal['lumped', 'finite_elements']"
"""Model of a muscle."""


class NodesShape(TypedDict):
    """Nodes of an elastic block: those of a `face`, in a `plane` or in a `box`."""

    box: NotRequired[Corners]
    """Box."""

    face: NotRequired[Text]
    """Name of a face of a box, or of a physical group of a mesh."""

    plane: NotRequired[Plane]
    """Plane at right angles to an axis."""

    solid: Text
    """Name of the block."""


class Normal(TypedDict):
    """A plane."""

    normal: Sequence[float] | Numbers
    """Direction across the plane, of any length."""


class Nothing(TypedDict):
    """An object without entries."""


class Ogden(TypedDict):
    """Ogden's law with two terms."""

    exponents: Sequence[float] | Numbers
    """Exponents α₁ and α₂, not zero."""

    share: float
    """Part s of the shear modulus that belongs to the second term, from 0 to 1: μ₂ α₂ = 2 s μ, μ₁ α₁ = 2 (1 − s) μ."""


class Pair(TypedDict):
    """A pair of muscles at a joint of a chain."""

    arm: Quantity
    """Distance from the long axis, SI unit m."""

    circuit: NotRequired[Circuit]
    """Circuit between the source and the electrodes, of a lumped muscle; without it they have the voltage of the source."""

    cross_section: Sequence[Quantity] | Numbers
    """Sides of the rectangular cross-section at rest, SI unit m."""

    element: NotRequired[Element]
    """Kind of hexahedron; `hex8` where not written. Of `finite_elements` only."""

    elements: NotRequired[Sequence[int] | Numbers]
    """Elements along both sides of the cross-section and along the span; of `finite_elements` only."""

    layer_thickness: Quantity
    """Thickness of one layer at rest, SI unit m."""

    layers: NotRequired[int]
    """Layers of the model along the span, a divisor of the elements there, which is its default; of `finite_elements` only."""

    material: Text
    """Name of the material."""

    model: NotRequired[MuscleModel]
    """Model; `lumped` where not written."""

    prestretch: NotRequired[float]
    """Stretch before it was glued between its ends; 1 where not written."""

    rest_length: Quantity
    """Length at rest, SI unit m."""


class PlaneShape(TypedDict):
    """A plane."""

    at: Sequence[Quantity] | Numbers
    """A point of it, SI unit m."""

    normal: Sequence[float] | Numbers
    """Normal in the ground frame, of any length, towards what touches it."""


class Plane(TypedDict):
    """A plane at right angles to an axis: exactly one of the three."""

    x: NotRequired[Quantity]
    """Place along x, SI unit m."""

    y: NotRequired[Quantity]
    """Place along y, SI unit m."""

    z: NotRequired[Quantity]
    """Place along z, SI unit m."""


class Point(TypedDict):
    """A material point of a body."""

    at: Sequence[Quantity] | Numbers
    """Place, SI unit m."""

    body: Text
    """Name of the body, or `ground`."""


Potential: TypeAlias = "Literal['grounded', 'floating', 'driven'] | Mapping[str, Any]"
"""The potential of an electrode."""


class Prestretch(TypedDict):
    """Stretches along the axes of the ground frame; those that are not written keep the volume."""

    x: NotRequired[float]
    """Stretch along x."""

    y: NotRequired[float]
    """Stretch along y."""

    z: NotRequired[float]
    """Stretch along z."""


Ramp = TypedDict(
    "Ramp",
    {
        "duration": "Quantity",
        "from": "NotRequired[Quantity]",
        "start": "NotRequired[Quantity]",
        "to": "Quantity",
    },
)
"""Linear between two values, constant before and after."""


class Rectangle(TypedDict):
    """A rectangle of triangles."""

    elements: Sequence[Division]
    """Elements along both: numbers, or lists of layers."""

    size: Sequence[Quantity] | Numbers
    """Lengths of both edges, SI unit m."""


class Restitution(TypedDict):
    """Restitution of an impact."""

    coefficient: float
    """Speed after the impact over the speed before it, above 0 and up to 1."""

    speed: Quantity
    """Speed before the impact at which it is so, SI unit m/s."""


class Rotation(TypedDict):
    """A rotation."""

    angle: Quantity
    """Angle by the right-hand rule, SI unit rad."""

    axis: Sequence[float] | Numbers
    """Direction of the axis, of any length."""


class SignalCsv(TypedDict):
    """Values at times, from a CSV file: one line of headers such as `muscle1 [kV]`, SI units where a header has none, which a note says; lines
    that begin with `#` are comments.
    """

    file: Text
    """Path of the file, relative to the problem or to the current folder."""

    time: NotRequired[Text]
    """Header of the times, with or without its unit."""

    time_offset: NotRequired[Quantity]
    """Time in that column which is 0 of the motion, SI unit s; 0 where not written, or that of a recording of the same file."""

    values: Text
    """Header of the values, with or without its unit."""


Signal: TypeAlias = "Quantity | Function"
"""A constant in its SI unit, or exactly one of `ramp`, `sine`, `table` and `csv`."""


class SignalTable(TypedDict):
    """Values at times."""

    time: Sequence[Quantity] | Numbers
    """Times, growing, SI unit s."""

    values: Sequence[Quantity] | Numbers
    """A value at each."""


class Sine(TypedDict):
    """`mean + amplitude sin(2π t/period + phase)`."""

    amplitude: Quantity
    """Amplitude."""

    mean: NotRequired[Quantity]
    """Mean; 0 where not written."""

    period: Quantity
    """Period, SI unit s."""

    phase: NotRequired[Quantity]
    """Phase, SI unit rad; 0 where not written."""


class SphereShape(TypedDict):
    """A sphere."""

    at: Sequence[Quantity] | Numbers
    """Centre, SI unit m."""

    radius: NotRequired[Quantity]
    """Radius, SI unit m; a point where not written."""


class Sphere(TypedDict):
    """A sphere."""

    radius: Quantity
    """Radius, SI unit m."""


class Sphere2(TypedDict):
    """A sphere of triangles."""

    elements: int
    """Elements along a quarter of a great circle."""

    radius: Quantity
    """Radius, SI unit m."""


class Stack(TypedDict):
    """Electrodes at all boundaries of equal layers, both ends included: grounded, driven, grounded…"""

    axis: AxisName
    """Direction across the layers."""

    circuit: NotRequired[Circuit]
    """Circuit between their source and the driven electrodes."""

    layers: int
    """Number of layers, a divisor of the elements along the axis."""

    name: Text
    """Name of the driven electrodes, whose voltage is `block.name`."""


class Stops(TypedDict):
    """Elastic stops of a joint coordinate: `min`, `max` or both."""

    max: NotRequired[Quantity]
    """Highest coordinate without force, SI unit rad or m."""

    min: NotRequired[Quantity]
    """Lowest coordinate without force, SI unit rad or m."""

    smoothing: NotRequired[Quantity]
    """Width around a stop over which the stiffness grows from zero, SI unit rad or m, for optimal control; it jumps where not written."""

    stiffness: Quantity
    """Stiffness beyond, SI unit N m/rad (revolute) or N/m (prismatic)."""


class Surface(TypedDict):
    """Surface of a membrane: exactly one of `rectangle`, `disc`, `annulus`, `tube` and `sphere`. `surface` is the set of all its nodes."""

    annulus: NotRequired[Annulus]
    """Ring; edges `inner` and `outer`."""

    axis: NotRequired[AxisName]
    """Direction of the normal, or of the axis of a tube; z where not written."""

    centre: NotRequired[Sequence[Quantity] | Numbers]
    """Centre, or of a tube that of its lower end, SI unit m; the origin where not written."""

    disc: NotRequired[Disc]
    """Disc; edge `edge`."""

    rectangle: NotRequired[Rectangle]
    """Rectangle around the centre; edges `x_min`, `x_max`, `y_min`, `y_max` along its own directions, those that follow the axis."""

    sphere: NotRequired[Sphere2]
    """Sphere."""

    tube: NotRequired[Tube]
    """Tube, open at both ends `z_min` and `z_max`."""


class Tube(TypedDict):
    """A tube of triangles."""

    elements: Sequence[Division]
    """Elements around, and along the axis, a number or a list of layers."""

    length: Quantity
    """Length, SI unit m."""

    radius: Quantity
    """Radius, SI unit m."""


class Velocity(TypedDict):
    """A velocity v = v₀ + ω × (X − c) + diag(rate) (X − c) at the start."""

    angular: NotRequired[Sequence[Quantity] | Numbers]
    """ω, SI unit rad/s."""

    centre: NotRequired[Sequence[Quantity] | Numbers]
    """c, SI unit m; the middle of the block where not written."""

    linear: NotRequired[Sequence[Quantity] | Numbers]
    """v₀, SI unit m/s."""

    stretch_rate: NotRequired[Sequence[Quantity] | Numbers]
    """Rate of stretch along x, y, z, SI unit 1/s."""


class Yeoh(TypedDict):
    """Yeoh's law."""

    c2: Quantity
    """Constant c₂ = C₂₀, SI unit Pa."""

    c3: Quantity
    """Constant c₃ = C₃₀, SI unit Pa."""


All: TypeAlias = "Literal['all']"
"""All of them."""


class Ball(TypedDict):
    """A ball."""

    centre: Sequence[Quantity] | Numbers
    """Centre, SI unit m."""

    radius: Quantity
    """Radius, SI unit m."""


class BodyVelocity(TypedDict):
    """The velocity of a body at the start, in the ground frame."""

    angular: NotRequired[Sequence[Quantity] | Numbers]
    """Angular velocity, SI unit rad/s; 0 where not written."""

    linear: NotRequired[Sequence[Quantity] | Numbers]
    """Velocity of the centre of mass, SI unit m/s; 0 where not written. On a spherical joint it follows from `angular`."""


class Candidate(TypedDict):
    """An experiment that could be done."""

    duration: Quantity
    """Length, SI unit s."""

    experiment: NotRequired[Experiment]
    """Voltages, loads and start."""

    measured: Sequence[Measured]
    """Measured quantities; their columns are not read."""

    name: Text
    """Unique name."""

    readings: int
    """Number of readings of each quantity, at equal distances."""

    set: NotRequired[Mapping[str, Any]]
    """Values that are other ones in the scene of this experiment, by their places."""


ClearanceCost = TypedDict(
    "ClearanceCost",
    {
        "at": "NotRequired[Quantity]",
        "from": "Plane2",
        "marker": "Text",
        "weight": "NotRequired[float]",
    },
)
"""The distance of a marker from a plane, on the side of its normal."""


ClearanceLimit = TypedDict(
    "ClearanceLimit",
    {
        "from": "Plane2",
        "marker": "Text",
        "max": "NotRequired[Quantity]",
        "min": "NotRequired[Quantity]",
    },
)
"""Limits of the distance of a marker from a plane, on the side of its normal: `min`, `max` or both."""


Combined: TypeAlias = "Literal['sum', 'worst']"
"""The objective of several motions."""


class ContactForceLimit(TypedDict):
    """Limits of the normal force of a contact in the middle of every interval, as in its column: `min`, `max` or both."""

    contact: Text
    """Name of the contact."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit N."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit N."""


ControlSolver: TypeAlias = "Literal['auto', 'stages', 'mumps']"
"""Solver of the linear systems of a control problem."""


class Controller(TypedDict):
    """A controller that follows a motion by the gains of `feedback.json`, or plans anew over a receding horizon: one of `feedback` and `horizon`."""

    delay: NotRequired[Quantity]
    """Time from a sample to its effect, a multiple of the step, SI unit s; that which the gains or plans predict where not written."""

    disturbance: NotRequired[Disturbance]
    """Simulations of parts of the disturbance too, for a slider on the page."""

    feedback: NotRequired[Text]
    """Path of a `feedback.json` or of the folder that holds it, relative to this file or to the current folder. It gives the inputs that were
    sought in its problem; the robot here has joints of the same names, and may be another one otherwise.
    """

    horizon: NotRequired[Horizon]
    """Plans anew in each interval, without `sample`."""

    noise: NotRequired[Noise]
    """Noise of what is measured."""

    sample: NotRequired[Quantity]
    """Time between samples, a multiple of the step, SI unit s; the interval of the gains, for which they are, where not written."""


Coordinates: TypeAlias = "Literal['reduced', 'redundant']"
"""Coordinates in which a problem is solved; reduced ones, unless written."""


class CurrentCost(TypedDict):
    """The current of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor."""

    at: NotRequired[Quantity]
    """Current that is asked for, SI unit A; 0 where not written."""

    source: NotRequired[Text]
    """Name of the source: that of its muscle."""

    sources: NotRequired[All]
    """All sources."""

    weight: NotRequired[float]
    """Weight of the squared deviation in mA²; 1 where not written."""


class CurrentLimit(TypedDict):
    """Limits of the current from one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both.

    Behind a resistor it is the mean current in each interval. Otherwise it is the charge that flows from the middle of an interval to that of
    the next one, where the voltage jumps too; from and to states of rest that are known it is that of half an interval.
    """

    max: NotRequired[Quantity]
    """Upper bound, SI unit A."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit A."""

    source: NotRequired[Text]
    """Name of the source: that of its muscle or electrode."""

    sources: NotRequired[All]
    """All sources."""


class Disturbance(TypedDict):
    """The disturbance of a closed loop: what differs from the robot and the motion that the controller knows. It is simulated in several sizes, of
    which 0 has none and 1 is that of the problem.
    """

    sizes: NotRequired[Sequence[float] | Numbers]
    """Sizes, the smallest first; 0, 0.25, 0.5 and 1 where not written."""

    without: Mapping[str, Any]
    """Values without the disturbance, by their places in the problem, or in its scene after `scene.`. Values of a size are on the line between
    these and those of the problem.
    """


Duration: TypeAlias = "Quantity | FreeDuration"
"""A time, or bounds of a free one."""


class ElectricFieldLimit(TypedDict):
    """Breakdown field of one muscle (`"muscle": name`) or all (`"muscles": "all"`), of one elastic block (`"solid": name`, or a `region` of it) or
    all (`"solids": "all"`).

    It bounds the true field at every instant and in the middle of every interval; in finite elements at their centres and Gauss points.
    """

    max: Quantity
    """Largest true field, SI unit V/m."""

    muscle: NotRequired[Text]
    """Name of the muscle."""

    muscles: NotRequired[All]
    """All muscles with an electric term."""

    region: NotRequired[Text]
    """Name of a region of the mesh of `solid`; all elements that a field reaches where not written."""

    solid: NotRequired[Text]
    """Name of the elastic block."""

    solids: NotRequired[All]
    """All elastic blocks that a field reaches."""


Energy: TypeAlias = "float | SourceEnergy"
"""The weight of an energy of all sources, or of those that are named."""


class Experiment(TypedDict):
    """Voltages, loads and start of a recording."""

    at_rest: NotRequired[bool]
    """True if each reading is one of a state of rest under the voltages and loads of its time."""

    loads: NotRequired[Mapping[Any, Signal]]
    """Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named."""

    sought_start: NotRequired[SoughtStart]
    """Part of the start that is unknown, and fitted with the constants; nothing where not written."""

    start: NotRequired[Start]
    """Start of the motion; the reference configuration at rest where not written."""

    voltages: NotRequired[Voltages]
    """Constant voltages, those of a solution, a table, or functions of time such as columns of a CSV file; 0 where not written."""


class FieldCost(TypedDict):
    """The true electric field of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals; behind a
    resistor at the instants.
    """

    muscle: NotRequired[Text]
    """Name of the muscle."""

    muscles: NotRequired[All]
    """All lumped muscles with an electric term."""

    weight: NotRequired[float]
    """Weight of the squared field in (V/µm)²; 1 where not written."""


class FinalJoint(TypedDict):
    """A joint and where it is to end."""

    at: Quantity
    """The value, SI unit rad or m."""

    joint: Text
    """Name of the joint, revolute or prismatic."""

    weight: NotRequired[float]
    """Weight of (θ − r)² at the final instant, in rad², or mm² of a prismatic joint; 1 where not written."""


class FinalMarker(TypedDict):
    """A marker and where it is to end."""

    at: Sequence[Quantity | None] | Numbers
    """The place, SI unit m; directions that are `null` are free."""

    marker: Text
    """Name of the marker."""

    weight: NotRequired[float]
    """Weight of |x − r|² at the final instant, in mm²; 1 where not written."""


class Final(TypedDict):
    """Marker or joint that ends near a place, or a measured quantity that ends near a value, in the last interval: exactly one of them."""

    clearance: NotRequired[ClearanceCost]
    """The distance of a marker from a plane at the end."""

    current: NotRequired[CurrentCost]
    """The current of sources at the end."""

    electric_field: NotRequired[FieldCost]
    """The true electric field of muscles at the end."""

    joint: NotRequired[FinalJoint]
    """The coordinate of a joint ends near a value."""

    joint_rate: NotRequired[JointRateCost]
    """The rate of a joint at the end."""

    marker: NotRequired[FinalMarker]
    """A marker ends near a place."""

    marker_speed: NotRequired[MarkerSpeedCost]
    """The speed of a marker at the end."""

    power: NotRequired[PowerCost]
    """The power of sources at the end."""

    tension: NotRequired[TensionCost]
    """The tension of muscles at the end."""


class FreeDuration(TypedDict):
    """Bounds of a free final time."""

    guess: Quantity
    """Duration at which the solver starts, SI unit s."""

    max: Quantity
    """Upper bound, SI unit s."""

    min: Quantity
    """Lower bound, SI unit s."""


class Free(TypedDict):
    """A free parameter between bounds."""

    also: NotRequired[Mapping[Any, float]]
    """Other constants by their paths that are this one times a number."""

    guess: NotRequired[Quantity]
    """Value at which the solver starts; the value of the scene where not written."""

    max: Quantity
    """Upper bound."""

    min: Quantity
    """Lower bound, in the unit of the constant."""


FrequencyResponse = TypedDict(
    "FrequencyResponse",
    {
        "from": "Quantity",
        "input": "Text",
        "points": "NotRequired[int]",
        "to": "Quantity",
    },
)
"""An input that oscillates, and its frequencies, whose logarithms are evenly spaced."""


class GapLimit(TypedDict):
    """Limits of the gap of a contact, negative where both sides overlap: `min`, `max` or both. With a `min` of zero they do not touch."""

    contact: Text
    """Name of the contact."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit m."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit m."""


Goal: TypeAlias = "GoalWord | RestGoal"
"""`"free"`, `"periodic"`, or a state at the end."""


GoalWord: TypeAlias = "Literal['free', 'periodic']"
"""A word of a goal."""


class GuessObject(TypedDict):
    """An object of a guess: exactly one of the three."""

    random: NotRequired[RandomGuess]
    """A simulation under constant voltages drawn at random within the bounds."""

    simulate: NotRequired[GuessSimulation]
    """A simulation under given voltages."""

    solution: NotRequired[Text]
    """Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder."""


class GuessSimulation(TypedDict):
    """A simulation as a guess."""

    voltages: NotRequired[Voltages]
    """Constant voltages, those of a solution, or a table, as of a simulation; 0 where not written."""


Guess: TypeAlias = "GuessWord | GuessObject"
"""A word or an object."""


GuessWord: TypeAlias = "Literal['interpolate']"
"""A word of a guess."""


Held2: TypeAlias = "HeldWord | Mapping[Any, Quantity]"
"""Voltages that are held after a goal."""


HeldWord: TypeAlias = "Literal['find', 'none']"
"""Voltages that are not given."""


Hold: TypeAlias = "Literal['reported', 'required']"
"""Treatment of a goal that cannot be kept."""


class Horizon(TypedDict):
    """A motion that is planned anew over a horizon in each interval of its problem, with its limits and bounds, by one iteration of an interior-
    point method.
    """

    intervals: int
    """Number of its intervals in the horizon; what follows counts as the regulator of the same costs does."""

    problem: Text
    """Path of a problem file with a `control`, relative to this file or to the current folder, whose optimum is followed. The costs of deviations
    are those of its `feedback`, and their usual ones without it. The robot here has joints of the same names, and may be another one otherwise.
    """


class InputConstants(TypedDict):
    """Constants of the inputs of all recordings."""

    delay: NotRequired[Range]
    """Time by which all voltages and loads act later than recordings say, SI unit s; before they act, those of the state of rest at the start, or
    the first ones.
    """

    delays: NotRequired[Mapping[Any, Range]]
    """The same of single sources, by the names of muscles, electrodes and loads, beside that of all others."""

    gains: NotRequired[Mapping[Any, Range]]
    """Factors between the voltages and loads that recordings say and those that act, by the names of muscles, electrodes and loads."""


class InputPrior(TypedDict):
    """A normal distribution of a constant of the inputs."""

    standard_deviation: Quantity
    """Standard deviation."""

    value: Quantity
    """Mean."""


class IntegratorObject(TypedDict):
    """A method with its parameter: exactly one of the two."""

    galerkin: NotRequired[int]
    """Degree, from 1 to 8, of a Galerkin variational integrator with Lobatto points, order 2 × degree."""

    generalised_alpha: NotRequired[float]
    """Spectral radius at infinity, from 0 to 1, of the generalised-α method."""


Integrator: TypeAlias = "IntegratorWord | IntegratorObject"
"""A word or an object."""


IntegratorWord: TypeAlias = "Literal['midpoint', 'implicit_euler', 'generalised_alpha']"
"""A method by its name."""


Intervals: TypeAlias = "IntervalsWord | int"
"""Number of intervals."""


IntervalsWord: TypeAlias = "Literal['auto']"
"""Intervals of no given number."""


class JointAngleLimit(TypedDict):
    """Limits of a joint coordinate: `min`, `max` or both."""

    joint: Text
    """Name of the joint."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit rad or m."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit rad or m."""


class JointRateCost(TypedDict):
    """The mean rate of the coordinate of a joint in the intervals."""

    at: NotRequired[Quantity]
    """Rate that is asked for, SI unit rad/s or m/s; 0 where not written."""

    joint: Text
    """Name of the joint, revolute or prismatic."""

    weight: NotRequired[float]
    """Weight of the squared deviation in (rad/s)², or (m/s)² of a prismatic joint; 1 where not written."""


class JointRateLimit(TypedDict):
    """Limits of the mean rate of a joint coordinate in each interval: `min`, `max` or both."""

    joint: Text
    """Name of the joint."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit rad/s or m/s."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit rad/s or m/s."""


class Limit(TypedDict):
    """A path limit: exactly one of the keys but `part`. `min` and `max` may be equal with `part`: the quantity is then prescribed there."""

    clearance: NotRequired[ClearanceLimit]
    """Limits of the distance of a marker from a plane that is fixed to a body or the ground."""

    contact_force: NotRequired[ContactForceLimit]
    """Limits of the normal force of a contact."""

    current: NotRequired[CurrentLimit]
    """Limits of the current of sources."""

    electric_field: NotRequired[ElectricFieldLimit]
    """Breakdown field of muscles or elastic blocks."""

    gap: NotRequired[GapLimit]
    """Limits of the gap of a contact."""

    joint_angle: NotRequired[JointAngleLimit]
    """Limits of a joint coordinate."""

    joint_rate: NotRequired[JointRateLimit]
    """Limits of the rate of a joint coordinate."""

    marker: NotRequired[MarkerLimit]
    """Region of a marker."""

    marker_speed: NotRequired[MarkerSpeedLimit]
    """Limits of the speed of a marker."""

    muscle_mass: NotRequired[MuscleMassLimit]
    """Limits of the mass of muscles."""

    muscle_volume: NotRequired[MuscleVolumeLimit]
    """Limits of the volume of muscles."""

    part: NotRequired[float]
    """Part of the duration, above 0 and at most 1, at which alone the limit holds: at the instant nearest to it, or in the interval before that
    instant; 1 is the end. Where not written it holds from start to end.
    """

    power: NotRequired[PowerLimit]
    """Limits of the power of sources."""

    reaction_force: NotRequired[ReactionForceLimit]
    """Limits of the force that a joint transmits."""

    reaction_torque: NotRequired[ReactionTorqueLimit]
    """Limits of the torque that a joint transmits."""

    stretch: NotRequired[StretchLimit]
    """Limits of the stretch of a muscle."""

    tension: NotRequired[TensionLimit]
    """Limits of the tension of lumped muscles."""

    voltage_rate: NotRequired[VoltageRateLimit]
    """Limits of the rate of the voltage of sources."""


LinearSolver: TypeAlias = "Literal['auto', 'faer', 'mumps', 'multigrid']"
"""Method by which linear systems with the tangent are solved."""


class MarkerLimit(TypedDict):
    """Region of a marker: exactly one of `inside` and `outside`."""

    inside: NotRequired[Region]
    """Region in which it stays."""

    marker: Text
    """Name of the marker."""

    outside: NotRequired[Region]
    """Region outside which it stays."""


class MarkerSpeedCost(TypedDict):
    """The size of the mean velocity of a marker in the intervals."""

    marker: Text
    """Name of the marker."""

    weight: NotRequired[float]
    """Weight of the squared speed in (m/s)²; 1 where not written."""


class MarkerSpeedLimit(TypedDict):
    """Limits of the size of the mean velocity of a marker in each interval: `min`, `max` or both."""

    marker: Text
    """Name of the marker."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit m/s."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit m/s."""


Measured = TypedDict(
    "Measured",
    {
        "about": "NotRequired[Sequence[float] | Numbers]",
        "along": "NotRequired[Sequence[float] | Numbers]",
        "charge": "NotRequired[Text]",
        "clearance": "NotRequired[Text]",
        "column": "NotRequired[Text]",
        "current": "NotRequired[Text]",
        "deviations": "NotRequired[Text]",
        "from": "NotRequired[Plane2]",
        "joint": "NotRequired[Text]",
        "joint_rate": "NotRequired[Text]",
        "marker": "NotRequired[Text]",
        "power": "NotRequired[Text]",
        "reaction_force": "NotRequired[Text]",
        "reaction_torque": "NotRequired[Text]",
        "standard_deviation": "NotRequired[Quantity]",
        "tension": "NotRequired[Text]",
        "voltage": "NotRequired[Text]",
        "weights": "NotRequired[Text]",
    },
)
"""A measured quantity: exactly one of `joint`, `joint_rate`, `marker`, `tension`, `charge`, `current`, `power`, `voltage`, `reaction_force`,
`reaction_torque` and `clearance`.
"""


class Motion(TypedDict):
    """One of several motions: the keys of a control problem that are other ones in it; those that it does not name are those of `control`."""

    coordinates: NotRequired[Coordinates]
    """Coordinates."""

    duration: NotRequired[Duration]
    """Final time, SI unit s, or its bounds and a guess."""

    goal: NotRequired[Goal]
    """Final state; may be left out where the objective names something to `track` or where to end (`final`), and is free then."""

    guess: NotRequired[Guess]
    """Initial guess of the solver; where not written, of elastic blocks whose goal has `hold`, the motion under these voltages, otherwise
    `"interpolate"`.
    """

    hold: NotRequired[Hold]
    """Treatment of a goal that cannot be kept, because it is unstable or its voltages are beyond their bounds: it is `reported` (where not
    written), or refused where holding it is `required`.
    """

    intervals: NotRequired[Intervals]
    """Number of intervals, 1 or more, or `"auto"`, as where it is not written: as many as the verification of the optimum needs to confirm an
    error of 1 % of the path length, or of the part that `--accuracy` gives.
    """

    limits: NotRequired[Sequence[Limit]]
    """Path limits."""

    load_bounds: NotRequired[Mapping[Any, Sequence[Quantity] | Numbers]]
    """Lower and upper bound of each load that is sought, by name, SI units N, N m, Pa, N/m³ and C/m²."""

    loads: NotRequired[Mapping[Any, Signal]]
    """Loads that are given, by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where neither given nor sought."""

    name: NotRequired[Text]
    """Name, and that of its folder of results; one without a name has its number, as in `motion1`."""

    objective: NotRequired[Objective]
    """Objective that is minimised."""

    set: NotRequired[Mapping[str, Any]]
    """Constants of the scene that are other ones in this motion, by their places, such as `scene.materials.silicone.shear_modulus`."""

    start: NotRequired[Start]
    """Initial state; of a periodic motion, whose start is sought, the state where the solver begins."""

    voltage_bounds: NotRequired[Sequence[Quantity] | Numbers]
    """Lower and upper bound of every voltage that is sought, SI unit V; not needed where none is."""

    voltages: NotRequired[Voltages]
    """Voltages that are given, by the names of muscles and driven electrodes (`block.electrode`), SI unit V: they are no unknowns, and one of 0
    for all the time leaves no electric term at all. Functions of time, a table and those of a solution give all voltages, as of a simulation;
    then a constant of the scene has to be sought.
    """

    waypoints: NotRequired[Sequence[Waypoint]]
    """Places, orientations and joint coordinates that the motion reaches on its way."""


class MuscleMassLimit(TypedDict):
    """Limits of the mass of lumped muscles with a density, together, which follows from free parameters: `min`, `max` or both."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit kg."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit kg."""

    muscles: NotRequired[Sequence[Text]]
    """Names of lumped muscles; all of them where not written."""


class MuscleVolumeLimit(TypedDict):
    """Limits of the volume of lumped muscles at rest, together, which follows from free parameters: `min`, `max` or both."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit m^3."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit m^3."""

    muscles: NotRequired[Sequence[Text]]
    """Names of lumped muscles; all of them where not written."""


Newton: TypeAlias = "Literal['full', 'modified', 'reused']"
"""Occasions at which the tangent of a step is factorised."""


class Noise(TypedDict):
    """Standard deviations of what is measured; 0 where not written."""

    angle: NotRequired[Quantity]
    """Of angles, SI unit rad."""

    angular_velocity: NotRequired[Quantity]
    """Of rates of angles, SI unit rad/s."""

    length: NotRequired[Quantity]
    """Of lengths, SI unit m."""

    seed: NotRequired[int]
    """Seed of the numbers that are drawn; 0 where not written."""

    velocity: NotRequired[Quantity]
    """Of rates of lengths, SI unit m/s."""


class Objective(TypedDict):
    """Weights of the objective."""

    duration: NotRequired[float]
    """Weight of the final time in s."""

    effort: NotRequired[float]
    """Weight of Σ h |V_k|², V in kV, h in s."""

    electrical_energy: NotRequired[Energy]
    """Weight per J of the electrical energy from the sources of lumped muscles, of all sources or of named ones; what flows back is negative."""

    final: NotRequired[Sequence[Final]]
    """Targets of markers and joints at the end."""

    mechanical_work: NotRequired[Energy]
    """Weight per J of the mechanical work of the electrical forces of lumped muscles, of all sources or of named ones."""

    muscle_mass: NotRequired[float]
    """Weight per g of the mass of all lumped muscles with a density, which follows from free parameters."""

    muscle_volume: NotRequired[float]
    """Weight per cm³ of the volume of all lumped muscles at rest, which follows from free parameters."""

    peak_voltage: NotRequired[float]
    """Weight of the square of the peak voltage in kV: of the largest voltage of all sources that are sought, in all intervals."""

    rate: NotRequired[float]
    """Weight of Σ |V_k − V_{k−1}|²/h, V in kV, h in s, with the rest voltages of start and goal at the ends."""

    track: NotRequired[Sequence[Track]]
    """References of markers and joints in time."""


class Observer(TypedDict):
    """Standard deviations of what is measured at the start of each interval, and of what disturbs the motion in it."""

    joints: NotRequired[Mapping[Any, Quantity]]
    """Of measured joint coordinates, by joint, SI unit rad or m."""

    lasting: NotRequired[float]
    """Of the change in each interval of a constant disturbance on each joint, as a part of the greatest force of an input on it. These forces are
    then found beside the state, and inputs hold the goal against them; without it none are. As many independent measurements are needed as
    there are joints.
    """

    markers: NotRequired[Mapping[Any, Quantity]]
    """Of each component of the places of measured markers, by marker, SI unit m."""

    rates: NotRequired[float]
    """Of the rates of all coordinates, in 100 degrees/s or 100 mm/s, 0.1 where not written: pushes."""

    voltages: NotRequired[float]
    """Of voltages and loads as parts of their ranges, of voltages of lumped muscles by their squares; 0.05 where not written."""


Option: TypeAlias = "int | float | Text"
"""A value of an option of Ipopt."""


class Orientation(TypedDict):
    """An orientation of a body: `axis` with exactly one of `towards` and `angle`."""

    angle: NotRequired[Quantity]
    """Angle by which the body is turned from its reference configuration, SI unit rad."""

    axis: Sequence[float] | Numbers
    """A direction of the ground frame, of any length: with `towards` one that moves with the body, as it is in the reference configuration; with
    `angle` the axis about which the body is turned.
    """

    towards: NotRequired[Sequence[float] | Numbers]
    """Direction of the ground frame, of any length, to which `axis` points."""


class Path(TypedDict):
    """Coordinates as functions of time, SI unit m; one or more. Directions that are not written are free."""

    x: NotRequired[Signal]
    """Along x."""

    y: NotRequired[Signal]
    """Along y."""

    z: NotRequired[Signal]
    """Along z."""


class Plane2(TypedDict):
    """A plane that is fixed to a body, or to the ground where none is named."""

    body: NotRequired[Text]
    """Name of the body."""

    normal: Sequence[float] | Numbers
    """Its normal in the reference configuration, of any length; distances on its side are positive."""

    point: Sequence[Quantity] | Numbers
    """A point of the plane in the reference configuration, SI unit m."""


class PowerCost(TypedDict):
    """The power of one source (`"source": name`) or of each (`"sources": "all"`) of lumped muscles behind a resistor."""

    at: NotRequired[Quantity]
    """Power that is asked for, SI unit W; 0 where not written."""

    source: NotRequired[Text]
    """Name of the source: that of its muscle."""

    sources: NotRequired[All]
    """All sources."""

    weight: NotRequired[float]
    """Weight of the squared deviation in W²; 1 where not written."""


class PowerLimit(TypedDict):
    """Limits of the power of one source (`"source": name`) or each (`"sources": "all"`) of lumped muscles: `min`, `max` or both, at the times of a
    current.

    Without a resistor it is that of the stored energy and of the work on the motion, as in the table; losses of charging in steps do not count.
    """

    max: NotRequired[Quantity]
    """Upper bound, SI unit W."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit W."""

    source: NotRequired[Text]
    """Name of the source: that of its muscle or electrode."""

    sources: NotRequired[All]
    """All sources."""


class Prior(TypedDict):
    """A normal distribution of a constant, such as that of a data sheet."""

    standard_deviation: Quantity
    """Standard deviation."""

    value: Quantity
    """Mean, in the unit of the constant."""


class RandomGuess(TypedDict):
    """A random guess."""

    seed: int
    """Equal seeds give equal guesses."""


class Range(TypedDict):
    """Bounds of a constant."""

    guess: NotRequired[Quantity]
    """Value at which the fit starts; 1 of a gain, the lower bound of a delay where not written."""

    max: Quantity
    """Upper bound."""

    min: Quantity
    """Lower bound."""

    prior: NotRequired[InputPrior]
    """A normal distribution, as of a data sheet, which counts as one reading more."""


class ReactionForceLimit(TypedDict):
    """Limits of the component, along a direction of the ground frame, of the force from the parent of a joint on its child: `min`, `max` or both.

    It is the force of the columns of reactions, at the instants between intervals. Joints in loops are refused.
    """

    along: Sequence[float] | Numbers
    """Direction of the ground frame, of any length."""

    joint: Text
    """Name of the joint."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit N."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit N."""


class ReactionTorqueLimit(TypedDict):
    """Limits of the component, about a direction of the ground frame, of the torque from the parent of a joint on its child: `min`, `max` or both.

    It is the torque of the columns of reactions, about the point of the joint, at the instants between intervals. Spherical joints and joints
    in loops are refused.
    """

    about: Sequence[float] | Numbers
    """Direction of the ground frame, of any length."""

    joint: Text
    """Name of the joint."""

    max: NotRequired[Quantity]
    """Upper bound, SI unit N m."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit N m."""


class Recording(TypedDict):
    """Readings of a motion or of states of rest under given voltages and loads."""

    columns: NotRequired[Mapping[Any, Sequence[float | None] | Numbers]]
    """Columns of numbers by such headers in place of a file; `null` is a gap."""

    experiment: NotRequired[Experiment]
    """Voltages, loads and start."""

    file: NotRequired[Text]
    """Path of the CSV file, relative to the problem or to the current folder: one line of headers such as `tip [mm]`, `tip (mm)` or `tip_mm`, SI
    units where a header has none, which a note says; lines that begin with `#` are comments, empty cells are gaps.
    """

    held_out: NotRequired[bool]
    """True if no constant is fitted to it: the result says whether the fitted constants explain it."""

    measured: Sequence[Measured]
    """Quantities that the columns measure."""

    name: Text
    """Unique name."""

    set: NotRequired[Mapping[str, Any]]
    """Values that are other ones in the scene of this recording, by their places, such as `"scene.bodies.payload.mass": "1 kg"`."""

    time: NotRequired[Text]
    """Header of the times, which begin with the motion at 0; `time` where not written."""

    time_offset: NotRequired[Quantity]
    """Time in that column at which the motion begins, SI unit s, which all times lose, also those of inputs from the same file that have no
    `time_offset` of their own; 0 where not written. A motion whose readings begin late needs it.
    """


class Region(TypedDict):
    """A region: exactly one of the two."""

    box: NotRequired[Corners]
    """Box between two corners."""

    sphere: NotRequired[Ball]
    """Ball."""


Response: TypeAlias = "Literal['relaxed', 'instantaneous']"
"""Response of Maxwell branches to voltages and loads."""


class RestGoal(TypedDict):
    """A state at the end: `rest_at_voltages`, or `joint_angles`, or `markers` and `orientations`; at rest where it has no `joint_rates`."""

    hold: NotRequired[Held2]
    """Voltages that are held after positions of markers and orientations are reached, SI unit V; 0 where not named. Of elastic blocks the motion
    under them is the guess, where no other is written. `"find"`: they are sought with the motion, so that the goal is an equilibrium; also of
    `joint_angles`, for lumped muscles. Where not written they are sought if the motion leaves its goal under the last voltages; `"none"`: they
    are not.
    """

    joint_angles: NotRequired[Mapping[Any, Quantity]]
    """Joint coordinates by joint, SI unit rad or m; free where not named."""

    joint_rates: NotRequired[Mapping[Any, Quantity]]
    """Rates by joint with which the motion ends, SI unit rad/s or m/s; 0 where not named. Beside `joint_angles` of all joints."""

    markers: NotRequired[Mapping[Any, Sequence[Quantity | None] | Numbers]]
    """Positions by marker, SI unit m; directions that are `null` are free."""

    orientations: NotRequired[Mapping[Any, Orientation]]
    """Orientations by body."""

    rest: NotRequired[Rest]
    """Part that comes to rest at an equilibrium, at positions of markers and at orientations: `everything`, or `bodies` and these markers alone,
    also called `markers`. Where not written everything, or, of elastic blocks that have more coordinates than the voltages can bring to rest,
    bodies and these markers.
    """

    rest_at_voltages: NotRequired[Mapping[Any, Quantity]]
    """Static equilibrium under these voltages, SI unit V; 0 where not named."""


Rest: TypeAlias = "Literal['everything', 'bodies', 'markers']"
"""Part that comes to rest at a goal."""


class Sensitivity(TypedDict):
    """A number by which the optimum is differentiated."""

    also: NotRequired[Mapping[Any, float]]
    """Other constants of the scene by their paths that are this one times a number."""

    tolerance: NotRequired[Quantity]
    """Tolerance of the number, which may be so much smaller or larger: a part of it such as `"5 %"`, or a size in its unit such as `"1 mm"`."""


class Solution(TypedDict):
    """A solution by its path."""

    solution: Text
    """Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder."""


class Solver(TypedDict):
    """Options of the solver."""

    ipopt: NotRequired[Mapping[Any, Option]]
    """Options of Ipopt by name."""

    linear_solver: NotRequired[ControlSolver]
    """Solver of the linear systems, `auto` where not written."""

    max_iterations: NotRequired[int]
    """Limit of iterations, 500 where not written."""

    tolerance: NotRequired[float]
    """Relative tolerance, 1e-10 where not written."""


SoughtStart: TypeAlias = "Literal['nothing', 'coordinates', 'state']"
"""Unknown part of a start."""


class SourceEnergy(TypedDict):
    """The weight of an energy of some sources."""

    sources: Sequence[Text]
    """Names of lumped muscles."""

    weight: float
    """Weight per J."""


class Start(TypedDict):
    """A state at the start: exactly one of `rest_at_voltages`, `end_of` and joint coordinates."""

    body_velocities: NotRequired[Mapping[Any, BodyVelocity]]
    """Velocities by body, of bodies that are free or hang on a spherical or floating joint; with what the joints before them do where not named."""

    end_of: NotRequired[Text]
    """The end of another motion of the same robot, configuration and momentum: the path of the folder of its result, relative to this file or to
    the current folder. Time begins at zero.
    """

    joint_angles: NotRequired[Mapping[Any, Quantity]]
    """Joint coordinates by joint, SI unit rad or m; 0 where not named."""

    joint_rates: NotRequired[Mapping[Any, Quantity]]
    """Rates of joint coordinates by joint, SI unit rad/s or m/s; 0 where not named."""

    rest_at_voltages: NotRequired[Mapping[Any, Quantity]]
    """Static equilibrium under these voltages, SI unit V; 0 where not named."""


Step: TypeAlias = "StepWord | Quantity"
"""Length of the steps."""


StepWord: TypeAlias = "Literal['auto']"
"""Steps of no given length."""


class StretchLimit(TypedDict):
    """Limits of the stretch of a muscle: `min`, `max` or both."""

    max: NotRequired[float]
    """Upper bound."""

    min: NotRequired[float]
    """Lower bound."""

    muscle: Text
    """Name of the muscle."""


class Table(TypedDict):
    """Voltages that are constant in intervals of time."""

    hold: NotRequired[Mapping[Any, Quantity]]
    """Voltages after the last interval; those of the last interval where not written."""

    time: Sequence[Quantity] | Numbers
    """Start and end of the intervals, growing, the first of them 0; SI unit s."""

    voltages: Mapping[Any, Sequence[Quantity] | Numbers]
    """A voltage for each interval by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named."""


class TensionCost(TypedDict):
    """The tension of one lumped muscle (`"muscle": name`) or of each (`"muscles": "all"`), in the middle of the intervals."""

    at: NotRequired[Quantity]
    """Tension that is asked for, SI unit N; 0 where not written."""

    muscle: NotRequired[Text]
    """Name of the muscle."""

    muscles: NotRequired[All]
    """All lumped muscles."""

    weight: NotRequired[float]
    """Weight of the squared deviation in N²; 1 where not written."""


class TensionLimit(TypedDict):
    """Limits of the force with which one lumped muscle (`"muscle": name`), each (`"muscles": "all"`), a spring or a tendon pulls its ends
    together, by elasticity, field, viscosity and Maxwell branches: `min`, `max` or both.

    It bounds the tension in the middle of every interval, under the voltage there; the column of the table is its mean in both intervals beside
    an instant. Of springs and tendons it bounds the mean over every interval.
    """

    max: NotRequired[Quantity]
    """Upper bound, SI unit N."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit N. With `0` the muscle is never slack."""

    muscle: NotRequired[Text]
    """Name of the muscle."""

    muscles: NotRequired[All]
    """All lumped muscles."""

    spring: NotRequired[Text]
    """Name of a spring."""

    tendon: NotRequired[Text]
    """Name of a tendon."""


class TrackJoint(TypedDict):
    """A joint and the function that its coordinate follows."""

    along: Signal
    """The function of time, SI unit rad or m."""

    joint: Text
    """Name of the joint, revolute or prismatic."""

    weight: NotRequired[float]
    """Weight of ∫ (θ − r)² dt in rad² s, or mm² s of a prismatic joint; 1 where not written."""


class TrackJoints(TypedDict):
    """All joints along an earlier solution."""

    solution: Text
    """Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder; linear between its instants,
    constant after the last.
    """

    weight: NotRequired[float]
    """Weight of the sum over all joints of ∫ (θ − r)² dt in rad² s, or mm² s of prismatic joints; 1 where not written."""


class TrackMarker(TypedDict):
    """A marker and its path."""

    along: Path
    """The path."""

    marker: Text
    """Name of the marker."""

    weight: NotRequired[float]
    """Weight of ∫ |x − r|² dt over the directions of the path, in mm² s; 1 where not written."""


class Track(TypedDict):
    """Marker or joints that follow a reference, or a measured quantity whose squared deviation from a value, times `weight`, is integrated over
    the time in s: exactly one of them.
    """

    clearance: NotRequired[ClearanceCost]
    """The distance of a marker from a plane along the motion."""

    current: NotRequired[CurrentCost]
    """The current of sources along the motion."""

    electric_field: NotRequired[FieldCost]
    """The true electric field of muscles along the motion."""

    joint: NotRequired[TrackJoint]
    """The coordinate of a joint follows a function of time."""

    joint_rate: NotRequired[JointRateCost]
    """The rate of a joint along the motion."""

    joints: NotRequired[TrackJoints]
    """The coordinates of all joints follow an earlier solution."""

    marker: NotRequired[TrackMarker]
    """A marker follows a path in time."""

    marker_speed: NotRequired[MarkerSpeedCost]
    """The speed of a marker along the motion."""

    power: NotRequired[PowerCost]
    """The power of sources along the motion."""

    tension: NotRequired[TensionCost]
    """The tension of muscles along the motion."""


class VoltageRateLimit(TypedDict):
    """Limits of the rate of the voltage of one source (`"source": name`) or each (`"sources": "all"`) from interval to interval: `min`, `max` or
    both.
    """

    max: NotRequired[Quantity]
    """Upper bound, SI unit V/s."""

    min: NotRequired[Quantity]
    """Lower bound, SI unit V/s."""

    source: NotRequired[Text]
    """Name of the source: that of its muscle or electrode."""

    sources: NotRequired[All]
    """All sources."""


Voltages: TypeAlias = "Solution | Table | Mapping[Any, Signal]"
"""Voltages by muscle or driven electrode, constant or functions of time; 0 where not named; `{"solution": path}`, or `{"time": [...], "voltages":
{...}}`.
"""


class Waypoint(TypedDict):
    """Places that the motion reaches at a time on its way, at the instant nearest to it: `markers`, `orientations`, `joint_angles`, or several of
    them. With a `weight` it passes near them: their squared distances are costs.
    """

    joint_angles: NotRequired[Mapping[Any, Quantity]]
    """Joint coordinates by joint, SI unit rad or m."""

    markers: NotRequired[Mapping[Any, Sequence[Quantity | None] | Numbers]]
    """Positions by marker, SI unit m; directions that are `null` are free."""

    orientations: NotRequired[Mapping[Any, Orientation]]
    """Orientations by body."""

    part: NotRequired[float]
    """Part of the duration, above 0 and below 1, which may be free; of a periodic motion 1 is its start and its end."""

    time: NotRequired[Quantity]
    """Time, SI unit s; or give `part`."""

    weight: NotRequired[float]
    """Weight of the squared distances at that instant, in mm² of markers and prismatic joints and rad² of revolute ones, as costs in the objective
    in place of exact conditions; not of `orientations`.
    """


class Weights(TypedDict):
    """Factors of sums of squares of deviations."""

    integral: NotRequired[float]
    """Of integrals over time of the deviations of joint coordinates, in degrees or mm times 0.1 s; 0 where not written, and then none are formed.
    They take deviations at rest to zero, where there are inputs enough.
    """

    joints: NotRequired[float]
    """Of coordinates of joints and nodes in degrees or mm; 1 where not written."""

    markers: NotRequired[Mapping[Any, float]]
    """Of places of markers in mm, by name; 0 where not named."""

    rates: NotRequired[float]
    """Of their mean rates over an interval in 100 degrees/s or 100 mm/s; 0 where not written."""

    voltages: NotRequired[float]
    """Of voltages and loads as parts of their ranges, of voltages of lumped muscles by their squares; positive, 0.01 where not written."""


class Control(TypedDict):
    """An optimal control problem."""

    combine: NotRequired[Combined]
    """The objective of several motions: the `sum` of theirs (where not written), or that of the `worst`, the greatest one."""

    coordinates: NotRequired[Coordinates]
    """Coordinates."""

    duration: NotRequired[Duration]
    """Final time, SI unit s, or its bounds and a guess."""

    free: NotRequired[Mapping[Any, Free]]
    """Constants of the scene that are sought, by their paths, such as `materials.silicone.shear_modulus`."""

    goal: NotRequired[Goal]
    """Final state; may be left out where the objective names something to `track` or where to end (`final`), and is free then."""

    guess: NotRequired[Guess]
    """Initial guess of the solver; where not written, of elastic blocks whose goal has `hold`, the motion under these voltages, otherwise
    `"interpolate"`.
    """

    hold: NotRequired[Hold]
    """Treatment of a goal that cannot be kept, because it is unstable or its voltages are beyond their bounds: it is `reported` (where not
    written), or refused where holding it is `required`.
    """

    intervals: NotRequired[Intervals]
    """Number of intervals, 1 or more, or `"auto"`, as where it is not written: as many as the verification of the optimum needs to confirm an
    error of 1 % of the path length, or of the part that `--accuracy` gives.
    """

    limits: NotRequired[Sequence[Limit]]
    """Path limits."""

    load_bounds: NotRequired[Mapping[Any, Sequence[Quantity] | Numbers]]
    """Lower and upper bound of each load that is sought, by name, SI units N, N m, Pa, N/m³ and C/m²."""

    loads: NotRequired[Mapping[Any, Signal]]
    """Loads that are given, by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where neither given nor sought."""

    motions: NotRequired[Sequence[Motion]]
    """Several motions in one optimisation: what `free` seeks is the same in all of them, and the objective is the sum of theirs. Each names the
    keys that are other ones in it.
    """

    objective: NotRequired[Objective]
    """Objective that is minimised."""

    phases: NotRequired[Sequence[Motion]]
    """Phases of one motion, each of which goes on where the one before ended: the first one begins at `start`, the last one ends at `goal`. Each
    has its `duration`, given or with bounds and a guess, and the keys that are other ones in it; `duration` beside them is that of all
    together.
    """

    sensitivity: NotRequired[Mapping[Any, Sensitivity]]
    """Numbers by which the optimum is differentiated, by their paths: constants of the scene, such as `materials.silicone.shear_modulus`, and
    `duration`, `goal.joint_angles.NAME`, `goal.markers.NAME[0]`, `goal.rest_at_voltages.NAME`, `start.joint_angles.NAME`,
    `start.joint_rates.NAME`, `start.rest_at_voltages.NAME`, `voltage_bounds[1]`, `load_bounds.NAME[1]`, `objective.effort`, `objective.rate`,
    `objective.duration`.
    """

    shared_inputs: NotRequired[Sequence[Text]]
    """Names of muscles, driven electrodes (`block.electrode`) and loads whose inputs are sought once for all motions; these have one given
    duration and one number of intervals.
    """

    solver: NotRequired[Solver]
    """Options of the solver."""

    start: NotRequired[Start]
    """Initial state; of a periodic motion, whose start is sought, the state where the solver begins."""

    voltage_bounds: NotRequired[Sequence[Quantity] | Numbers]
    """Lower and upper bound of every voltage that is sought, SI unit V; not needed where none is."""

    voltages: NotRequired[Voltages]
    """Voltages that are given, by the names of muscles and driven electrodes (`block.electrode`), SI unit V: they are no unknowns, and one of 0
    for all the time leaves no electric term at all. Functions of time, a table and those of a solution give all voltages, as of a simulation;
    then a constant of the scene has to be sought.
    """

    waypoints: NotRequired[Sequence[Waypoint]]
    """Places, orientations and joint coordinates that the motion reaches on its way."""


class Simulate(TypedDict):
    """A forward simulation."""

    controller: NotRequired[Controller]
    """A controller that gives the voltages which it has gains for."""

    coordinates: NotRequired[Coordinates]
    """Coordinates."""

    duration: Quantity
    """Length, SI unit s."""

    integrator: NotRequired[Integrator]
    """The method; the midpoint variational integrator where not written."""

    linear_solver: NotRequired[LinearSolver]
    """Method by which its linear systems are solved; `auto` where not written."""

    loads: NotRequired[Mapping[Any, Signal]]
    """Loads by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named."""

    newton: NotRequired[Newton]
    """Occasions at which the tangent of a step is factorised; where not written `modified` with finite elements, otherwise `full`."""

    start: NotRequired[Start]
    """Start of the motion; the reference configuration at rest where not written."""

    step: NotRequired[Step]
    """Step, SI unit s, or `"auto"`, as where it is not written: steps as short as the tolerance needs, by the midpoint rule."""

    tolerance: NotRequired[float]
    """Sum of the estimated local errors that `"auto"` allows over the duration, of angles in rad, of lengths relative to the robot's size; 1e-3
    where not written.
    """

    voltages: NotRequired[Voltages]
    """Constant voltages, those of a solution, or a table; 0 where not written."""


class Equilibrium(TypedDict):
    """A static equilibrium."""

    coordinates: NotRequired[Coordinates]
    """Coordinates."""

    frequency_response: NotRequired[FrequencyResponse]
    """Response of joints and markers to an input that oscillates about its value at rest."""

    loads: NotRequired[Mapping[Any, Quantity]]
    """Loads by name, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named."""

    modes: NotRequired[int]
    """Number of vibrations about the state, those of lowest frequencies: natural frequencies, damping ratios and shapes."""

    path: NotRequired[int]
    """Number of points of the path of equilibria from zero voltage that are followed by arc length, past limit points such as pull-in."""

    response: NotRequired[Response]
    """Response of Maxwell branches; `relaxed` where not written."""

    voltages: NotRequired[Mapping[Any, Quantity]]
    """Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named."""


class Identify(TypedDict):
    """Constants that are fitted to recordings, with what the data say of them."""

    candidates: NotRequired[Sequence[Candidate]]
    """Experiments that could be done next; the result ranks them by the variance that they leave."""

    coordinates: NotRequired[Coordinates]
    """Coordinates."""

    free: NotRequired[Mapping[Any, Free]]
    """Free parameters by their paths in the scene, such as `"materials.silicone.shear_modulus"`, each between bounds."""

    inputs: NotRequired[InputConstants]
    """Constants of the inputs that are sought: gains of sources, and their delays."""

    priors: NotRequired[Mapping[Any, Prior]]
    """Constants of `free` that are known beside the recordings, by their paths: each counts as one reading more."""

    recordings: Sequence[Recording]
    """Recordings: those that constants are fitted to, and those that are held out to check their prediction."""

    step: NotRequired[Quantity]
    """Step of the first grid, SI unit s, which is halved until its bias is below a tenth of the standard errors; by the number of readings where
    not written.
    """


class Chain(TypedDict):
    """A chain from the origin along an axis: `segment1`…, `joint1`…, and `muscle1`…, two at each joint.

    Joint i stands at (i − 1) lengths; the joint axes alternate by 90° about the long axis. Muscle 2i − 1 runs at `+arm`, muscle 2i at `−arm`
    off the long axis, from half a rest length below the joint to half a rest length above it.
    """

    axis: Sequence[float] | Numbers
    """Long axis."""

    first_joint_axis: Sequence[float] | Numbers
    """Axis of the first joint, at right angles to the long axis."""

    length: Quantity
    """Length of a segment, SI unit m."""

    mass: Quantity
    """Mass of a segment, SI unit kg."""

    muscles: NotRequired[Pair]
    """Pair of muscles at each joint."""

    radius: Quantity
    """Radius of a segment, SI unit m."""

    segments: int
    """Number of segments."""

    tip_marker: NotRequired[Text]
    """Name of a marker at the end."""


class Output(TypedDict):
    """Part of a motion that tables, figures and page show; all of it stays in the solution."""

    every: NotRequired[Quantity]
    """Time between the instants shown, SI unit s: those nearest to its multiples. Where not written all, and of a long motion so many that nothing
    is lost to the eye.
    """

    quantities: NotRequired[Sequence[Text]]
    """Columns of `trajectory.csv`: `joints`, `rates`, `speeds`, `reactions`, `markers`, `stretches`, `tensions`, `fields`, `charges`, `currents`,
    `powers`, `energies`, `momenta`, `constraint_violation`, or all of a joint, marker, muscle, block, spring, tendon or load by its name. All
    where not written.
    """


class Feedback(TypedDict):
    """A linear-quadratic regulator along the optimum; its gains are written to `feedback.json`, `feedback.csv` and `feedback.npz`."""

    delay: NotRequired[Quantity]
    """Time from a measurement to its effect, over which the state is predicted, SI unit s, upwards to whole intervals; 0 where not written."""

    observer: NotRequired[Observer]
    """Measurements of the controller in place of the state, which a Kalman filter along the optimum then finds from them."""

    step: NotRequired[Quantity]
    """Greatest length of the steps that are linearised, SI unit s; 1 ms where not written. Gains act over the intervals of the optimum."""

    terminal: NotRequired[float]
    """Factor of the costs at the end: of holding the goal for ever, or, where its voltages are not known, of the deviations there; 1 where not
    written.
    """

    weights: NotRequired[Weights]
    """Costs of deviations."""

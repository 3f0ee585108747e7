"""What a system is made of: thin names for the entries of a scene file.

Numbers are in SI units, texts have a unit. Positions and axes are given in the reference configuration, in the ground frame. Where JSON
wants a name, the part itself may stand; a keyword of Python has an underscore behind it (`from_`).

Written by `python/generate.py` from the JSON Schema of problems.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from proboscis._part import GROUND, Part

if TYPE_CHECKING:
    from proboscis import entries
    from proboscis.entries import Numbers, Quantity, Text

__all__ = ["GROUND", "Part", "Material", "Body", "Joint", "Muscle", "Solid", "Spring", "Tendon", "ContactShape", "Contact", "Load", "Marker"]


class Material(Part):
    """A dielectric elastomer.

    * `shear_modulus`: Shear modulus μ of small strains, SI unit Pa.
    * `c1`: Constant of the term c₁ E·E, SI unit F/m = N/V².
    * `c2`: Constant of the term c₂ C:(E⊗E), SI unit F/m = N/V².
    * `conditions`: Conditions under which the constants were measured and fitted, for readers.
    * `density`: Density, SI unit kg/m³; without it muscles are massless.
    * `dielectric`: Law by which `relative_permittivity` enters the energy; `first_order` where not written.
    * `lame_lambda`: First Lamé constant λ, SI unit Pa; or give `poisson_ratio`. Finite elements need one of them.
    * `law`: Law of elasticity; the neo-Hookean one where not written.
    * `maxwell`: Maxwell branches, five at most: springs in series with dampers, in which stress relaxes.
    * `poisson_ratio`: Poisson's ratio, between −1 and 0.5; or give `lame_lambda`.
    * `relative_permittivity`: Relative permittivity, 1 or more; or give `c1` and `c2`; without either the material has no electric term.
    * `source`: Source of the constants, for readers.
    * `stretch_range`: Smallest and largest stretch for which the constants hold; a lumped muscle beyond them is a warning.
    * `viscosity`: Viscosity η in σ = η d, SI unit Pa s; without it no viscous force.
    """

    kind, noun = "materials", "material"

    def __init__(
        self,
        name: str | None = None,
        *,
        shear_modulus: Quantity,
        c1: Quantity | None = None,
        c2: Quantity | None = None,
        conditions: Text | None = None,
        density: Quantity | None = None,
        dielectric: entries.Dielectric | None = None,
        lame_lambda: Quantity | None = None,
        law: entries.Law | None = None,
        maxwell: Sequence[entries.Maxwell] | None = None,
        poisson_ratio: float | None = None,
        relative_permittivity: float | None = None,
        source: Text | None = None,
        stretch_range: Sequence[float] | Numbers | None = None,
        viscosity: Quantity | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "shear_modulus": shear_modulus,
                "c1": c1,
                "c2": c2,
                "conditions": conditions,
                "density": density,
                "dielectric": dielectric,
                "lame_lambda": lame_lambda,
                "law": law,
                "maxwell": maxwell,
                "poisson_ratio": poisson_ratio,
                "relative_permittivity": relative_permittivity,
                "source": source,
                "stretch_range": stretch_range,
                "viscosity": viscosity,
            },
        )


class Body(Part):
    """A rigid body: a mass or a density; one shape, or an explicit inertia, or both.

    * `box`: Solid box with edges along the axes of the ground frame.
    * `cylinder`: Solid cylinder.
    * `density`: Density of the shape, SI unit kg/m³, in place of the mass.
    * `free`: True if the body is free of the ground: no chain of joints leads there.
    * `inertia`: Moments of inertia about the axes of the ground frame through the centre of mass, SI unit kg m²; overrides the shape's.
    * `mass`: Mass, SI unit kg.
    * `mesh`: Solid within a closed surface of triangles, from an STL file; beside `inertia` it is only drawn.
    * `position`: Centre of mass, SI unit m; of a `mesh` without `inertia` it follows from the surface, and is not written.
    * `products_of_inertia`: Entries xy, xz, yz of the tensor of inertia whose diagonal is `inertia`, such as −∫ x y dm, SI unit kg m²; zero where
      not written.
    * `sphere`: Solid sphere.
    """

    kind, noun = "bodies", "body"

    def __init__(
        self,
        name: str | None = None,
        *,
        box: entries.Box | None = None,
        cylinder: entries.Cylinder | None = None,
        density: Quantity | None = None,
        free: bool | None = None,
        inertia: Sequence[Quantity] | Numbers | None = None,
        mass: Quantity | None = None,
        mesh: entries.BodyMesh | None = None,
        position: Sequence[Quantity] | Numbers | None = None,
        products_of_inertia: Sequence[Quantity] | Numbers | None = None,
        sphere: entries.Sphere | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "box": box,
                "cylinder": cylinder,
                "density": density,
                "free": free,
                "inertia": inertia,
                "mass": mass,
                "mesh": mesh,
                "position": position,
                "products_of_inertia": products_of_inertia,
                "sphere": sphere,
            },
        )


class Joint(Part):
    """A joint: exactly one of `revolute`, `prismatic`, `universal`, `cylindrical`, `planar`, `spherical`, `floating`, `fixed`.

    * `at`: Place, SI unit m.
    * `child`: Body on the other side.
    * `parent`: Body on the side of the root, or `ground`.
    * `cylindrical`: Translation along an axis and rotation about it.
    * `damping`: Damping of the joint coordinate, SI unit N m s/rad (revolute) or N s/m (prismatic).
    * `fixed`: No motion.
    * `floating`: Any motion: the child is as free as without the joint, and results give its orientation in the first body.
    * `locked`: True if the joint is locked as it stands in the reference configuration: it is then `fixed`, and the bodies that it connects are
      one body.
    * `motion`: Prescribed coordinate as a function of time, SI unit rad or m: a constant, or an object with `ramp`, `sine`, `table` or `csv`.
    * `planar`: Translation in a plane and rotation about its normal.
    * `prismatic`: Translation along an axis.
    * `rest_angle`: Angle of a revolute joint at which its spring exerts no torque, SI unit rad; 0 where absent: the reference configuration. It
      counts whole turns.
    * `rest_displacement`: Displacement of a prismatic joint at which its spring exerts no force, SI unit m; 0 where absent.
    * `revolute`: Rotation about an axis.
    * `spherical`: Rotation about a point.
    * `stiffness`: Stiffness of a spring of the joint coordinate, SI unit N m/rad (revolute) or N/m (prismatic).
    * `stops`: Elastic stops of the joint coordinate.
    * `universal`: Rotation about an axis of the parent and a perpendicular one of the child: a Cardan or Hooke joint.
    """

    kind, noun = "joints", "joint"

    def __init__(
        self,
        name: str | None = None,
        *,
        at: Sequence[Quantity] | Numbers,
        child: Text,
        parent: Text,
        cylindrical: entries.Axis | None = None,
        damping: Quantity | None = None,
        fixed: entries.Nothing | None = None,
        floating: entries.Nothing | None = None,
        locked: bool | None = None,
        motion: entries.Signal | None = None,
        planar: entries.Normal | None = None,
        prismatic: entries.Axis | None = None,
        rest_angle: Quantity | None = None,
        rest_displacement: Quantity | None = None,
        revolute: entries.Axis | None = None,
        spherical: entries.Nothing | None = None,
        stiffness: Quantity | None = None,
        stops: entries.Stops | None = None,
        universal: entries.Axes | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "at": at,
                "child": child,
                "parent": parent,
                "cylindrical": cylindrical,
                "damping": damping,
                "fixed": fixed,
                "floating": floating,
                "locked": locked,
                "motion": motion,
                "planar": planar,
                "prismatic": prismatic,
                "rest_angle": rest_angle,
                "rest_displacement": rest_displacement,
                "revolute": revolute,
                "spherical": spherical,
                "stiffness": stiffness,
                "stops": stops,
                "universal": universal,
            },
        )


class Muscle(Part):
    """A muscle between two points.

    * `cross_section`: Sides of the rectangular cross-section at rest, SI unit m.
    * `from_`: Start.
    * `layer_thickness`: Thickness of one layer at rest, SI unit m.
    * `material`: Name of the material.
    * `to`: End.
    * `circuit`: Circuit between the source and the electrodes, of a lumped muscle; without it they have the voltage of the source.
    * `element`: Kind of hexahedron; `hex8` where not written. Of `finite_elements` only.
    * `elements`: Elements along both sides of the cross-section and along the span; of `finite_elements` only.
    * `first_side`: Direction of the first side of the cross-section, of which the part across the span counts; where not written perpendicular to
      the span and to the first of the axes x, y, z whose cosine with the span is below 0.6. Of `finite_elements` only.
    * `layers`: Layers of the model along the span, a divisor of the elements there, which is its default; of `finite_elements` only.
    * `model`: Model; `lumped` where not written.
    * `prestretch`: Stretch before it was glued between its ends; 1 where not written.
    * `section_inertia`: True if the inertia of the changing cross-section is taken into account.
    """

    kind, noun = "muscles", "muscle"

    def __init__(
        self,
        name: str | None = None,
        *,
        cross_section: Sequence[Quantity] | Numbers,
        from_: entries.Point,
        layer_thickness: Quantity,
        material: Text,
        to: entries.Point,
        circuit: entries.Circuit | None = None,
        element: entries.Element | None = None,
        elements: Sequence[int] | Numbers | None = None,
        first_side: Sequence[float] | Numbers | None = None,
        layers: int | None = None,
        model: entries.MuscleModel | None = None,
        prestretch: float | None = None,
        section_inertia: bool | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "cross_section": cross_section,
                "from": from_,
                "layer_thickness": layer_thickness,
                "material": material,
                "to": to,
                "circuit": circuit,
                "element": element,
                "elements": elements,
                "first_side": first_side,
                "layers": layers,
                "model": model,
                "prestretch": prestretch,
                "section_inertia": section_inertia,
            },
        )


class Solid(Part):
    """An elastic block of finite elements: a `box` or a `mesh`, of one `material` or of `materials` by region; or a membrane with a `thickness`: a
    `surface` or a `mesh` of triangles or quadrangles.

    Faces are `x_min`, `x_max`, `y_min`, `y_max`, `z_min`, `z_max` of a box, the edges of a surface, and physical groups of a mesh.

    * `box`: Box with edges along the axes of the ground frame.
    * `electrodes`: Electrodes; without any the block has no potential. Those of a membrane lie on both sides: their potential is the voltage
      across it, of the triangles that they cover.
    * `element`: Kind of its elements; `hex8` where not written, `tet10` of a mesh of tetrahedra.
    * `fixed`: Faces and other places that are held. A node that is glued as well moves with its body.
    * `glued`: Names of bodies, or of other solids, by the faces that are glued to them; a face glued to `ground` is clamped. A face that is glued
      to another solid lies on its surface.
    * `material`: Name of the material.
    * `materials`: Names of the materials by region.
    * `mesh`: Path of a Gmsh file, relative to this file.
    * `prestretch`: Stretch before it was glued and held, by which the mesh differs from the block without stress; none where not written.
    * `stack`: Electrodes between the layers of a stack and at its ends, alternately grounded and driven.
    * `surface`: Surface of a membrane.
    * `thickness`: Thickness of a membrane before its prestretch, SI unit m.
    * `unit`: Length of a unit of the Gmsh file, SI unit m; 1 m where not written.
    * `velocity`: Velocity at the start; at rest where not written.
    """

    kind, noun = "solids", "solid"

    def __init__(
        self,
        name: str | None = None,
        *,
        box: entries.Grid | None = None,
        electrodes: Sequence[entries.Electrode] | None = None,
        element: entries.Element | None = None,
        fixed: Sequence[entries.Fixed] | None = None,
        glued: Mapping[Any, Text] | None = None,
        material: Text | None = None,
        materials: Mapping[Any, Text] | None = None,
        mesh: Text | None = None,
        prestretch: entries.Prestretch | None = None,
        stack: entries.Stack | None = None,
        surface: entries.Surface | None = None,
        thickness: Quantity | None = None,
        unit: Quantity | None = None,
        velocity: entries.Velocity | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "box": box,
                "electrodes": electrodes,
                "element": element,
                "fixed": fixed,
                "glued": glued,
                "material": material,
                "materials": materials,
                "mesh": mesh,
                "prestretch": prestretch,
                "stack": stack,
                "surface": surface,
                "thickness": thickness,
                "unit": unit,
                "velocity": velocity,
            },
        )


class Spring(Part):
    """A linear spring, a damper, or both, between two points: force k (length − rest length) + c (rate of the length).

    * `from_`: One end.
    * `to`: The other end.
    * `damping`: Damping c, SI unit N s/m.
    * `rest_length`: Length without force, SI unit m; the distance of the ends where not written.
    * `stiffness`: Stiffness k, SI unit N/m.
    """

    kind, noun = "springs", "spring"

    def __init__(
        self,
        name: str | None = None,
        *,
        from_: entries.Point,
        to: entries.Point,
        damping: Quantity | None = None,
        rest_length: Quantity | None = None,
        stiffness: Quantity | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "from": from_,
                "to": to,
                "damping": damping,
                "rest_length": rest_length,
                "stiffness": stiffness,
            },
        )


class Tendon(Part):
    """An elastic cable that slides without friction through points and takes no compression: tension k max(length − rest length, 0).

    * `stiffness`: Stiffness k of the whole cable, SI unit N/m.
    * `through`: The points, two or more: the ends, and between them those that it slides through.
    * `rest_length`: Length up to which it is slack, SI unit m; the length of the path where not written.
    * `smoothing`: Width around the rest length over which the stiffness grows from zero to k, SI unit m, for optimal control; it jumps where not
      written.
    """

    kind, noun = "tendons", "tendon"

    def __init__(
        self,
        name: str | None = None,
        *,
        stiffness: Quantity,
        through: Sequence[entries.Point],
        rest_length: Quantity | None = None,
        smoothing: Quantity | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "stiffness": stiffness,
                "through": through,
                "rest_length": rest_length,
                "smoothing": smoothing,
            },
        )


class ContactShape(Part):
    """A shape that contacts name: a `sphere`, `capsule`, `box` or `plane` of a body, or `nodes` of an elastic block.

    * `body`: Name of the body, or `ground`; the ground where not written.
    * `box`: A box.
    * `capsule`: A cylinder between two half spheres.
    * `group`: Name of the shapes that contacts mean together.
    * `nodes`: Nodes of an elastic block, each a point.
    * `plane`: A plane, which reaches to infinity.
    * `sphere`: A sphere, or a point.
    """

    kind, noun = "shapes", "shape"

    def __init__(
        self,
        name: str | None = None,
        *,
        body: Text | None = None,
        box: entries.BoxShape | None = None,
        capsule: entries.CapsuleShape | None = None,
        group: Text | None = None,
        nodes: entries.NodesShape | None = None,
        plane: entries.PlaneShape | None = None,
        sphere: entries.SphereShape | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "body": body,
                "box": box,
                "capsule": capsule,
                "group": group,
                "nodes": nodes,
                "plane": plane,
                "sphere": sphere,
            },
        )


class Contact(Part):
    """Contact of all pairs of shapes `between` two names, or of a `sphere` or a point and a `plane` or an `other` sphere, with a `stiffness` or
    the law of `hertz`.

    * `between`: Names of two shapes, or of groups of shapes.
    * `friction`: Coefficient of friction; without it the contact is smooth.
    * `hertz`: Law of Hertz for elastic solids, one of them on a rigid one or two; or give `stiffness`.
    * `other`: The other sphere that it touches; or give `plane`.
    * `plane`: The plane that it touches; or give `other`.
    * `restitution`: Restitution, from which the damping follows; without it the contact does not damp.
    * `slip_speed`: Speed of slip up to which friction grows, SI unit m/s; 0.1 mm/s where not written. What sticks creeps at a part of it, unless
      `stick` is written.
    * `smoothing`: Width of the overlap around zero over which the stiffness grows, SI unit m, for optimal control; it jumps where not written.
    * `sphere`: The sphere; or give `between`.
    * `stick`: Greatest elastic displacement before the contact slips, SI unit m; with it friction holds without creep.
    * `stiffness`: Force for an overlap of the undeformed shapes, SI unit N/m; or give `hertz`.
    """

    kind, noun = "contacts", "contact"

    def __init__(
        self,
        name: str | None = None,
        *,
        between: Sequence[Text] | None = None,
        friction: float | None = None,
        hertz: Sequence[entries.ElasticSolid] | None = None,
        other: entries.ContactSphere | None = None,
        plane: entries.ContactPlane | None = None,
        restitution: entries.Restitution | None = None,
        slip_speed: Quantity | None = None,
        smoothing: Quantity | None = None,
        sphere: entries.ContactSphere | None = None,
        stick: Quantity | None = None,
        stiffness: Quantity | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "between": between,
                "friction": friction,
                "hertz": hertz,
                "other": other,
                "plane": plane,
                "restitution": restitution,
                "slip_speed": slip_speed,
                "smoothing": smoothing,
                "sphere": sphere,
                "stick": stick,
                "stiffness": stiffness,
            },
        )


class Load(Part):
    """A load, whose size a problem gives or seeks: a force at a `point`, a torque or force of a `joint`, such as that of a motor, the charge of a
    `muscle`, or a load of a `solid`.

    * `box`: Faces of the surface in a box on which it acts.
    * `direction`: Direction of the force or traction in the ground frame, in the reference configuration where it `follows`; its length is
      ignored.
    * `face`: Face on which it acts.
    * `follows`: True if a force turns with its body, or a pressure acts on the deformed faces along their normals; where not written, a pressure
      does and a force does not.
    * `joint`: Name of a revolute joint, about whose axis a torque acts on the child, or of a prismatic one, along whose axis a force acts.
    * `kind`: Kind of a load of a `solid`.
    * `muscle`: Name of a lumped muscle whose electrodes have a given charge instead of a voltage.
    * `plane`: Faces of the surface in a plane on which it acts.
    * `point`: Point of a body at which a force acts, with `direction`; or give `joint` or `solid`.
    * `solid`: Name of an elastic block, with `kind`.
    """

    kind, noun = "loads", "load"

    def __init__(
        self,
        name: str | None = None,
        *,
        box: entries.Corners | None = None,
        direction: Sequence[float] | Numbers | None = None,
        face: Text | None = None,
        follows: bool | None = None,
        joint: Text | None = None,
        kind: entries.BlockLoadKind | None = None,
        muscle: Text | None = None,
        plane: entries.Plane | None = None,
        point: entries.Point | None = None,
        solid: Text | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "box": box,
                "direction": direction,
                "face": face,
                "follows": follows,
                "joint": joint,
                "kind": kind,
                "muscle": muscle,
                "plane": plane,
                "point": point,
                "solid": solid,
            },
        )


class Marker(Part):
    """A named material point of a body or of a block: exactly one of `body` and `solid`.

    * `at`: Place, SI unit m.
    * `body`: Name of the body, or `ground`.
    * `solid`: Name of the block; its node nearest to the place is meant.
    """

    kind, noun = "markers", "marker"

    def __init__(
        self,
        name: str | None = None,
        *,
        at: Sequence[Quantity] | Numbers,
        body: Text | None = None,
        solid: Text | None = None,
    ) -> None:
        super().__init__(
            name,
            {
                "at": at,
                "body": body,
                "solid": solid,
            },
        )

//! Links and joints of a URDF file as they are written, in SI units.

use nalgebra::{Isometry3, Matrix3, Vector3};
use roxmltree::{Document, Node};
use std::path::Path;

use crate::files::json::scope::{Result, refuse};
use crate::files::scene::point::direction;
use crate::files::urdf::element::{Element, LeftOut};
use crate::model::system::{Shape, principal};

/// Relative excess of a moment over the sum of the two others that is one of rounding.
const ROUNDING: f64 = 1e-12;

/// A robot.
pub(super) struct Robot<'a> {
    pub(super) element: Element<'a>,
    pub(super) name: String,
    pub(super) links: Vec<Link<'a>>,
    pub(super) joints: Vec<Joint<'a>>,
}

/// A link.
pub(super) struct Link<'a> {
    pub(super) element: Element<'a>,
    pub(super) name: String,
    /// `None` without a mass.
    pub(super) inertial: Option<Inertial>,
    pub(super) visuals: Vec<Visual>,
}

/// Mass and tensor of inertia about the centre of mass, both in the frame of `pose`, which is that of the centre in the link.
pub(super) struct Inertial {
    pub(super) pose: Isometry3<f64>,
    pub(super) mass: f64,
    pub(super) tensor: Matrix3<f64>,
}

/// A shape, and its pose in the link.
#[derive(Clone)]
pub(super) struct Visual {
    pub(super) pose: Isometry3<f64>,
    pub(super) geometry: Geometry,
}

/// A shape about its origin, in m.
#[derive(Clone)]
pub(super) enum Geometry {
    Plain(Shape),
    Mesh { file: String, scale: [f64; 3] },
}

/// A joint.
pub(super) struct Joint<'a> {
    pub(super) element: Element<'a>,
    pub(super) name: String,
    pub(super) kind: Kind,
    /// Frame of the joint and of the child in the parent.
    pub(super) pose: Isometry3<f64>,
    pub(super) parent: String,
    pub(super) child: String,
    /// Damping in N m s/rad or N s/m, of a joint of one coordinate.
    pub(super) damping: f64,
}

/// Type of a joint, with its axis or normal in the frame of the joint.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Revolute(Vector3<f64>),
    Prismatic(Vector3<f64>),
    Planar(Vector3<f64>),
    Floating,
    Fixed,
}

/// The robot of a document.
pub(super) fn robot<'a>(
    path: &'a Path,
    document: &'a Document<'a>,
    left_out: &mut LeftOut,
) -> Result<Robot<'a>> {
    let root = Element {
        node: document.root_element(),
        owner: "the robot".to_owned(),
        path,
    };
    refuse!(if !root.node.has_tag_name("robot"), root;
        found format!("<{}>", root.node.tag_name().name()), expected "<robot>");
    root.only(&["link", "joint"], &["name", "version"], left_out);
    let owned = |element: Element<'a>, kind: &str| -> Result<(Element<'a>, String)> {
        let name = element.word("name")?.to_owned();
        let owner = format!("the {kind} {name:?}");
        Ok((Element { owner, ..element }, name))
    };
    let mut links = Vec::new();
    for element in root.children("link") {
        let (element, name) = owned(element, "link")?;
        links.push(link(element, name, left_out)?);
    }
    let mut joints = Vec::new();
    for element in root.children("joint") {
        let (element, name) = owned(element, "joint")?;
        joints.push(joint(element, name, left_out)?);
    }
    Ok(Robot {
        name: root.node.attribute("name").unwrap_or("robot").to_owned(),
        element: root.clone(),
        links,
        joints,
    })
}

fn link<'a>(element: Element<'a>, name: String, left_out: &mut LeftOut) -> Result<Link<'a>> {
    element.only(&["inertial", "visual"], &["name"], left_out);
    let inertial = match element.child("inertial")? {
        Some(inertial) => self::inertial(&inertial, left_out)?,
        None => None,
    };
    let mut visuals = Vec::new();
    for visual in element.children("visual") {
        visual.only(&["origin", "geometry"], &["name"], left_out);
        let pose = visual.origin(left_out)?;
        let geometry = geometry(&visual.needed("geometry")?, left_out)?;
        visuals.extend(geometry.map(|geometry| Visual { pose, geometry }));
    }
    Ok(Link {
        element,
        name,
        inertial,
        visuals,
    })
}

/// The inertia of a link; `None` for a mass of zero.
fn inertial(element: &Element<'_>, left_out: &mut LeftOut) -> Result<Option<Inertial>> {
    element.only(&["origin", "mass", "inertia"], &[], left_out);
    let pose = element.origin(left_out)?;
    let mass = element.needed("mass")?;
    mass.only(&[], &["value"], left_out);
    let value = mass.number("value")?;
    refuse!(if value < 0.0, mass;
        found format!("a mass of {value} kg"), expected "a mass that is not negative");
    let inertia = element.needed("inertia")?;
    let names = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
    inertia.only(&[], &names, left_out);
    let mut entries = [0.0; 6];
    for (entry, name) in entries.iter_mut().zip(names) {
        *entry = match name.ends_with(&name[1..2]) {
            true => inertia.number(name)?,
            false => inertia.number_or(name, 0.0)?,
        };
    }
    if value == 0.0 {
        if entries.iter().any(|entry| *entry != 0.0) {
            left_out.add("the <inertia> beside a mass of zero", &element.owner);
        }
        return Ok(None);
    }
    let [xx, xy, xz, yy, yz, zz] = entries;
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let moments = Vector3::from(principal(&tensor).0);
    let largest = moments.max();
    let exceeds = moments.sum() - 2.0 * largest < -ROUNDING * largest;
    refuse!(if moments.min() <= 0.0 || exceeds, inertia;
        found format!("principal moments of {:?} kg m^2", moments.as_slice()),
        expected "positive moments of which none is larger than the sum of the two others");
    Ok(Some(Inertial {
        pose,
        mass: value,
        tensor,
    }))
}

/// A shape; `None` of a kind that is left out.
fn geometry(element: &Element<'_>, left_out: &mut LeftOut) -> Result<Option<Geometry>> {
    const SHAPES: [&str; 4] = ["box", "cylinder", "sphere", "mesh"];
    element.only(&SHAPES, &[], left_out);
    let shapes = element.node.children().filter(Node::is_element);
    match shapes
        .filter(|node| SHAPES.contains(&node.tag_name().name()))
        .count()
    {
        0 => left_out.add("a <geometry> without a shape", &element.owner),
        1 => {}
        _ => left_out.add("all but one shape of a <geometry>", &element.owner),
    }
    if let Some(cuboid) = element.child("box")? {
        cuboid.only(&[], &["size"], left_out);
        let size = cuboid.numbers::<3>("size")?;
        refuse!(if size.iter().any(|side| *side <= 0.0), cuboid;
            found format!("size={size:?}"), expected "positive lengths");
        return Ok(Some(Geometry::Plain(Shape::Box { size })));
    }
    if let Some(cylinder) = element.child("cylinder")? {
        cylinder.only(&[], &["radius", "length"], left_out);
        let (radius, length) = (cylinder.length("radius")?, cylinder.length("length")?);
        return Ok(Some(Geometry::Plain(Shape::Cylinder { radius, length })));
    }
    if let Some(sphere) = element.child("sphere")? {
        sphere.only(&[], &["radius"], left_out);
        let radius = sphere.length("radius")?;
        return Ok(Some(Geometry::Plain(Shape::Sphere { radius })));
    }
    let Some(mesh) = element.child("mesh")? else {
        return Ok(None);
    };
    mesh.only(&[], &["filename", "scale"], left_out);
    let scale = match mesh.node.has_attribute("scale") {
        true => mesh.numbers("scale")?,
        false => [1.0_f64; 3],
    };
    refuse!(if scale.contains(&0.0), mesh;
        found format!("scale={scale:?}"), expected "factors other than zero");
    let file = mesh.word("filename")?.to_owned();
    Ok(Some(Geometry::Mesh { file, scale }))
}

fn joint<'a>(element: Element<'a>, name: String, left_out: &mut LeftOut) -> Result<Joint<'a>> {
    let known = ["origin", "parent", "child", "axis", "dynamics", "limit"];
    element.only(&known, &["name", "type"], left_out);
    let kind = kind(&element, left_out)?;
    let link = |name: &'static str| element.needed(name)?.word("link").map(str::to_owned);
    let mut damping = 0.0;
    if let Some(dynamics) = element.child("dynamics")? {
        dynamics.only(&[], &["damping", "friction"], left_out);
        if dynamics.number_or("friction", 0.0)? != 0.0 {
            left_out.add("friction", &element.owner);
        }
        let value = dynamics.number_or("damping", 0.0)?;
        match kind {
            _ if value < 0.0 => {
                return Err(
                    dynamics.wrong(format!("damping={value}"), "a damping that is not negative")
                );
            }
            Kind::Revolute(_) | Kind::Prismatic(_) => damping = value,
            _ if value > 0.0 => left_out.add("damping", &element.owner),
            _ => {}
        }
    }
    if let Some(limit) = element.child("limit")? {
        for attribute in limit.node.attributes() {
            let name = attribute.name();
            let kind = match name {
                "lower" | "upper" => {
                    "<limit> of the range (\"stops\" of a joint need a stiffness)".to_owned()
                }
                name => format!("<limit> of {name}"),
            };
            left_out.add(kind, &element.owner);
        }
    }
    Ok(Joint {
        pose: element.origin(left_out)?,
        parent: link("parent")?,
        child: link("child")?,
        element,
        name,
        kind,
        damping,
    })
}

fn kind(element: &Element<'_>, left_out: &mut LeftOut) -> Result<Kind> {
    let axis = || match element.child("axis")? {
        None => Ok(Vector3::x()),
        Some(axis) => {
            let written = axis.numbers::<3>("xyz")?;
            let missing = || axis.wrong(format!("xyz={written:?}"), "a direction");
            direction(&written).ok_or_else(missing)
        }
    };
    if let Some(axis) = element.child("axis")? {
        axis.only(&[], &["xyz"], left_out);
    }
    match element.word("type")? {
        "revolute" | "continuous" => Ok(Kind::Revolute(axis()?)),
        "prismatic" => Ok(Kind::Prismatic(axis()?)),
        "planar" => Ok(Kind::Planar(axis()?)),
        "floating" => Ok(Kind::Floating),
        "fixed" => Ok(Kind::Fixed),
        other => {
            let expected = "revolute, continuous, prismatic, planar, floating or fixed";
            Err(element.wrong(format!("type={other:?}"), expected))
        }
    }
}

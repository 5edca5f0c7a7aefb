//! Geoms: what they weigh, and how pictures show them. Contacts between them are not simulated.

use super::assets::Assets;
use super::element::Element;
use super::placement;
use super::settings::Settings;
use super::solid::Solid;
use crate::diagnostics::Diagnostic;
use crate::read::Sink;
use crate::robot::mass::moved;
use crate::shape::{Geometry, Mesh};
use crate::source::Span;
use hamel_runtime::shown::Number;
use hamel_runtime::spatial::{MassProperties, Pose};
use nalgebra::{Matrix3, Vector3};

/// Masses and volumes below this are none to MuJoCo.
const NOTHING: f64 = 1e-14;

/// The last group that MuJoCo's viewer shows.
const LAST_SHOWN: f64 = 2.0;

/// The density of geoms that say none, kg/m³.
const WATER: f64 = 1000.0;

/// A geom of a body.
#[derive(Clone, Debug)]
pub(super) struct Geom {
    /// What messages call it.
    pub(super) owner: String,
    /// Its shape, if it is a simple one.
    solid: Option<Solid>,
    /// What its mesh weighs with the density 1, if it is a mesh that has been read.
    bulk: Option<MassProperties>,
    /// The file of its mesh, if it is a mesh that pictures show.
    file: Option<Mesh>,
    /// The name of its type.
    kind: &'static str,
    /// Its frame in that of the body.
    pub(super) pose: Pose<f64>,
    /// Its group.
    group: f64,
    mass: Option<f64>,
    density: f64,
    hollow: bool,
    rgba: Option<[f64; 4]>,
    span: Span,
}

impl Geom {
    /// The geom that an element describes, which stands in `frame` of its body.
    pub(super) fn read(
        owner: String,
        element: &Element<'_>,
        frame: &Pose<f64>,
        (settings, assets): (&Settings, &Assets),
        sink: &mut Sink,
    ) -> Option<Self> {
        const KINDS: [&str; 9] = [
            "sphere",
            "plane",
            "hfield",
            "capsule",
            "ellipsoid",
            "cylinder",
            "box",
            "mesh",
            "sdf",
        ];
        let said = element.text("type").unwrap_or("sphere");
        let mut kind = *KINDS.iter().find(|kind| **kind == said)?;
        let simple = !matches!(kind, "plane" | "hfield" | "mesh" | "sdf");
        if simple && element.text("mesh").is_some() {
            kind = "mesh";
        }
        let (pose, solid) = match kind {
            "plane" | "hfield" | "mesh" | "sdf" => {
                (placement::pose(&owner, element, settings, sink)?, None)
            }
            _ => {
                let (pose, sizes) = placed(&owner, kind, element, settings, sink)?;
                (pose, Some(solid(&owner, kind, sizes, element, sink)?))
            }
        };
        let sound = [
            ("mass", element.number("mass")),
            ("density", element.number("density")),
        ];
        for (name, value) in sound {
            if let Some(value) = value.filter(|value| *value < 0.0) {
                let message = format!(
                    "{owner}: `{name}` is {:?}, but must be at least 0",
                    Number(value)
                );
                sink.push(Diagnostic::new(element.span(name), message));
            }
        }
        let mesh = element.text("mesh").filter(|_| said == "mesh");
        let material = || assets.colors.get(element.text("material")?).copied();
        Some(Self {
            owner,
            solid,
            bulk: mesh.and_then(|name| assets.bulks.get(name).copied()),
            file: mesh.and_then(|name| assets.files.get(name).cloned()),
            kind,
            pose: *frame * pose,
            group: element.number("group").unwrap_or(0.0),
            mass: element.number("mass"),
            density: element.number("density").unwrap_or(WATER),
            hollow: element.switch("shellinertia").unwrap_or(false),
            rgba: element.vector("rgba").or_else(material),
            span: element.span("type"),
        })
    }

    /// What it adds to the mass of its body, in that one's frame: nothing where its group is not among those that have mass.
    pub(super) fn mass(&self, settings: &Settings, sink: &mut Sink) -> Option<MassProperties> {
        let [first, last] = settings.groups;
        if self.group < first || self.group > last || self.mass == Some(0.0) {
            return None;
        }
        let unit = match (&self.solid, self.bulk) {
            (Some(solid), _) => self.unit(solid),
            (None, Some(bulk)) => bulk,
            (None, None) => {
                self.refuse(sink);
                return None;
            }
        };
        let mass = match self.mass {
            Some(mass) if unit.mass > NOTHING => mass,
            Some(_) => 0.0,
            None => self.density * unit.mass,
        };
        let own = MassProperties {
            mass,
            inertia_com: unit.inertia_com * (mass / unit.mass),
            ..unit
        };
        (mass > NOTHING).then(|| moved(&own, &self.pose))
    }

    /// What a simple shape weighs with the density 1.
    fn unit(&self, solid: &Solid) -> MassProperties {
        let mass = match self.hollow {
            true => solid.surface(),
            false => solid.volume(),
        };
        let moments = match self.hollow {
            true => solid.hollow(mass),
            false => solid.filled(mass),
        };
        MassProperties {
            mass,
            com: Vector3::zeros(),
            inertia_com: Matrix3::from_diagonal(&moments),
        }
    }

    /// Refuses what has mass, but not which.
    fn refuse(&self, sink: &mut Sink) {
        let weighs = self.mass.is_some() || self.density != 0.0;
        if self.kind == "plane" || !weighs {
            return;
        }
        let message = format!(
            "{}: the mass of its body is that of its geoms, and this {} is none whose mass is known",
            self.owner, self.kind
        );
        let error = Diagnostic::new(self.span.clone(), message);
        sink.push(error.help(
            "STL in binary, OBJ and MSH are read from the files of a model that is read from its file, except for convex hulls (`inertia=\"convex\"`). \
             Else give the body an <inertial>: MuJoCo writes one by `saveinertial=\"true\"` of <compiler>; or give the geom the mass 0",
        ));
    }

    /// How pictures show it; an error says why they do not, with nothing to say where they need not.
    pub(super) fn shape(&self) -> Result<Geometry, Option<&'static str>> {
        let is_seen =
            self.group <= LAST_SHOWN && self.rgba.is_none_or(|[_, _, _, alpha]| alpha > 0.0);
        match self.solid {
            _ if !is_seen => Err(None),
            Some(Solid::Sphere(r)) => Ok(Geometry::Sphere(r)),
            Some(Solid::Capsule(radius, half)) => Ok(Geometry::Capsule {
                radius,
                length: 2.0 * half,
            }),
            Some(Solid::Cylinder(radius, half)) => Ok(Geometry::Cylinder {
                radius,
                length: 2.0 * half,
            }),
            Some(Solid::Box(half)) => Ok(Geometry::Box(half * 2.0)),
            None if self.kind == "plane" => Err(None),
            _ => self.file.clone().map(Geometry::Mesh).ok_or(Some(
                "ellipsoids, height fields, SDFs, meshes without a file and those with `refpos` or `refquat` are not drawn",
            )),
        }
    }

    /// Its colour, where it says one.
    pub(super) fn color(&self) -> Option<[u8; 3]> {
        let [red, green, blue, _] = self.rgba?;
        let byte = |part: f64| (part.clamp(0.0, 1.0) * 255.0).round() as u8;
        Some([byte(red), byte(green), byte(blue)])
    }
}

/// Where a geom stands in its frame, and its sizes: those that it says, or what lies between two points.
fn placed(
    owner: &str,
    kind: &str,
    element: &Element<'_>,
    settings: &Settings,
    sink: &mut Sink,
) -> Option<(Pose<f64>, Vec<f64>)> {
    let mut sizes = element.numbers("size").unwrap_or_default();
    let Some([a, b, c, d, e, f]) = element.vector("fromto") else {
        return Some((placement::pose(owner, element, settings, sink)?, sizes));
    };
    let refused = match kind {
        "sphere" => Some("`fromto` is for capsules, cylinders, ellipsoids and boxes"),
        _ if placement::position(element) != Vector3::zeros() => {
            Some("`pos` and `fromto` exclude each other")
        }
        _ => None,
    };
    if let Some(why) = refused {
        sink.push(Diagnostic::new(
            element.span("fromto"),
            format!("{owner}: {why}"),
        ));
        return None;
    }
    let pose = placement::segment(owner, element, sink)?;
    let half = (Vector3::new(a, b, c) - Vector3::new(d, e, f)).norm() / 2.0;
    sizes.truncate(1);
    if let (Some(&size), "ellipsoid" | "box") = (sizes.first(), kind) {
        sizes.push(size);
    }
    sizes.push(half);
    Some((pose, sizes))
}

fn solid(
    owner: &str,
    kind: &str,
    sizes: Vec<f64>,
    element: &Element<'_>,
    sink: &mut Sink,
) -> Option<Solid> {
    let wanted = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        _ => 3,
    };
    let mut sizes = sizes.into_iter().take(wanted);
    let all: Vec<f64> = sizes.by_ref().filter(|size| *size > 0.0).collect();
    if all.len() < wanted {
        let message = match wanted {
            1 => format!("{owner}: a {kind} needs a size above 0"),
            _ => format!("{owner}: a {kind} needs {wanted} sizes above 0"),
        };
        sink.push(Diagnostic::new(element.span("size"), message));
        return None;
    }
    Some(match (kind, all.as_slice()) {
        ("capsule", [r, half]) => Solid::Capsule(*r, *half),
        ("cylinder", [r, half]) => Solid::Cylinder(*r, *half),
        ("ellipsoid", [x, y, z]) => Solid::Ellipsoid(Vector3::new(*x, *y, *z)),
        ("box", [x, y, z]) => Solid::Box(Vector3::new(*x, *y, *z)),
        (_, [r, ..]) => Solid::Sphere(*r),
        _ => return None,
    })
}

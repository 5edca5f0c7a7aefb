//! Meshes: the files that pictures show, and what those weigh that bodies have their masses of, read from their files, STL, OBJ or MSH, or from the model itself.

use super::assets::assets;
use super::bulk::{Filling, Triangles, bulk};
use super::defaults::{Defaults, MAIN};
use super::element::Element;
use crate::parse::rotation;
use crate::read::Sink;
use crate::robot::xml::finite;
use crate::shape::Mesh;
use crate::source::Located;
use hamel_runtime::spatial::MassProperties;
use nalgebra::{Matrix3, Vector3, Vector4};
use roxmltree::{Document, Node};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::path::Path;

/// The target of the instructions that stand before a mesh, with its name and what it weighs with the density 1.
const TARGET: &str = "hamel-mesh";

/// Most bytes of a mesh.
const MOST_BYTES: u64 = 256 << 20;

/// What meshes weigh with the density 1, by their names.
pub(super) type Bulks = HashMap<String, MassProperties>;

/// A model with instructions that say what its meshes weigh, of those that bodies may have their masses of and whose files can be read.
pub(super) fn weighed(main: &Path, text: String) -> String {
    if !text.contains("<mesh") {
        return text;
    }
    let Some(told) = Document::parse(&text)
        .ok()
        .map(|document| told(main, document.root_element()))
    else {
        return text;
    };
    let mut whole = String::new();
    let mut done = 0;
    for (at, instruction) in told {
        whole.push_str(&text[done..at]);
        whole.push_str(&instruction);
        done = at;
    }
    whole.push_str(&text[done..]);
    whole
}

/// The instructions, each with its place.
fn told(main: &Path, root: Node<'_, '_>) -> Vec<(usize, String)> {
    let needed = needed(root);
    // What is wrong is told where the model is read.
    let mut sink = Sink::default();
    let defaults = Defaults::read(root, &mut sink);
    let folder = folder(main, root);
    let found = meshes(root).filter_map(|node| {
        let element = defaults.element(node, MAIN, &mut sink);
        let file = node.attribute("file")?;
        let name = name(node)?;
        if !needed.contains(name.as_str()) || name.contains(['?', '\t']) {
            return None;
        }
        let own = solid(&element, triangles(&folder.join(file))?)?;
        let mut said = format!("<?{TARGET} {name}\t{:e}", own.mass);
        let numbers = own.com.iter().chain(own.inertia_com.iter());
        numbers.for_each(|number| {
            let _ = write!(said, " {number:e}");
        });
        Some((node.range().start, format!("{said}?>")))
    });
    found.collect()
}

/// The meshes of a model that has been completed.
pub(super) fn bulks<'a>(root: Node<'a, 'a>, defaults: &Defaults<'a>, sink: &mut Sink) -> Bulks {
    let mut bulks = Bulks::new();
    for own in root
        .descendants()
        .filter_map(|node| node.pi())
        .filter(|own| own.target == TARGET)
    {
        let told = own.value.and_then(|value| value.split_once('\t'));
        if let Some((name, numbers)) = told
            && let Some([mass, x, y, z, inertia @ ..]) = finite(numbers).as_deref()
            && inertia.len() == 9
        {
            let own = MassProperties {
                mass: *mass,
                com: Vector3::new(*x, *y, *z),
                inertia_com: Matrix3::from_column_slice(inertia),
            };
            bulks.insert(name.to_owned(), own);
        }
    }
    for node in meshes(root).filter(|node| !node.has_attribute("file")) {
        let numbers = |name: &str| node.attribute(name).and_then(finite);
        let (Some(corners), Some(faces)) = (numbers("vertex"), numbers("face")) else {
            continue;
        };
        let corners = corners.chunks_exact(3).map(Vector3::from_column_slice);
        let faces = faces
            .chunks_exact(3)
            .map(|own| [own[0] as usize, own[1] as usize, own[2] as usize]);
        let own = Triangles {
            corners: corners
                .map(|corner| corner.map(|own| f64::from(own as f32)))
                .collect(),
            faces: faces.collect(),
        };
        let element = defaults.element(node, MAIN, sink);
        if let (Some(name), Some(own)) = (name(node), solid(&element, own)) {
            bulks.insert(name, own);
        }
    }
    bulks
}

fn meshes<'a>(root: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> {
    assets(root, "mesh")
}

/// The files of meshes that stand in pictures as their files say, by the names of the meshes; paths are from the folder of the model.
pub(super) fn files<'a>(
    root: Node<'a, 'a>,
    defaults: &Defaults<'a>,
    sink: &mut Sink,
) -> HashMap<String, Mesh> {
    let folder = folder(Path::new(""), root);
    let found = meshes(root).filter_map(|node| {
        let element = defaults.element(node, MAIN, sink);
        let file = folder.join(node.attribute("file")?);
        let is_moved = ["refpos", "refquat"].map(|own| element.text(own).is_some());
        let scale = element
            .vector("scale")
            .map_or(Vector3::repeat(1.0), Vector3::from);
        let mesh = Mesh {
            file: file.to_string_lossy().into_owned(),
            scale,
        };
        let is_drawn = is_moved == [false; 2] && scale.iter().all(|factor| *factor != 0.0);
        let is_drawn = is_drawn && Mesh::is_name(&mesh.file);
        Some((name(node)?, mesh)).filter(|_| is_drawn)
    });
    found.collect()
}

/// The name of a mesh: its own, or that of its file.
fn name(node: Node<'_, '_>) -> Option<String> {
    let own = node.attribute("name").map(str::to_owned);
    own.or_else(|| {
        Some(
            Path::new(node.attribute("file")?)
                .file_stem()?
                .to_string_lossy()
                .into_owned(),
        )
    })
}

/// The meshes of geoms whose bodies have no `<inertial>`, or whose model asks for masses of geoms; those of classes are among them.
fn needed<'a>(root: Node<'a, 'a>) -> HashSet<&'a str> {
    let asks = root
        .children()
        .any(|node| node.attribute("inertiafromgeom") == Some("true"));
    let weighs = |geom: &Node<'_, '_>| {
        let mut above = geom.ancestors().filter(|node| !node.has_tag_name("geom"));
        let body = above.find(|node| !node.has_tag_name("frame"));
        let has_inertial =
            |body: Node<'_, '_>| body.children().any(|node| node.has_tag_name("inertial"));
        asks || !body.is_some_and(has_inertial)
    };
    let geoms = root
        .descendants()
        .filter(|node| node.has_tag_name("geom"))
        .filter(weighs);
    geoms.filter_map(|node| node.attribute("mesh")).collect()
}

/// The folder of the meshes.
fn folder(main: &Path, root: Node<'_, '_>) -> std::path::PathBuf {
    let said = |name: &str| {
        let compilers = root.children().filter(|node| node.has_tag_name("compiler"));
        compilers
            .filter_map(|node| node.attribute(name))
            .next_back()
    };
    main.join(said("meshdir").or(said("assetdir")).unwrap_or(""))
}

/// What a mesh weighs, moved and scaled as its element says.
fn solid(element: &Element<'_>, mut mesh: Triangles) -> Option<MassProperties> {
    let filling = match element.text("inertia") {
        None | Some("legacy") => Filling::Pyramids,
        Some("exact") => Filling::Inside,
        Some("shell") => Filling::Faces,
        // Of its convex hull, which is not computed.
        Some(_) => return None,
    };
    let position = element
        .vector("refpos")
        .map_or_else(Vector3::zeros, Vector3::from);
    let scale = element
        .vector("scale")
        .map_or(Vector3::repeat(1.0), Vector3::from);
    let turn = match element.vector("refquat") {
        Some(quaternion) => {
            let quaternion = Located::new(Vector4::from(quaternion), 0..0);
            rotation::from_any_quaternion("", quaternion, &mut Sink::default())?
        }
        None => Matrix3::identity(),
    };
    for corner in &mut mesh.corners {
        *corner = (turn.transpose() * (*corner - position)).component_mul(&scale);
    }
    if scale.product() < 0.0 {
        mesh.faces.iter_mut().for_each(|face| face.swap(1, 2));
    }
    bulk(&mesh, filling)
}

/// The triangles in a file, by its ending.
fn triangles(path: &Path) -> Option<Triangles> {
    let ending = path.extension()?.to_ascii_lowercase();
    // Devices and pipes may have no end.
    let found = std::fs::metadata(path).ok()?;
    if !found.is_file() || found.len() > MOST_BYTES {
        return None;
    }
    let bytes = std::fs::read(path).ok()?;
    match ending.to_str()? {
        "stl" => stl(&bytes),
        "obj" => obj(std::str::from_utf8(&bytes).ok()?),
        "msh" => msh(&bytes),
        _ => None,
    }
}

/// Three numbers of four bytes.
fn point(bytes: &[u8]) -> Option<Vector3<f64>> {
    let number = |at: usize| {
        Some(f64::from(f32::from_le_bytes(
            bytes.get(at..at + 4)?.try_into().ok()?,
        )))
    };
    Some(Vector3::new(number(0)?, number(4)?, number(8)?))
}

fn whole(bytes: &[u8], at: usize) -> Option<usize> {
    usize::try_from(i32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)).ok()
}

/// Binary STL.
fn stl(bytes: &[u8]) -> Option<Triangles> {
    let count = whole(bytes, 80)?;
    let mut mesh = Triangles::default();
    for face in bytes.get(84..)?.chunks_exact(50).take(count) {
        let first = mesh.corners.len();
        for corner in 0..3 {
            mesh.corners.push(point(face.get(12 + 12 * corner..)?)?);
        }
        mesh.faces.push([first, first + 1, first + 2]);
    }
    (mesh.faces.len() == count).then_some(mesh)
}

/// Corners and faces of an OBJ; polygons are fans of triangles.
fn obj(text: &str) -> Option<Triangles> {
    let mut mesh = Triangles::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words
                    .take(3)
                    .map(|word| word.parse::<f32>().map(f64::from))
                    .collect::<Result<_, _>>()
                    .ok()?;
                mesh.corners
                    .push(Vector3::from(<[f64; 3]>::try_from(numbers).ok()?));
            }
            Some("f") => {
                let count = mesh.corners.len();
                let corner = |word: &str| {
                    let place: i64 = word.split('/').next()?.parse().ok()?;
                    // From 1, or back from the last one.
                    match place {
                        1.. => usize::try_from(place - 1).ok(),
                        _ => count.checked_sub(usize::try_from(-place).ok()?),
                    }
                };
                let corners: Vec<usize> = words.map(corner).collect::<Option<_>>()?;
                let (first, others) = corners.split_first()?;
                mesh.faces
                    .extend(others.windows(2).map(|pair| [*first, pair[0], pair[1]]));
            }
            _ => {}
        }
    }
    Some(mesh)
}

/// MuJoCo's own format.
fn msh(bytes: &[u8]) -> Option<Triangles> {
    let [corners, normals, textures, faces] = [0, 4, 8, 12].map(|at| whole(bytes, at));
    let (corners, normals, textures, faces) = (corners?, normals?, textures?, faces?);
    let points = bytes.get(16..16 + 12 * corners)?;
    let indices = bytes.get(16 + 12 * corners + 12 * normals + 8 * textures..)?;
    let face = |own: &[u8]| Some([whole(own, 0)?, whole(own, 4)?, whole(own, 8)?]);
    let faces: Vec<[usize; 3]> = indices
        .chunks_exact(12)
        .take(faces)
        .map(face)
        .collect::<Option<_>>()?;
    Some(Triangles {
        corners: points.chunks_exact(12).map(point).collect::<Option<_>>()?,
        faces,
    })
}

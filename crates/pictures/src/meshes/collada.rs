//! COLLADA (`.dae`): the triangles of the geometries that its scene shows, in metres, where its nodes place them.

use super::{MOST_PARTS, Part};
use nalgebra::{Matrix4, Point3, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;

/// The parts of the mesh in a text, one for each material of each geometry that is shown.
///
/// # Errors
/// What is no XML, has no scene, or shows more than [`MOST_PARTS`] nodes; in words.
pub fn read(text: &str) -> Result<Vec<Part>, String> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    let document =
        Document::parse_with_options(text, options).map_err(|error| error.to_string())?;
    let elements = document.descendants();
    let ids = elements.filter_map(|element| Some((element.attribute("id")?, element)));
    let file = File { ids: ids.collect() };
    let root = document.root_element();
    let shown = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let scene = shown.and_then(|shown| file.target(shown, "url"));
    let scene = scene.ok_or("it has no scene")?;
    let unit = child(root, "asset").and_then(|asset| child(asset, "unit")?.attribute("meter"));
    let unit = unit.and_then(|unit| unit.parse().ok()).unwrap_or(1.0);
    file.parts(scene, unit)
}

/// The elements that others refer to, by their identifiers.
struct File<'a> {
    ids: HashMap<&'a str, Node<'a, 'a>>,
}

impl<'a> File<'a> {
    /// The element that an attribute refers to.
    fn target(&self, element: Node<'a, 'a>, attribute: &str) -> Option<Node<'a, 'a>> {
        let url = element.attribute(attribute)?;
        self.ids.get(url.strip_prefix('#').unwrap_or(url)).copied()
    }

    /// What the nodes of a scene show. Nodes may refer to others, in a circle by mistake: their number is limited.
    fn parts(&self, scene: Node<'a, 'a>, unit: f64) -> Result<Vec<Part>, String> {
        let mut parts = Vec::new();
        let mut waiting = vec![(scene, Matrix4::new_scaling(unit))];
        let mut seen = 0;
        while let Some((node, above)) = waiting.pop() {
            let place = above * transform(node);
            for own in node.children().filter(Node::is_element) {
                seen += 1;
                if seen > MOST_PARTS {
                    return Err(format!("it shows more than {MOST_PARTS} nodes"));
                }
                match own.tag_name().name() {
                    "node" => waiting.push((own, place)),
                    "instance_node" => {
                        waiting.extend(self.target(own, "url").map(|node| (node, place)));
                    }
                    "instance_geometry" => self.geometry(own, &place, &mut parts),
                    _ => {}
                }
            }
        }
        Ok(parts)
    }

    /// Adds the primitives of an instance of a geometry.
    fn geometry(&self, instance: Node<'a, 'a>, place: &Matrix4<f64>, parts: &mut Vec<Part>) {
        let geometry = self.target(instance, "url");
        let Some(mesh) = geometry.and_then(|geometry| child(geometry, "mesh")) else {
            return;
        };
        for primitive in mesh.children().filter(Node::is_element) {
            if let Some(mut part) = self.primitive(primitive, place) {
                let symbol = primitive.attribute("material");
                part.color = symbol.and_then(|symbol| self.color(instance, symbol));
                parts.push(part);
            }
        }
    }

    /// The triangles of a primitive, without its colour; `None` for what is none, and where something is missing.
    fn primitive(&self, primitive: Node<'a, 'a>, place: &Matrix4<f64>) -> Option<Part> {
        let kind = primitive.tag_name().name();
        if !KINDS.contains(&kind) {
            return None;
        }
        let inputs = children(primitive, "input");
        let offset = |input: &Node<'_, '_>| -> usize {
            let offset = input.attribute("offset");
            offset.and_then(|own| own.parse().ok()).unwrap_or(0)
        };
        let last = inputs.clone().map(|input| offset(&input)).max()?;
        let vertex = with_semantic(inputs, "VERTEX")?;
        let first = offset(&vertex);
        let position = children(self.target(vertex, "source")?, "input");
        let position = with_semantic(position, "POSITION")?;
        let corners = self.corners(self.target(position, "source")?)?;
        let mut triangles = Vec::new();
        for list in children(primitive, "p") {
            let places: Vec<u32> = numbers(list)?;
            let places = places.chunks_exact(last.checked_add(1)?);
            let places: Vec<u32> = places.map(|own| own[first]).collect();
            let counts = match kind {
                "triangles" => vec![3; places.len() / 3],
                "polylist" => numbers(child(primitive, "vcount")?)?,
                _ => vec![places.len()],
            };
            triangles.extend(self::triangles(kind, &places, &counts)?);
        }
        let moved = |corner: [f64; 3]| {
            let corner = place.transform_point(&Point3::from(corner));
            corner.coords.map(|number| number as f32).into()
        };
        let mut part = Part {
            corners: corners.into_iter().map(moved).collect(),
            triangles,
            color: None,
        };
        if place.determinant() < 0.0 {
            part.turn_over();
        }
        Some(part)
    }

    /// The points of a source.
    fn corners(&self, source: Node<'a, 'a>) -> Option<Vec<[f64; 3]>> {
        let accessor = child(child(source, "technique_common")?, "accessor")?;
        let array = self.target(accessor, "source")?;
        let whole = |name: &str| -> Option<usize> { accessor.attribute(name)?.parse().ok() };
        let (offset, stride) = (whole("offset").unwrap_or(0), whole("stride").unwrap_or(1));
        let values: Vec<f64> = numbers(array)?;
        let points = values.get(offset..)?.chunks(stride.max(1));
        let points = points.filter_map(|own| own.first_chunk().copied());
        Some(points.collect())
    }

    /// The diffuse colour that an instance binds to the symbol of a material; `None` where a texture is in its place.
    fn color(&self, instance: Node<'a, 'a>, symbol: &str) -> Option<[u8; 3]> {
        let bound = child(child(instance, "bind_material")?, "technique_common")?;
        let bound = children(bound, "instance_material")
            .find(|own| own.attribute("symbol") == Some(symbol))?;
        let material = child(self.target(bound, "target")?, "instance_effect")?;
        let profile = child(self.target(material, "url")?, "profile_COMMON")?;
        let technique = child(profile, "technique")?;
        let shading = technique
            .children()
            .find(|own| matches!(own.tag_name().name(), "phong" | "lambert" | "blinn"))?;
        let color: Vec<f32> = numbers(child(child(shading, "diffuse")?, "color")?)?;
        color.first_chunk().copied().map(super::color)
    }
}

/// Primitives that have triangles.
const KINDS: [&str; 5] = ["triangles", "polylist", "polygons", "trifans", "tristrips"];

/// The triangles of polygons with so many corners each, as fans, or of strips.
fn triangles(kind: &str, mut places: &[u32], counts: &[usize]) -> Option<Vec<[u32; 3]>> {
    let mut found = Vec::new();
    for &count in counts {
        let (polygon, rest) = places.split_at_checked(count)?;
        places = rest;
        if kind == "tristrips" {
            let strip = polygon.windows(3).enumerate();
            found.extend(strip.map(|(index, own)| match index % 2 {
                0 => [own[0], own[1], own[2]],
                _ => [own[1], own[0], own[2]],
            }));
        } else if let Some((start, others)) = polygon.split_first() {
            found.extend(others.windows(2).map(|own| [*start, own[0], own[1]]));
        }
    }
    Some(found)
}

/// The first of some inputs that means this.
fn with_semantic<'a>(
    mut inputs: impl Iterator<Item = Node<'a, 'a>>,
    semantic: &str,
) -> Option<Node<'a, 'a>> {
    inputs.find(|own| own.attribute("semantic") == Some(semantic))
}

/// The transformations of a node, one after the other.
fn transform(node: Node<'_, '_>) -> Matrix4<f64> {
    let own = node.children().filter_map(|element| {
        let numbers: Vec<f64> = numbers(element)?;
        Some(match (element.tag_name().name(), &*numbers) {
            ("matrix", all) if all.len() == 16 => Matrix4::from_row_slice(all),
            ("translate", &[x, y, z]) => Matrix4::new_translation(&Vector3::new(x, y, z)),
            ("scale", &[x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z)),
            ("rotate", &[x, y, z, degrees]) => {
                let axis = Unit::try_new(Vector3::new(x, y, z), 0.0)?;
                Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()
            }
            _ => return None,
        })
    });
    own.fold(Matrix4::identity(), |all, own| all * own)
}

/// The numbers in an element; `None` where something else is there.
fn numbers<T: std::str::FromStr>(element: Node<'_, '_>) -> Option<Vec<T>> {
    let words = element.text().unwrap_or_default().split_ascii_whitespace();
    words.map(|word| word.parse().ok()).collect()
}

fn child<'a>(element: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    children(element, name).next()
}

fn children<'a, 'n>(
    element: Node<'a, 'a>,
    name: &'n str,
) -> impl Iterator<Item = Node<'a, 'a>> + Clone + use<'a, 'n> {
    let all = element.children();
    all.filter(move |own| own.tag_name().name() == name)
}

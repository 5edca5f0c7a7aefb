//! What pictures show of links.

use super::{notices, robot};
use hamel_scene::{Geometry, Mesh};
use nalgebra::Vector3;

#[test]
fn simple_visual_shapes_are_kept_for_pictures() {
    let more = "<material name=\"grey\"><color rgba=\"0.5 0.5 0.5 1\"/></material>\
        <link name=\"tip\"><visual><origin xyz=\"0 0 1\" rpy=\"0 0 1.5707963267948966\"/><geometry><box size=\"1 2 3\"/></geometry>\
        <material name=\"grey\"/></visual>\
        <visual><geometry><cylinder radius=\"0.1\" length=\"0.4\"/></geometry><material name=\"own\"><color rgba=\"1 0 0 1\"/>\
        </material></visual><visual><geometry><sphere radius=\"-1\"/></geometry></visual><visual/></link>\
        <joint name=\"end\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tip\"/><origin xyz=\"1 0 0\"/></joint>";
    let import = robot("revolute", "<axis xyz=\"0 0 1\"/>", more);
    let [block, pin] = import.scene.shapes.as_slice() else {
        panic!("two shapes");
    };
    assert_eq!(block.geometry, Geometry::Box(Vector3::new(1.0, 2.0, 3.0)));
    // The tip is a part of the arm, one metre along x.
    assert_eq!(
        (block.body, block.at.translation),
        (Some(0), Vector3::new(1.0, 0.0, 1.0))
    );
    assert_eq!(
        (block.color, pin.color),
        (Some([128; 3]), Some([255, 0, 0]))
    );
    let told = "note: visual shapes that are not complete are not drawn: link `tip`";
    assert!(notices(&import).iter().any(|notice| notice == told));
    let text = import.to_toml();
    let again = hamel_scene::Scene::from_toml(&text, "r.toml").expect("a sound text");
    assert_eq!(again.shapes, import.scene.shapes);
}

#[test]
fn meshes_are_kept_by_the_names_of_their_files() {
    let visual = |mesh: &str| format!("<visual><geometry><mesh {mesh}/></geometry></visual>");
    let visuals = [
        "filename=\"package://arm/meshes/tip.dae\"",
        "filename=\"tip.stl\" scale=\"0.001 0.001 -0.001\"",
        "filename=\"tip.stl\" scale=\"1 0 1\"",
        "filename=\"a&#10;b.stl\"",
        "scale=\"1 1 1\"",
    ];
    let more = format!(
        "<link name=\"tip\">{}</link><joint name=\"end\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tip\"/></joint>",
        visuals.map(visual).concat()
    );
    let import = robot("revolute", "<axis xyz=\"0 0 1\"/>", &more);
    let mesh = |file: &str, scale: [f64; 3]| {
        Geometry::Mesh(Mesh {
            file: file.to_owned(),
            scale: scale.into(),
        })
    };
    let shapes = import.scene.shapes.iter().map(|shape| &shape.geometry);
    let wanted = [
        mesh("package://arm/meshes/tip.dae", [1.0; 3]),
        mesh("tip.stl", [1e-3, 1e-3, -1e-3]),
    ];
    assert!(shapes.eq(&wanted));
    let told = "note: visual shapes that are not complete are not drawn: link `tip`";
    assert!(notices(&import).iter().any(|notice| notice == told));
    let text = import.to_toml();
    let again = hamel_scene::Scene::from_toml(&text, "r.toml").expect("a sound text");
    assert_eq!(again.shapes, import.scene.shapes);
}

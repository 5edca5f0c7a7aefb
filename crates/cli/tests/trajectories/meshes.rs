//! Meshes of robots and scenes on their pages.

use super::recorded::{Page, simulate};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// Corners of a tetrahedron, and its faces seen from outside.
const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[u16; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];

/// In binary, although it begins as texts do; so do files of some programs.
fn stl() -> Vec<u8> {
    let mut bytes = b"solid tetrahedron".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(4_u32.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        let corners = face.map(|place| CORNERS[usize::from(place)]);
        bytes.extend(corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj() -> String {
    let mut text = "mtllib paint.mtl\n".to_owned();
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    text += "usemtl red\n";
    for [a, b, c] in FACES.map(|face| face.map(|place| place + 1)) {
        text += &format!("f {a} {b} {c}\n");
    }
    text
}

/// In centimetres, and turned by its node from x, y, z to y, z, x.
fn collada() -> String {
    let numbers = CORNERS.map(|[x, y, z]| format!("{} {} {}", 100.0 * z, 100.0 * x, 100.0 * y));
    let places = FACES.as_flattened().iter().map(u16::to_string);
    let places: Vec<_> = places.collect();
    format!(
        "<?xml version=\"1.0\"?>
<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">
  <asset><unit name=\"centimeter\" meter=\"0.01\"/><up_axis>Z_UP</up_axis></asset>
  <library_effects><effect id=\"green\"><profile_COMMON><technique sid=\"t\"><lambert><diffuse><color>0 1 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
  <library_materials><material id=\"paint\" name=\"paint\"><instance_effect url=\"#green\"/></material></library_materials>
  <library_geometries><geometry id=\"g\"><mesh>
    <source id=\"p\"><float_array id=\"a\" count=\"12\">{}</float_array><technique_common><accessor source=\"#a\" count=\"4\" stride=\"3\">\
    <param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>
    <vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>
    <triangles material=\"m\" count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>{}</p></triangles>
  </mesh></geometry></library_geometries>
  <library_visual_scenes><visual_scene id=\"s\"><node id=\"n\"><matrix>0 1 0 0 0 0 1 0 1 0 0 0 0 0 0 1</matrix>
    <instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"m\" target=\"#paint\"/></technique_common></bind_material></instance_geometry>
  </node></visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url=\"#s\"/></scene>
</COLLADA>",
        numbers.join(" "),
        places.join(" ")
    )
}

/// With y upwards.
fn gltf() -> String {
    let corners = CORNERS.map(|[x, y, z]| [x, z, -y]);
    let corners = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes());
    let faces = FACES.as_flattened().iter().flat_map(|x| x.to_le_bytes());
    let buffer = STANDARD.encode(corners.chain(faces).collect::<Vec<u8>>());
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "materials": [{{"pbrMetallicRoughness": {{"baseColorFactor": [0.0, 0.0, 1.0, 1.0]}}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, -2], "max": [1, 3, 0]}},
                      {{"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 24}}],
        "buffers": [{{"byteLength": 72, "uri": "data:application/octet-stream;base64,{buffer}"}}]}}"#
    )
}

/// A robot in a package with the meshes of these names.
fn robot(name: &str, meshes: &[&str]) -> PathBuf {
    let package = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let folder = package.join("meshes");
    fs::create_dir_all(&folder).expect("a folder for tests");
    let write = |name: &str, bytes: Vec<u8>| fs::write(folder.join(name), bytes).expect("a file");
    write("own.STL", stl());
    write("own.obj", obj().into_bytes());
    write("paint.mtl", b"newmtl red\nKd 1 0 0\n".to_vec());
    write("own.dae", collada().into_bytes());
    write("own.gltf", gltf().into_bytes());
    write("torn.stl", stl()[..150].to_vec());
    write("words.dae", b"<COLLADA".to_vec());
    let dangling = collada().replace("source=\"#p\"", "source=\"#q\"");
    write("dangling.dae", dangling.into_bytes());
    let visual = |mesh: &&str| {
        format!(
            "<visual><geometry><mesh filename=\"{mesh}\" scale=\"0.1 0.1 -0.1\"/></geometry><material name=\"grey\"><color rgba=\"0.2 0.4 0.6 1\"/></material></visual>"
        )
    };
    let inertial = "<inertial><mass value=\"1\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
    let text = format!(
        "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\">{inertial}{}</link><joint name=\"joint\" type=\"continuous\">\
         <parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 1 0\"/></joint></robot>",
        meshes.iter().map(visual).collect::<String>()
    );
    let file = package.join("robot.urdf");
    fs::write(&file, text).expect("a folder for tests");
    file
}

fn run(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hamel"));
    command
        .args(arguments)
        .output()
        .expect("the program starts")
}

/// Corners and triangles of a mesh of a page.
fn triangles(mesh: &Value) -> (Vec<[f64; 3]>, Vec<[u16; 3]>) {
    let numbers = |key: &str| -> Vec<u16> {
        let bytes = STANDARD.decode(mesh[key].as_str().expect("a text"));
        let bytes = bytes.expect("base64");
        let (pairs, rest) = bytes.as_chunks();
        assert!(rest.is_empty() && mesh["width"] == 2);
        pairs.iter().map(|pair| u16::from_le_bytes(*pair)).collect()
    };
    let number = |key: &str, axis: usize| mesh[key][axis].as_f64().expect("a number");
    let (steps, places) = (numbers("corners"), numbers("triangles"));
    let corner = |steps: &[u16; 3]| {
        std::array::from_fn(|axis| {
            number("low", axis) + number("step", axis) * f64::from(steps[axis])
        })
    };
    (
        steps.as_chunks().0.iter().map(corner).collect(),
        places.as_chunks().0.to_vec(),
    )
}

#[test]
fn every_format_shows_the_same_solid() {
    let files = ["own.STL", "own.obj", "own.dae", "own.gltf"];
    let files = files.map(|own| format!("package://solids/meshes/{own}"));
    let robot = robot("solids", &files.each_ref().map(String::as_str));
    let robot = robot.to_str().expect("a path");
    let page = Page::read(&simulate(robot, "solids", &["--t-end", "0.1"]).html);
    let shapes = page.header["shapes"].as_array().expect("shapes");
    let colors = shapes.iter().map(|shape| shape["color"].clone());
    // STL says no colour: that of the link.
    let wanted = ["[51,102,153]", "[255,0,0]", "[0,255,0]", "[0,0,255]"];
    assert_eq!(
        colors.map(|own| own.to_string()).collect::<Vec<_>>(),
        wanted
    );
    for (index, (shape, file)) in shapes.iter().zip(&files).enumerate() {
        assert_eq!(
            (&shape["kind"], &shape["mesh"]),
            (&"mesh".into(), &index.into())
        );
        let (corners, faces) = triangles(&page.header["meshes"][index]);
        assert_eq!((corners.len(), faces.len()), (4, 4), "{file}");
        let corner = |place: u16| nalgebra::Vector3::from(corners[usize::from(place)]);
        // The scale mirrors z. Steps are 0.3 m / 65535.
        for [x, y, z] in CORNERS.map(|corner| corner.map(|own| 0.1 * f64::from(own))) {
            let wanted = nalgebra::Vector3::new(x, y, -z);
            let is_there = (0..4).any(|place| (corner(place) - wanted).amax() < 5e-6);
            assert!(is_there, "{file}: {wanted} is not among {corners:?}");
        }
        // Faces are seen from outside: the volume is positive.
        let volumes = faces
            .iter()
            .map(|[a, b, c]| corner(*a).cross(&corner(*b)).dot(&corner(*c)));
        let volume = volumes.sum::<f64>() / 6.0;
        assert!((volume - 1e-3).abs() < 1e-7, "{file}: {volume} m³");
    }
}

/// The low corners and colours of the parts of a COLLADA file with these nodes, in centimetres.
fn shown(name: &str, nodes: &str) -> Vec<([i64; 3], Value)> {
    let text = collada();
    let (head, rest) = text.split_once("<node id=\"n\">").expect("a node");
    let (_, tail) = rest.split_once("</node>").expect("its end");
    let text = format!("{head}{nodes}{tail}").replace(
        "<library_visual_scenes>",
        "<library_nodes><node id=\"far\"><translate>700 0 0</translate><instance_geometry url=\"#g\"/></node><node id=\"loop\"><instance_node url=\"#loop\"/></node></library_nodes><library_visual_scenes>",
    );
    let robot = robot(name, &["nodes.dae"]);
    fs::write(robot.with_file_name("nodes.dae"), text).expect("a file");
    let robot = robot.to_str().expect("a path");
    let page = Page::read(&simulate(robot, name, &["--t-end", "0.1"]).html);
    let shapes = page.header["shapes"].as_array().expect("shapes").iter();
    let parts = shapes.map(|shape| {
        let mesh = &page.header["meshes"][shape["mesh"].as_u64().expect("a number") as usize];
        let low = [0, 1, 2]
            .map(|axis| (mesh["low"][axis].as_f64().expect("a number") * 1e4).round() as i64);
        (low, shape["color"].clone())
    });
    parts.collect()
}

/// The solid is 3, 1 and 2 m long along x, y and z, in the scale 0.1, where z is turned over: in units of 0.1 mm.
#[test]
fn nodes_of_collada_place_what_they_show() {
    let instance = "<instance_geometry url=\"#g\"/>";
    let grey: Value = [51, 102, 153].as_slice().into();
    let cases = [
        (
            "moved",
            format!("<node><translate>100 0 0</translate>{instance}</node>"),
            vec![[1000, 0, -2000]],
        ),
        (
            "small",
            format!("<node><translate>0.9 0 0</translate>{instance}</node>"),
            vec![[9, 0, -2000]],
        ),
        (
            "nested",
            format!(
                "<node><translate>100 0 0</translate><node><scale>10 10 10</scale>{instance}</node></node>"
            ),
            vec![[1000, 0, -20000]],
        ),
        (
            "turned",
            format!(
                "<node><rotate>0 0 1 90</rotate><node><translate>1000 0 0</translate>{instance}</node></node>"
            ),
            vec![[-1000, 10000, -2000]],
        ),
        (
            "twice",
            format!(
                "<node><translate>100 0 0</translate>{instance}</node><node><translate>500 0 0</translate>{instance}</node>"
            ),
            vec![[1000, 0, -2000], [5000, 0, -2000]],
        ),
        (
            "library",
            "<node><instance_node url=\"#far\"/></node>".to_owned(),
            vec![[7000, 0, -2000]],
        ),
    ];
    for (name, nodes, wanted) in cases {
        let mut found = shown(name, &nodes);
        found.sort_by_key(|(low, _)| *low);
        let wanted: Vec<_> = wanted.into_iter().map(|low| (low, grey.clone())).collect();
        assert_eq!(found, wanted, "{name}");
    }
    assert_eq!(
        shown("circle", "<node><instance_node url=\"#loop\"/></node>"),
        []
    );
    assert_eq!(shown("none", ""), []);
}

/// A file may name others, and begin with what has no end.
#[cfg(target_os = "linux")]
#[test]
fn devices_are_no_files_of_meshes() {
    let robot = robot("devices", &["zero.gltf", "zero.obj", "cycle.gltf"]);
    let write =
        |name: &str, text: String| fs::write(robot.with_file_name(name), text).expect("a file");
    let (head, _) = gltf()
        .split_once("\"data:")
        .map(|(head, tail)| (head.to_owned(), tail.to_owned()))
        .expect("a buffer");
    write("zero.gltf", format!("{head}\"/dev/zero\"}}]}}"));
    write("zero.obj", obj().replace("paint.mtl", "/dev/zero"));
    write(
        "cycle.gltf",
        gltf().replace("{\"mesh\": 0}", "{\"mesh\": 0, \"children\": [0, 0]}"),
    );
    let html = robot.with_file_name("devices.html");
    let [robot, html] = [&robot, &html].map(|path| path.to_str().expect("a path"));
    let output = run(&[
        "simulate", robot, "--t-end", "0.1", "--force", "--html", html,
    ]);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    for wanted in [
        "`zero.gltf` (its buffer `/dev/zero`: it is not a file)",
        "`cycle.gltf` (it shows more than 10000 nodes)",
    ] {
        assert!(told.contains(wanted), "{told}");
    }
    // Without its materials.
    let shown = Page::read(Path::new(html));
    assert_eq!(shown.header["shapes"].as_array().map(Vec::len), Some(1));
}

#[test]
fn meshes_that_are_missing_are_told() {
    let files = [
        "meshes/none.stl",
        "meshes/torn.stl",
        "meshes/words.dae",
        "meshes/dangling.dae",
        "robot.urdf",
        "package://other/own.stl",
        "meshes/own.STL",
    ];
    let robot = robot("missing", &files);
    let html = robot.with_file_name("missing.html");
    let [robot, html] = [&robot, &html].map(|path| path.to_str().expect("a path"));
    let page = [
        "simulate", robot, "--t-end", "0.1", "--force", "--html", html,
    ];
    let output = run(&page);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let missing =
        "warning: files of meshes are not found: `meshes/none.stl`, `package://other/own.stl`";
    let unread = "warning: meshes cannot be read: `meshes/torn.stl` (";
    for wanted in [
        missing,
        unread,
        "`robot.urdf` (it is none of .stl, .obj, .dae, .gltf and .glb)",
    ] {
        assert!(told.contains(wanted), "{told}");
    }
    let shown = Page::read(Path::new(html));
    assert_eq!(shown.header["shapes"].as_array().map(Vec::len), Some(1));
    let quiet = run(&[&page[..], &["--quiet"]].concat());
    assert_eq!(String::from_utf8_lossy(&quiet.stderr), "");
    // Without a page they are not looked for.
    let told = run(&["simulate", robot, "--t-end", "0.1"]).stderr;
    assert!(!String::from_utf8_lossy(&told).contains("meshes"));
}

#[test]
fn an_imported_scene_finds_the_meshes_of_its_robot() {
    let robot = robot(
        "imported",
        &["package://imported/meshes/own.STL", "meshes/none.stl"],
    );
    let beside = robot.with_file_name("scene.toml");
    let elsewhere = robot.with_file_name("elsewhere/scene.toml");
    fs::create_dir_all(robot.with_file_name("elsewhere")).expect("a folder for tests");
    for (scene, wanted) in [
        (&beside, "\"meshes/own.STL\"".to_owned()),
        (
            &elsewhere,
            format!("{:?}", robot.with_file_name("meshes/own.STL")),
        ),
    ] {
        let [robot, file] = [&robot, scene].map(|path| path.to_str().expect("a path"));
        let output = run(&["import", robot, "-o", file, "--force"]);
        assert!(output.status.success());
        let text = fs::read_to_string(scene).expect("a scene");
        let mesh = format!("mesh = {{ file = {wanted}, scale = [0.1, 0.1, -0.1] }}");
        assert!(text.contains(&mesh), "{text}");
        assert!(text.contains("file = \"meshes/none.stl\""), "{text}");
        let page = Page::read(&simulate(file, "imported_meshes", &["--t-end", "0.1"]).html);
        assert_eq!(page.header["meshes"].as_array().map(Vec::len), Some(1));
    }
}

//! What `hamel simulate` refuses before anything moves, `hamel compile` refuses with the same words, for Rust and for C; and what neither refuses is written in
//! finite numbers.

mod common;

use common::hamel;
use std::path::{Path, PathBuf};

/// A body on a revolute joint about z.
fn arm(mass: &str) -> String {
    format!(
        "[[body]]\nname = \"arm\"\nparent = \"world\"\njoint = {{ type = \"revolute\", name = \"hinge\" }}\n{mass}\n"
    )
}

const REGULAR: &str = "mass = 1.0\ncom = [0.1, 0.0, 0.0]\ninertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]";

fn scene(name: &str, text: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("refused_alike");
    std::fs::create_dir_all(&folder).expect("a folder of the build");
    let path = folder.join(format!("{name}.toml"));
    let text = format!("hamel = 1\ngravity = [0.0, 0.0, -9.81]\n{text}");
    std::fs::write(&path, text).expect("a folder of the build");
    path
}

/// What is said of a scene by a simulation, by the compiler for Rust and for C, and whether it is refused.
fn told(path: &Path) -> [(bool, String, String); 3] {
    let scene = path.to_str().expect("text");
    let (rust, c) = (path.with_extension("rs"), path.with_extension("c"));
    let files = [&rust, &c].map(|file| file.to_str().expect("text"));
    let calls: [&[&str]; 3] = [
        &["simulate", scene, "--json", "--t-end", "0.01"],
        &["compile", scene, "-o", files[0]],
        &["compile", scene, "-o", files[1]],
    ];
    let written = [path.with_extension("json"), rust.clone(), c.clone()];
    std::array::from_fn(|i| {
        let _ = std::fs::remove_file(&written[i]);
        let output = hamel(calls[i]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        let text = std::fs::read_to_string(&written[i]).unwrap_or_default();
        assert!(!said.contains("panicked"), "{path:?}: {said}");
        (!output.status.success(), said, text)
    })
}

#[test]
fn compile_refuses_what_simulate_refuses_in_its_words() {
    let spring = |numbers: &str| {
        format!(
            "{}[[spring]]\nfrom = {{ body = \"arm\", point = [0.1, 0.0, 0.0] }}\nto = {{ body = \"world\", point = [1.0, 0.0, 0.0] }}\n{numbers}\n",
            arm(REGULAR)
        )
    };
    let none = "inertia = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]";
    for (name, text, words) in [
        (
            "massless",
            arm(&format!("mass = 0\n{none}")),
            "singular at joint `hinge`",
        ),
        (
            "point_on_axis",
            arm(&format!("mass = 1.0\ncom = [0.0, 0.0, 0.5]\n{none}")),
            "singular at joint `hinge`",
        ),
        // On an axis that the joint's frame does not have among its own: what is left of the moment is rounding.
        (
            "point_on_tilted_axis",
            arm(&format!(
                "mass = 1.0\ncom = [0.1, 0.2, 0.2]\n{none}\nbody_at = {{ rotation_vector = [-0.7, 0.3, 0.0] }}\nat = {{ rotation_vector = [0.1, 0.2, 0.3] }}"
            )),
            "",
        ),
        (
            "too_heavy",
            arm(&format!("mass = 1e300\ncom = [1e10, 0.0, 0.0]\n{none}")),
            "body `arm`: its inertia about its joint is beyond the range of numbers",
        ),
        ("too_stiff", spring("stiffness = 1e308\nlength = 1e10"), ""),
        (
            "too_fast",
            arm(&format!("{REGULAR}\ninitial = {{ speeds = [1e200] }}")),
            "",
        ),
        // Forces about the axis are finite, the square of the speed is not.
        (
            "too_much_energy",
            arm(&format!("{REGULAR}\ninitial = {{ speeds = [1e160] }}")),
            "at 0 s: the energy of body `arm` is beyond the range of numbers",
        ),
        (
            "driven_too_fast",
            arm(&format!("{REGULAR}\nmotion = {{ speeds = [1e160] }}")),
            "at 0 s: the energy of body `arm` is beyond the range of numbers",
        ),
    ] {
        let path = scene(name, &text);
        let [simulated, rust, c] = told(&path);
        assert!(simulated.0 || words.is_empty(), "{name}: simulated");
        assert!(simulated.1.contains(words), "{name}: {}", simulated.1);
        for (language, compiled) in [("Rust", rust), ("C", c)] {
            if simulated.0 {
                assert!(compiled.0, "{name}: compiled to {language}");
                assert_eq!(compiled.1, simulated.1, "{name}, {language}");
                assert!(compiled.2.is_empty(), "{name}: a file in {language}");
            }
            if !compiled.0 {
                let text = compiled.2;
                for odd in ["inf", "INFINITY", "NAN", "NaN"] {
                    let number =
                        |word: &str| word.trim_matches(|c: char| !c.is_alphanumeric()) == odd;
                    assert!(
                        !text.split_whitespace().any(number),
                        "{name}, {language}: {odd}"
                    );
                }
            }
        }
    }
}

/// A body without mass under one with mass, at the end of a chain: refused, and no other joint is named.
#[test]
fn the_joint_at_fault_is_named() {
    let text = format!(
        "{}[[body]]\nname = \"tip\"\nparent = \"arm\"\njoint = {{ type = \"prismatic\", name = \"slot\" }}\nmass = 0\ninertia = [[0, 0, 0], [0, 0, 0], [0, 0, 0]]\n",
        arm(REGULAR)
    );
    for (refused, said, _) in told(&scene("tip", &text)) {
        assert!(refused, "{said}");
        assert!(
            said.contains("`slot`") && !said.contains("`hinge`"),
            "{said}"
        );
    }
}

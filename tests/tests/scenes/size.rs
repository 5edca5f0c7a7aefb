//! Loading takes work in proportion to the file, a scene or a robot: to its bodies, frames, names and errors.
//!
//! `cargo test` compares five thousand and fifty thousand of each. A million, with times and memory:
//! `cargo test --release --package hamel-tests --test scenes size -- --ignored --nocapture --test-threads 1`.

use cpu_time::ThreadTime;
use hamel::registry::JointRegistry;
use hamel_scene::{Diagnostics, Scene, urdf};
use hamel_tests::fuzz::peak_memory;
use std::fmt::Write;
use std::time::Duration;

/// How many times longer ten times as many elements may take. Work in proportion takes ten times as long, and up to 1.6 times that, as measured,
/// where the larger file leaves the caches that the smaller one fits in; work in squares takes a hundred.
const LARGEST_RATIO: f64 = 25.0;

/// A family of files, one for each number of elements.
struct Family {
    name: &'static str,
    text: fn(usize) -> String,
    /// How many errors a file of so many elements has.
    errors: fn(usize) -> usize,
    read: fn(&str, &JointRegistry) -> Result<(), Diagnostics>,
}

const FAMILIES: [Family; 21] = [
    accepted("bodies in a chain", |n| scene(n, |i| format!("b{i}"), "")),
    accepted("bodies on the world", |n| {
        repeated(HEAD, n, |i| body(&format!("b{i}"), "world", ""))
    }),
    accepted("bodies before their parents", |n| {
        let parent = |i: usize| {
            if i + 1 < n {
                format!("b{}", i + 1)
            } else {
                "world".into()
            }
        };
        repeated(HEAD, n, |i| body(&format!("b{i}"), &parent(i), ""))
    }),
    accepted("frames", |n| {
        on_one_body(n, |i| {
            format!("[[frame]]\nname = \"f{i}\"\nbody = \"b0\"\n")
        })
    }),
    accepted("springs", |n| {
        let ends = "from = { body = \"b0\" }\nto = { body = \"world\" }";
        on_one_body(n, |_| format!("[[spring]]\n{ends}\nstiffness = 1.0\n"))
    }),
    accepted("shapes", |n| {
        on_one_body(n, |_| "[[shape]]\nbody = \"b0\"\nsphere = 0.1\n".into())
    }),
    accepted("driven joints, and events of them", |n| {
        let events = (0..n)
            .map(|i| format!("[[event]]\nname = \"e{i}\"\njoint = \"b{i}\"\nspeed = \"q\"\n"));
        let events: String = events.collect();
        scene(n, |i| format!("b{i}"), "motion.speeds = [0.0]\n") + &events
    }),
    refused(
        "frames of one name",
        |n| n - 1,
        |n| on_one_body(n, |_| "[[frame]]\nname = \"f\"\nbody = \"b0\"\n".into()),
    ),
    refused(
        "bodies of one name",
        |n| n - 1,
        |n| repeated(HEAD, n, |_| body("b0", "world", "")),
    ),
    refused(
        "unknown parents",
        |n| n,
        |n| repeated(HEAD, n, |i| body(&format!("b{i}"), &format!("c{i}"), "")),
    ),
    refused(
        "bodies in cycles",
        |n| n / 2,
        |n| {
            repeated(HEAD, n / 2 * 2, |i| {
                body(&format!("b{i}"), &format!("b{}", i ^ 1), "")
            })
        },
    ),
    refused(
        "unknown joints",
        |n| n,
        |n| {
            let event =
                |i: usize| format!("[[event]]\nname = \"e{i}\"\njoint = \"j{i}\"\nspeed = \"q\"\n");
            on_one_body(n, event)
        },
    ),
    refused(
        "unknown keys",
        |n| n,
        |n| repeated(HEAD, n, |i| format!("k{i} = 1\n")) + &body("b0", "world", ""),
    ),
    refused(
        "lines that are no TOML",
        |n| n,
        |n| repeated(HEAD, n, |_| "= 1\n".into()),
    ),
    refused(
        "numbers of a long name",
        |_| 1,
        |n| {
            let numbers = "0.0, ".repeat(n);
            let initial = format!("initial.configuration = [{numbers}]\n");
            scene(1, |_| "b".repeat(n), &initial)
        },
    ),
    refused(
        "rows of a matrix",
        |_| 1,
        |n| {
            let rows = "[], ".repeat(n);
            scene(
                1,
                |i| format!("b{i}"),
                &format!("spring.stiffness = [{rows}]\n"),
            )
        },
    ),
    robot(
        "links and joints",
        |_| 0,
        |n| robot_of(n, |_| String::new()),
    ),
    // Each follows the last joint, which follows itself, and has the last colour.
    robot(
        "joints that follow others, and materials",
        |_| 1,
        |n| {
            let material =
                |i: usize| format!("<material name=\"m{i}\"><color rgba=\"1 0 0 1\"/></material>");
            let materials: String = (0..n).map(material).collect();
            robot_of(n, |_| format!("<mimic joint=\"j{}\"/>", n - 1))
                .replace(
                    "<geometry>",
                    &format!("<material name=\"m{}\"/><geometry>", n - 1),
                )
                .replace("</robot>", &(materials + "</robot>"))
        },
    ),
    // Every other one follows the one before it.
    robot(
        "couplings of two",
        |_| 0,
        |n| {
            robot_of(n, |i| match i % 2 {
                0 => String::new(),
                _ => format!("<mimic joint=\"j{}\"/>", i - 1),
            })
        },
    ),
    robot(
        "links without names",
        |n| n,
        |n| {
            let links = "<link/>".repeat(n);
            format!("<robot name=\"r\">{links}</robot>")
        },
    ),
    robot(
        "unknown links",
        |n| n,
        |n| robot_of(n, |_| String::new()).replace("<parent link=\"", "<parent link=\"x"),
    ),
];

const HEAD: &str = "hamel = 1\ngravity = [0.0, 0.0, -9.81]\n";

const fn accepted(name: &'static str, text: fn(usize) -> String) -> Family {
    refused(name, |_| 0, text)
}

const fn refused(
    name: &'static str,
    errors: fn(usize) -> usize,
    text: fn(usize) -> String,
) -> Family {
    let read =
        |text: &str, registry: &JointRegistry| Scene::parse(text, "large.toml", registry).map(drop);
    Family {
        name,
        text,
        errors,
        read,
    }
}

/// Read, and written as a scene.
const fn robot(
    name: &'static str,
    errors: fn(usize) -> usize,
    text: fn(usize) -> String,
) -> Family {
    let read = |text: &str, _: &JointRegistry| {
        let import = urdf::read(text, "large.urdf", &urdf::Options::default());
        import.map(|import| drop(import.to_toml()))
    };
    Family {
        name,
        text,
        errors,
        read,
    }
}

/// A robot of `count` joints on one link, with `more` in each.
fn robot_of(count: usize, more: impl Fn(usize) -> String) -> String {
    let link = |name: &str| {
        let inertia = "ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"";
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"1\"/><inertia {inertia}/></inertial>\
             <visual><geometry><sphere radius=\"1\"/></geometry></visual></link>"
        )
    };
    let element = |i: usize| {
        let (name, more) = (format!("l{i}"), more(i));
        let ends = format!("<parent link=\"base\"/><child link=\"{name}\"/>");
        link(&name) + &format!("<joint name=\"j{i}\" type=\"continuous\">{ends}{more}</joint>")
    };
    repeated("<robot name=\"r\">", count, element) + &link("base") + "</robot>"
}

fn repeated(head: &str, count: usize, element: impl Fn(usize) -> String) -> String {
    let mut text = String::from(head);
    (0..count).for_each(|i| text.push_str(&element(i)));
    text
}

fn body(name: &str, parent: &str, more: &str) -> String {
    let mut text = String::from("[[body]]\n");
    let inertia = "[1.0, 1.0, 1.0, 0.0, 0.0, 0.0]";
    let written = write!(
        text,
        "name = \"{name}\"\nparent = \"{parent}\"\nmass = 1.0\ninertia_xx_yy_zz_xy_xz_yz = {inertia}\n\
         joint.type = \"revolute\"\n{more}"
    );
    written.expect("a string grows");
    text
}

/// A chain of bodies, with `more` in each.
fn scene(count: usize, name: impl Fn(usize) -> String, more: &str) -> String {
    let parent = |i: usize| i.checked_sub(1).map_or_else(|| "world".into(), &name);
    repeated(HEAD, count, |i| body(&name(i), &parent(i), more))
}

fn on_one_body(count: usize, element: impl Fn(usize) -> String) -> String {
    repeated(&scene(1, |i| format!("b{i}"), ""), count, element)
}

/// The processor time that this thread takes for the file of `count` elements, its errors shown.
fn time(family: &Family, count: usize, registry: &JointRegistry) -> Duration {
    let text = (family.text)(count);
    let start = ThreadTime::now();
    let loaded = (family.read)(&text, registry);
    let (found, shown) = match &loaded {
        Ok(()) => (0, String::new()),
        Err(errors) => (errors.errors().len(), errors.render(false)),
    };
    let time = start.elapsed();
    assert_eq!(found, (family.errors)(count), "{}: {shown}", family.name);
    time
}

fn compare(counts: [usize; 2]) {
    let registry = hamel_joints::registry();
    for family in &FAMILIES {
        let [small, large] = counts.map(|count| time(family, count, &registry));
        let small = small.max(time(family, counts[0], &registry));
        let ratio = large.as_secs_f64() / small.as_secs_f64();
        println!("{}: {small:?}, {large:?}, {ratio:.1} times", family.name);
        assert!(
            ratio < LARGEST_RATIO,
            "{}: {small:?} and {large:?}",
            family.name
        );
    }
}

#[test]
fn ten_times_as_many_elements_take_ten_times_as_long() {
    compare([2_000, 20_000]);
}

#[test]
#[ignore = "minutes, and 8 GB of memory"]
fn a_million_of_each() {
    let registry = hamel_joints::registry();
    for family in &FAMILIES {
        let time = time(family, 1_000_000, &registry);
        let memory = peak_memory().map_or("unknown".into(), |bytes| format!("{} MiB", bytes >> 20));
        println!("{}: {time:?}, peak memory so far {memory}", family.name);
    }
}

/// The message of the one mistake of a chain of `count` bodies with `more` below.
fn refusal(count: usize, more: &str) -> String {
    let text = scene(count, |i| format!("b{i}"), "") + more;
    let errors = Scene::parse(&text, "large.toml", &hamel_joints::registry());
    let errors = errors.expect_err("it is too large");
    assert_eq!(errors.errors().len(), 1, "{errors}");
    errors.errors()[0].message().to_owned()
}

/// Matrices of the square of a million would take terabytes.
#[test]
fn what_takes_dense_matrices_has_a_limit() {
    let constraint = "[[constraint]]\nname = \"c\"\nbody = \"b1\"\ndirection = [1.0, 0.0, 0.0]\n";
    let message = refusal(5001, constraint);
    assert!(
        message.contains("5001 speeds") && message.contains("at most 5000"),
        "{message}"
    );
    let weights = "weights = { position = 1.0, speed = 1.0, effort = 1.0 }";
    let message = refusal(501, &format!("[controller]\nkind = \"lqr\"\n{weights}\n"));
    assert!(
        message.contains("more than 500 degrees of freedom"),
        "{message}"
    );
}

//! Pages and drawings of every joint of the library and of specs that strain them: well-formed, complete in themselves, the
//! same each time.

use hamel_codegen::derive;
use hamel_codegen::derived::{Derived, KernelKind, Method, Shape};
use hamel_codegen::emit::{Accuracy, drawing_file, html_page, overview, page};
use roxmltree::{Document, ParsingOptions};
use std::path::Path;
use std::sync::LazyLock;

/// Parameters in roots and quotients, names with indices, a speed basis that depends on Q, a double cover.
const STRAINING: [&str; 5] = [
    "hamel = 1;
/// Text with <angle> brackets, an `a < b` in code & an ampersand.
joint offset_universal(r_outer: 1, lead: m/rad) {
    config alpha: R1, beta_2: R1;
    H = rot_x(alpha) * trans_z(lead * alpha / sqrt(1 + r_outer * r_outer)) * rot_y(beta_2);
}",
    "hamel = 1;
joint skate {
    config theta: R1, x: R1, y: R1;
    H = pose(rot_z(theta), [x, y, 0]);
    S_bar = [1, 0; 0, cos(theta); 0, sin(theta)];
    speeds turn, forward;
}",
    "hamel = 1;
joint quaternion_ball {
    config q: S3;
    basis e1, e2, e3 of so3;
    velocity in child;
    H = rot(q);
}",
    "hamel = 1;
joint floating_ball {
    config R: SO3, p: R3;
    basis wx, wy, wz of so3;
    velocity in child;
    Phi = R * exp(phi.R), p + phi.p;
    H = pose(R, p);
}",
    "hamel = 1;
joint bounded(outer: m > 0, inner: m in 0.1..0.5) {
    config q: R1, s: R1;
    require outer > 4 * inner;
    /// The guide ends here,
    /// and with it *everything* | all.
    except cos(q) = 0;
    home = 1 / 2, 0;
    H = rot_z(q) * trans_x(outer * s / inner);
}",
];

fn library() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../joint-specs");
    let entries = std::fs::read_dir(folder).expect("the joint library");
    let paths = entries.map(|entry| entry.expect("a readable folder").path());
    let specs = paths.filter(|path| path.extension().is_some_and(|e| e == "joint"));
    specs
        .map(|path| std::fs::read_to_string(path).expect("a spec"))
        .collect()
}

/// The joint of a spec, read as from a file of its name.
fn derived(source: &str) -> Derived {
    let declared = source.split("\njoint ").nth(1).unwrap_or_default();
    let name = declared.split([' ', '(']).next().unwrap_or_default();
    derive(source, &format!("{name}.joint")).unwrap_or_else(|errors| panic!("{errors}"))
}

/// All that is written of a joint.
struct Written {
    name: String,
    shape: Shape,
    html: String,
    markdown: String,
    drawing: String,
}

impl Written {
    fn new(joint: &Derived) -> Self {
        let none = Accuracy::default();
        Self {
            name: joint.spec.name.value.clone(),
            shape: joint.shape,
            html: html(joint),
            markdown: page(joint, "test.joint", &none).expect("the template holds"),
            drawing: drawing_file(joint, "test.joint").expect("a pose at home"),
        }
    }
}

/// What is written of the joints of the library and of those above, made once.
fn all() -> &'static [Written] {
    static ALL: LazyLock<Vec<Written>> = LazyLock::new(|| {
        let sources = library().into_iter().chain(STRAINING.map(str::to_owned));
        sources
            .map(|source| Written::new(&derived(&source)))
            .collect()
    });
    &ALL
}

fn html(joint: &Derived) -> String {
    html_page(joint, &Accuracy::default()).expect("the template holds")
}

fn parsed<'a>(text: &'a str, of: &str) -> Document<'a> {
    let options = ParsingOptions {
        allow_dtd: true,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).unwrap_or_else(|error| panic!("{of}: {error}"))
}

#[test]
fn every_html_page_is_one_well_formed_file() {
    for joint in all() {
        let document = parsed(&joint.html, &joint.name);
        let count = |tag: &str| {
            document
                .descendants()
                .filter(|n| n.has_tag_name(tag))
                .count()
        };
        assert!(
            count("math") >= 9,
            "{}: {} formulas",
            joint.name,
            count("math")
        );
        for tag in ["script", "link", "img", "iframe"] {
            assert_eq!(count(tag), 0, "{}: <{tag}>", joint.name);
        }
        let outside = document.descendants().flat_map(|node| node.attributes());
        let mut outside = outside.filter(|a| matches!(a.name(), "href" | "src"));
        assert!(
            outside.all(|a| a.value().starts_with('#')),
            "{}",
            joint.name
        );
    }
}

#[test]
fn formulas_are_mathml_core() {
    let core = [
        "math", "mrow", "mi", "mn", "mo", "mspace", "mover", "msub", "msup", "msubsup", "mfrac",
        "msqrt", "mtable", "mtr", "mtd",
    ];
    for joint in all() {
        let document = parsed(&joint.html, &joint.name);
        for math in document.descendants().filter(|n| n.has_tag_name("math")) {
            for node in math.descendants().filter(|n| n.is_element()) {
                let tag = node.tag_name().name();
                assert!(core.contains(&tag), "{}: <{tag}>", joint.name);
                let children = node.children().filter(|n| n.is_element()).count();
                let expected = match tag {
                    "mover" | "msub" | "msup" | "mfrac" => Some(2),
                    "msubsup" => Some(3),
                    _ => None,
                };
                assert!(
                    expected.is_none_or(|n| n == children),
                    "{}: <{tag}>",
                    joint.name
                );
            }
        }
    }
}

#[test]
fn every_drawing_lies_inside_its_picture() {
    for joint in all() {
        let text = &joint.drawing;
        assert!(
            text.starts_with("<!-- @generated by hamel-codegen"),
            "{text}"
        );
        let document = parsed(text, &joint.name);
        let points = document
            .descendants()
            .filter_map(|node| node.attribute("points"));
        let numbers: Vec<f64> = points
            .flat_map(|points| points.split([' ', ',']))
            .map(|number| number.parse().expect("a number"))
            .collect();
        assert!(numbers.len() > 100, "{}", joint.name);
        // A panel is 240 by 200 and a caption; heads of arrows reach into its margin.
        assert!(
            numbers.iter().all(|number| (0.0..=240.0).contains(number)),
            "{}",
            joint.name
        );
    }
}

#[test]
fn a_drawing_has_a_panel_for_each_velocity_and_marks_the_forbidden() {
    for joint in all() {
        let text = &joint.drawing;
        let panels = text.matches("<g transform").count();
        assert_eq!(panels, joint.shape.freedoms, "{}", joint.name);
        let forbidden = text.matches("forbidden</text>").count();
        let by_combination = text.matches("forbidden by constraint").count();
        assert_eq!(
            forbidden + by_combination,
            joint.shape.constraints,
            "{}",
            joint.name
        );
    }
}

#[test]
fn latex_is_balanced_ascii() {
    for joint in all() {
        let text = &joint.markdown;
        let blocks: Vec<&str> = text.split("```math\n").skip(1).collect();
        assert!(blocks.len() >= 9, "{}", joint.name);
        for block in blocks {
            let latex = block.split("\n```").next().unwrap_or_default();
            assert!(latex.is_ascii(), "{latex}");
            let count = |part: &str| latex.matches(part).count();
            assert_eq!(count("{"), count("}"), "{latex}");
            assert_eq!(count(r"\begin"), count(r"\end"), "{latex}");
            assert_eq!(count(r"\left("), count(r"\right)"), "{latex}");
        }
    }
}

#[test]
fn pages_are_the_same_each_time() {
    let known = all().len() - STRAINING.len();
    for (first, source) in all().iter().skip(known).zip(STRAINING) {
        let second = Written::new(&derived(source));
        assert_eq!(first.html, second.html);
        assert_eq!(first.markdown, second.markdown);
        assert_eq!(first.drawing, second.drawing);
    }
}

#[test]
fn measured_errors_are_shown_where_there_are_some() {
    let joint = derived(STRAINING[1]);
    let table =
        "joint,kernel,type,worst ulp,points\nskate,retract,f64,2.345,100000\nother,pose,f32,9,1\n";
    let accuracy = Accuracy::parse(table).expect("a table");
    let with = html_page(&joint, &accuracy).expect("the template holds");
    assert!(
        with.contains("Measured errors") && with.contains("2.35"),
        "{with}"
    );
    assert!(!html(&joint).contains("Measured errors"));
    let joints = [joint];
    let summary =
        |accuracy| overview(&joints, "specs", "pages", accuracy).expect("the template holds");
    assert!(
        summary(&accuracy).contains("| `skate` | 2.35 (`retract`) |"),
        "{}",
        summary(&accuracy)
    );
    assert!(!summary(&Accuracy::default()).contains("Measured errors"));
}

#[test]
fn text_of_a_spec_is_never_markup() {
    let joint = derived(STRAINING[0]);
    let text = html(&joint);
    assert!(
        text.contains(
            "Text with &lt;angle&gt; brackets, an <code>a &lt; b</code> in code &amp; an ampersand."
        ),
        "{text}"
    );
}

#[test]
fn the_ends_of_a_joint_and_their_causes_are_shown() {
    let joint = derived(STRAINING[4]);
    let text = page(&joint, "test.joint", &Accuracy::default()).expect("the template holds");
    for part in [
        r"- $`\mathrm{cos}\,q`$: The guide ends here, and with it \*everything\* \| all.",
        "| `outer` | m | outer > 0 |",
        r"| `inner` | m | 1/10 ≤ inner \< 1/2 |",
        "Required: outer > 4 \\* inner.",
        "- Home: (½, 0).",
    ] {
        assert!(text.contains(part), "no `{part}` in {text}");
    }
    // No page says that a joint with ends has none.
    assert!(!text.contains("at every configuration"), "{text}");
}

#[test]
fn long_formulas_are_in_the_names_of_the_spec() {
    let disk = all().iter().find(|joint| joint.name == "falling_disk");
    let text = &disk.expect("a joint of the library").html;
    assert!(
        text.contains("Names of the spec, and their derivatives"),
        "{text}"
    );
    assert!(text.contains(">lean<"), "{text}");
    for joint in all() {
        let size = joint.html.len();
        assert!(size < 250_000, "{}: {size} bytes", joint.name);
    }
}

/// Maps that the runtime finds have kernels without formulas.
#[test]
fn kernels_without_formulas_have_their_place() {
    let mut joint = derived(STRAINING[4]);
    for kernel in &mut joint.kernels {
        match kernel.kind {
            KernelKind::Local => (kernel.method, kernel.outputs) = (Method::Newton, vec![]),
            KernelKind::RetractDifferentialInverse | KernelKind::VelocityMapInverse => {
                (kernel.method, kernel.outputs) = (Method::Solve, vec![]);
            }
            _ => {}
        }
    }
    let text = html(&joint);
    parsed(&text, "bounded");
    for part in [
        "Newton's method in the runtime",
        "K×K solve in the runtime",
        "a K×K solve",
    ] {
        let escaped = part.replace('\'', "&#39;");
        assert!(
            text.contains(part) || text.contains(&escaped),
            "no {part} in {text}"
        );
    }
}

/// Writes the pages into the folder named by `HAMEL_PAGES`, to be looked at.
#[test]
#[ignore = "writes files for a reader"]
fn write_pages() {
    let folder = std::env::var_os("HAMEL_PAGES").expect("HAMEL_PAGES names a folder");
    for joint in all() {
        let path = Path::new(&folder).join(format!("{}.html", joint.name));
        std::fs::write(path, &joint.html).expect("the folder takes files");
    }
}

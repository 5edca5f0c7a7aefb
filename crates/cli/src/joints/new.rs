//! `hamel joints new`.

use hamel_console::files::new_file;
use hamel_console::output::{self, Failure};
use hamel_console::terminal;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Where specs of this repository are, which `cargo build` reads.
const LIBRARY: &str = "joint-specs";

/// Write a spec to start from.
///
/// The file is a complete joint (a pin in a slot, or with `--bodies` wheels that mesh): change it, then run `hamel joints check FILE`. A file that is
/// there already stays as it is.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Name of the joint, in snake_case
    #[arg(value_name = "NAME")]
    name: String,

    /// Folder of the new file [default: joint-specs where the current folder has it, else the current folder]
    #[arg(long, value_name = "FOLDER")]
    folder: Option<PathBuf>,

    /// Names of the bodies of a joint that carries several, such as crank,coupler,rocker
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    bodies: Vec<String>,
}

/// Writes the file; one that exists is never touched.
pub fn run(args: &Args) -> Result<(), Failure> {
    check_bodies(&args.bodies)?;
    let text = match args.bodies.as_slice() {
        [] => template(&args.name),
        bodies => template_of_several(&args.name, bodies),
    };
    let file = format!("{}.joint", args.name);
    hamel_codegen::spec::parse(&text, &file).map_err(|errors| Failure::Spec(Box::new(errors)))?;
    let library = Path::new(LIBRARY);
    let path = match &args.folder {
        Some(folder) => folder.join(&file),
        None if library.is_dir() => library.join(&file),
        None => PathBuf::from(&file),
    };
    let written = new_file(&path).and_then(|file| file.write(text));
    written.map_err(explained)?;
    warn_of_namesake(&args.name);
    let next = match path.parent() == Some(library) {
        true => "`cargo build`, `cargo test`\nthe language: joint-specs/README.md",
        false => {
            "a crate that builds it (docs/library.md, \"Joints of your own\")\nthe language: joint-specs/README.md of the repository"
        }
    };
    let shown = path.display();
    let place = std::path::absolute(&path).unwrap_or_else(|_| path.clone());
    output::print(&format!(
        "wrote {}\nnext: change it to your joint, `hamel joints check {shown}`, {next}\n",
        place.display()
    ))
}

/// The template would name such a body twice, and declare its pose twice.
fn check_bodies(bodies: &[String]) -> Result<(), Failure> {
    let mut places = bodies.iter().enumerate();
    match places.find(|(place, body)| bodies[..*place].contains(body)) {
        Some((_, body)) => Err(Failure::Options(format!(
            "--bodies names `{body}` twice: each body has a name of its own"
        ))),
        None => Ok(()),
    }
}

/// Says what to do where there is such a file.
fn explained(failure: Failure) -> Failure {
    match failure {
        Failure::Write { target, error } if error.kind() == ErrorKind::AlreadyExists => {
            let advice = "it exists, and is never overwritten: change it, or give the new joint another name";
            Failure::Write {
                target,
                error: io::Error::new(ErrorKind::AlreadyExists, advice),
            }
        }
        other => other,
    }
}

/// A registry takes one joint of a name, and `joints explain NAME` shows that of the library.
fn warn_of_namesake(name: &str) {
    if hamel_joints::specs().any(|(known, _)| known == name) {
        terminal::err(&format!(
            "warning: the library has a joint `{name}` already: scenes cannot use both; give yours another name"
        ));
    }
}

fn template(name: &str) -> String {
    format!(
        "hamel = 1;

/// One sentence that says what moves. Frames and units of Q and v.
joint {name} {{
    config  theta: R1, x: R1;           // rad, m: the stored scalars of Q
    // A group instead: config Q: SO3; basis e1, e2, e3 of so3; velocity in child;
    H     = trans_x(x) * rot_z(theta);  // child coordinates to parent coordinates
    // Several bodies: hamel joints new NAME --bodies slot,pin
    // Declared where they differ from what is derived: Phi, X. Nonholonomic: A, S_bar.
}}
"
    )
}

/// Wheels that mesh, each with the one before.
fn template_of_several(name: &str, bodies: &[String]) -> String {
    let width = bodies.iter().map(|body| body.chars().count()).max();
    let width = width.unwrap_or(0);
    let poses: String = bodies
        .iter()
        .enumerate()
        .map(|(place, body)| {
            let sign = if place % 2 == 0 { "" } else { "-" };
            format!("    H.{body:width$} = trans_x({place} * distance) * rot_z({sign}theta);\n")
        })
        .collect();
    let names = bodies.join(", ");
    format!(
        "hamel = 1;

/// One sentence that says what moves. Frames and units of Q and v.
joint {name}(
    /// Distance of two axes.
    distance: m > 0,
) {{
    config  theta: R1;                  // rad: the stored scalars of Q
    bodies  {names};
{poses}    // A loop has a coordinate for each link, and relations that close it: `config a: S1, b: S1, s: R1;`,
    // `relation crank * a.c + rod * b.c = s;`, `basis turn of so2(a);` names what is independent.
    // docs/loops.md makes one.
}}
"
    )
}

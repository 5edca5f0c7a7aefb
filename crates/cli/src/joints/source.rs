//! Finding the spec that a user means: a joint of the library, or a file.

use hamel_codegen::derived::Derived;
use hamel_console::output::Failure;
use std::path::Path;

/// Whether this is the path of a spec, not the name of a joint of the library.
pub fn is_file(name: &str) -> bool {
    name.contains(['/', '\\']) || name.ends_with(".joint")
}

/// The spec of `name`: its file name as errors show it, and its text.
pub fn find(name: &str) -> Result<(String, String), Failure> {
    if is_file(name) {
        return read(Path::new(name));
    }
    match hamel_joints::specs().find(|(known, _)| *known == name) {
        Some((known, text)) => Ok((format!("{known}.joint"), text.to_owned())),
        None => Err(unknown(name)),
    }
}

fn read(path: &Path) -> Result<(String, String), Failure> {
    let file = path.display().to_string();
    match hamel_codegen::source::read(path) {
        Ok(text) => Ok((file, text)),
        Err(error) => Err(Failure::Options(format!("cannot read {file}: {error}"))),
    }
}

fn unknown(name: &str) -> Failure {
    let names: Vec<&str> = hamel_joints::specs().map(|(known, _)| known).collect();
    let nearest = names
        .iter()
        .max_by(|a, b| strsim::jaro(a, name).total_cmp(&strsim::jaro(b, name)));
    let advice = match nearest.filter(|known| strsim::jaro(known, name) > 0.7) {
        Some(known) => format!("did you mean `{known}`?"),
        None => format!("the library has {}", names.join(", ")),
    };
    Failure::Options(format!(
        "no joint is called `{name}`: {advice} A spec of your own is given by its path, `{name}.joint`"
    ))
}

/// Names of all joints of the library.
pub fn library() -> Vec<String> {
    hamel_joints::specs()
        .map(|(name, _)| name.to_owned())
        .collect()
}

/// Parses, expands and proves the spec of `name`.
pub fn derive(name: &str) -> Result<Derived, Failure> {
    let (file, text) = find(name)?;
    let folder = is_file(name).then(|| Path::new(name).parent()).flatten();
    hamel_codegen::derive_in(&text, &file, folder).map_err(|errors| Failure::Spec(Box::new(errors)))
}

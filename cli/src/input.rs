//! What commands read: a scene file, or a robot in URDF.

use crate::output::Failure;
use hamel::registry::JointRegistry;
use hamel_scene::{Scene, urdf};
use std::path::Path;

/// The scene, or the robot in URDF, as the file's ending says.
///
/// # Errors
/// Mistakes in the file; `floating_base` for what is no robot.
pub fn scene(path: &Path, floating_base: bool, registry: &JointRegistry) -> Result<Scene, Failure> {
    let ending = path.extension().unwrap_or_default();
    if ending.eq_ignore_ascii_case("urdf") {
        let options = urdf::Options {
            floating_base,
            ..urdf::Options::default()
        };
        return Ok(urdf::load(path, &options)?.build(registry)?);
    }
    if floating_base {
        return Err(Failure::Options(format!(
            "--floating-base is for robots in URDF, and {} is none: a scene says itself how its bodies move",
            path.display()
        )));
    }
    Ok(Scene::load(path, registry)?)
}

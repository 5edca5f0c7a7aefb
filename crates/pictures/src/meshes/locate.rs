//! Where the file of a mesh is.

use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// The file that a scene or robot in `folder` calls `file`: a path from there; `file://…`; or `package://NAME/…`, where the package is a folder of that name among those above,
/// or in one of them, or in a folder of `ROS_PACKAGE_PATH`, or in `share` of one of `AMENT_PREFIX_PATH`. `None` where there is none.
pub fn locate(folder: &Path, file: &str) -> Option<PathBuf> {
    // A path without a folder has an empty one.
    let folder = std::path::absolute(Path::new(".").join(folder)).ok()?;
    let is_file = |path: &PathBuf| path.is_file();
    let package = ["package://", "model://"]
        .iter()
        .find_map(|scheme| file.strip_prefix(scheme));
    if let Some(inside) = package {
        let (name, rest) = inside.split_once('/')?;
        return packages(&folder, name)
            .into_iter()
            .map(|package| package.join(rest))
            .find(is_file);
    }
    let plain = file.strip_prefix("file://").unwrap_or(file);
    Some(folder.join(plain)).filter(is_file)
}

/// Folders that may be the package of that name, the nearest first.
fn packages(folder: &Path, name: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for above in folder.ancestors() {
        if above.file_name() == Some(OsStr::new(name)) {
            found.push(above.to_owned());
        }
        found.push(above.join(name));
    }
    let listed = |variable: &str| {
        let paths = env::var_os(variable).unwrap_or_default();
        env::split_paths(&paths).collect::<Vec<_>>()
    };
    for path in listed("ROS_PACKAGE_PATH") {
        if path.file_name() == Some(OsStr::new(name)) {
            found.push(path.clone());
        }
        found.push(path.join(name));
    }
    let shared = listed("AMENT_PREFIX_PATH").into_iter();
    found.extend(shared.map(|path| path.join("share").join(name)));
    found
}

#[cfg(test)]
mod tests {
    use super::locate;
    use std::fs;
    use std::path::Path;

    #[test]
    fn files_are_found_from_the_folder_and_in_packages() {
        let folder = tempfile::tempdir().expect("a folder");
        let package = folder.path().join("arm_description");
        for own in ["urdf", "meshes"] {
            fs::create_dir_all(package.join(own)).expect("a folder");
        }
        let mesh = package.join("meshes/link.stl");
        fs::write(&mesh, "").expect("a file");
        let found = |file: &str| locate(&package.join("urdf"), file);
        for file in [
            "package://arm_description/meshes/link.stl",
            "model://arm_description/meshes/link.stl",
            &format!("file://{}", mesh.display()),
            &mesh.display().to_string(),
        ] {
            assert_eq!(found(file).as_deref(), Some(&*mesh), "{file}");
        }
        let relative = found("../meshes/link.stl").expect("it is there");
        assert_eq!(relative.canonicalize().ok(), mesh.canonicalize().ok());
        // Tests run in the folder of their package.
        assert!(locate(Path::new(""), "Cargo.toml").is_some_and(|path| path.is_absolute()));
        for file in [
            "package://arm_description",
            "package://other/link.stl",
            "link.stl",
            ".",
            "",
        ] {
            assert_eq!(found(file), None, "{file}");
        }
    }
}

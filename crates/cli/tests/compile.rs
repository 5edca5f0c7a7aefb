//! `hamel compile` as a user runs it: the files that it writes, and what it refuses.

mod common;

use common::{hamel, stdout};
use std::path::{Path, PathBuf};

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder of the build");
    folder
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_module_in_c_is_a_source_and_a_header_under_the_name_of_the_file() {
    let source = folder("compile_c").join("my board.c");
    let shown = source.to_str().expect("text");
    let told = stdout(&["compile", "scenes/snakeboard.toml", "-o", shown]);
    assert_eq!(told, "");
    let (text, header) = (read(&source), read(&source.with_extension("h")));
    assert!(text.contains("#include \"my board.h\"\n"), "{text}");
    for function in ["forward_dynamics", "momentum_rates", "poses"] {
        let name = format!("void my_board_{function}(");
        assert!(text.contains(&name) && header.contains(&name), "{function}");
    }
    let sizes = [
        ("BODIES", 4),
        ("CONFIGURATION", 9),
        ("FREEDOMS", 6),
        ("SPEEDS", 6),
    ];
    for (size, value) in sizes {
        let defined = format!("#define MY_BOARD_{size} {value}\n");
        assert!(header.contains(&defined), "{header}");
    }
    assert!(header.contains("body `front`"), "{header}");
}

/// Functions are asked for by the names that they have in modules, or with hyphens as all options have.
#[test]
fn functions_are_called_as_in_modules_or_with_hyphens() {
    let written = |name: &str| {
        stdout(&[
            "compile",
            "scenes/double_ball_pendulum.toml",
            "--function",
            name,
        ])
    };
    let names = [
        "forward_dynamics",
        "inverse_dynamics",
        "mass_matrix",
        "bias_forces",
        "momentum_rates",
        "speeds_from_momenta",
        "forward_dynamics_derivatives",
        "inverse_dynamics_derivatives",
        "inverse_mass_matrix",
        "forward_dynamics_second_derivatives",
        "inverse_dynamics_second_derivatives",
    ];
    for name in names {
        let module = written(name);
        assert!(module.contains(&format!("pub fn {name}<")), "{module}");
        assert_eq!(written(&name.replace('_', "-")), module);
    }
}

/// Who calls the functions needs nothing but the header.
#[test]
fn a_header_tells_units_axes_and_order_of_all_entries() {
    let folder = folder("compile_header");
    let header = |scene: &str, name: &str| {
        let source = folder.join(format!("{name}.c"));
        stdout(&["compile", scene, "-o", source.to_str().expect("text")]);
        read(&source.with_extension("h"))
    };
    let cart = header("scenes/plate_cart_arm.toml", "cart");
    for told in [
        "q[0]: q (rad)",
        "q[1 .. 6]: q11, q12, q13 (m), q21, q22, q23 (m)",
        "v, p, a[1 .. 2]: turn (rad/s), forward (m/s)",
        "tau[1 .. 3]: turn (N m), forward (N), sideways (N)",
        "v and tau in axes of the joint's child frame",
        "v and tau in axes of the joint's parent frame",
        "(0.0, 0.0, -9.81) m/s^2",
    ] {
        assert!(cart.contains(told), "{told}: {cart}");
    }
    // One for each function: what its results are.
    let functions = cart.matches("\nvoid cart_").count();
    assert_eq!(functions, 10);
    assert_eq!(cart.matches("\n   results: ").count(), functions);
    assert!(cart.lines().all(|line| line.chars().count() <= 110));
    assert!(!cart.contains("Constraints couple joints"));
    let board = header("scenes/snakeboard.toml", "board");
    assert!(board.contains("Constraints couple joints"), "{board}");
}

#[test]
fn a_module_in_cuda_is_one_source_with_a_kernel_for_each_function() {
    let source = folder("compile_cuda").join("board.cu");
    let shown = source.to_str().expect("text");
    // Kernels take many states with `--lanes` or without.
    let told = stdout(&["compile", "scenes/snakeboard.toml", "--lanes", "-o", shown]);
    assert_eq!(told, "");
    let text = read(&source);
    assert!(!source.with_extension("h").exists() && !text.contains("#include"));
    for function in ["forward_dynamics", "momentum_rates", "poses"] {
        let own = format!("__device__ static void board_{function}(");
        let kernel =
            format!("extern \"C\" __global__ void board_{function}_states(long long count,");
        assert!(text.contains(&own) && text.contains(&kernel), "{function}");
    }
    assert!(text.contains("body `front`"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 110));
}

#[test]
fn an_ending_that_names_no_language_is_refused() {
    let source = folder("compile_ending").join("board.cpp");
    let shown = source.to_str().expect("text");
    let refused = hamel(&["compile", "scenes/snakeboard.toml", "-o", shown]);
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(
        said.contains("`.cpp`") && said.contains("`.cu` (CUDA C++)"),
        "{said}"
    );
    assert!(!source.exists());
}

#[test]
fn what_c_cannot_have_is_refused() {
    let folder = folder("compile_refused");
    let scene = "scenes/snakeboard.toml";
    let quoted = folder.join("a\"b.c");
    let quoted = hamel(&["compile", scene, "-o", quoted.to_str().expect("text")]);
    let said = String::from_utf8_lossy(&quoted.stderr);
    assert_eq!(quoted.status.code(), Some(1), "{said}");
    assert!(said.contains("C cannot include"), "{said}");

    let broken = folder.join("a\nb.c");
    let broken = hamel(&["compile", scene, "-o", broken.to_str().expect("text")]);
    let said = String::from_utf8_lossy(&broken.stderr);
    assert_eq!(broken.status.code(), Some(1), "{said}");
    assert!(said.contains("C cannot include"), "{said}");
    assert!(
        std::fs::read_dir(&folder)
            .expect("a folder")
            .next()
            .is_none()
    );
}

//! Pictures as SVG, PNG and GIF.

use super::common::hamel;
use gif::{ColorOutput, DecodeOptions};
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Runs `hamel simulate` in the root of the repository.
fn run(words: &[&str]) -> Output {
    hamel(&[&["simulate"], words].concat())
}

/// What it tells on stderr where it succeeds.
fn done(words: &[&str]) -> String {
    let output = run(words);
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    told
}

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// Width, and the red, green and blue of each pixel.
fn read_png(path: &Path) -> (usize, Vec<[u8; 3]>) {
    let file = BufReader::new(File::open(path).expect("a file"));
    let mut reader = png::Decoder::new(file).read_info().expect("a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut bytes).expect("a picture");
    let (pixels, rest) = bytes.as_chunks::<3>();
    assert!(rest.is_empty());
    (reader.info().width as usize, pixels.to_vec())
}

#[test]
fn a_picture_is_small_and_the_same_each_time() {
    let path = path("picture.svg");
    let draw = |options: &[&str]| {
        done(&[&["--quiet", "--picture", text(&path)], options].concat());
        fs::read_to_string(&path).expect("a picture")
    };
    let disk = [
        "scenes/rolling_disk.toml",
        "--t-end",
        "1",
        "--instants",
        "4",
    ];
    let picture = draw(&disk);
    assert_eq!(picture, draw(&disk));
    let lines = |start: &str| {
        picture
            .lines()
            .filter(|line| line.starts_with(start))
            .count()
    };
    // The disk in full is two circles of four sectors and a rim; each instant before it is one outline.
    assert_eq!(lines("<g stroke-width=\"6\" opacity"), 3);
    assert!(lines("<path fill") > 3 + 4, "{picture}");
    assert!(picture.ends_with("</svg>\n") && !picture.contains("NaN"));
    let robot = [
        "tests/data/urdf/g1.urdf",
        "--floating-base",
        "--t-end",
        "0.5",
    ];
    let robot = draw(&[&robot[..], &["--dt", "0.005"]].concat());
    assert!(robot.len() < 200_000, "{} bytes", robot.len());
}

/// Pixels of a PNG that is drawn with these options.
fn drawn(name: &str, words: &[&str]) -> (usize, Vec<[u8; 3]>) {
    let path = path(name);
    done(&[&["--quiet", "--png", text(&path)], words].concat());
    read_png(&path)
}

/// The colour of the sky, as in the style sheet of pages.
const SKY: [u8; 3] = [0xee, 0xf1, 0xf6];

#[test]
fn a_png_shows_bodies_their_shadows_and_earlier_instants() {
    let draw = |instants: &str| {
        drawn(
            "disk.png",
            &[
                "scenes/rolling_disk.toml",
                "--t-end",
                "1",
                "--instants",
                instants,
            ],
        )
    };
    let (width, one) = draw("1");
    assert_eq!((width, one.len()), (960, 960 * 640));
    assert_eq!(one[0], SKY);
    let (_, again) = draw("1");
    assert!(one == again);
    let count = |pixels: &[[u8; 3]]| pixels.iter().filter(|pixel| **pixel != SKY).count();
    let (_, four) = draw("4");
    assert!(count(&one) > 20_000, "{}", count(&one));
    // The view takes in the way of the disk, so that it is smaller; but there are four of it.
    assert!(one != four);
    let shades = |pixels: &[[u8; 3]]| {
        pixels
            .iter()
            .collect::<std::collections::BTreeSet<_>>()
            .len()
    };
    assert!(shades(&four) > shades(&one));
}

/// A body that falls, shown by a tetrahedron in a file, red; by the ellipsoid of its inertia where there is no file.
fn falling(folder: &Path, mesh: &str) -> PathBuf {
    let scene = folder.join("falling.toml");
    let text = format!(
        r##"
hamel = 1
name = "falling"
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "stone"
parent = "world"
joint = {{ type = "free" }}
mass = 1.0
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]

[[shape]]
body = "stone"
mesh = {{ file = "{mesh}" }}
color = "#ff0000"

[simulation]
t_end = 0.5
sample_step = 0.02
"##
    );
    fs::write(&scene, text).expect("a file");
    scene
}

#[test]
fn pictures_of_pixels_show_meshes() {
    let folder = path("falling");
    fs::create_dir_all(&folder).expect("a folder");
    let parts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/mjcf/parts");
    fs::copy(parts.join("wedge.obj"), folder.join("wedge.obj")).expect("a copy");
    let red = |[red, green, blue]: &[u8; 3]| *red > 100 && *green < 20 && *blue < 20;
    let count = |scene: &Path| {
        let (_, pixels) = drawn("falling.png", &[text(scene)]);
        pixels.iter().filter(|pixel| red(pixel)).count()
    };
    let shown = count(&falling(&folder, "wedge.obj"));
    assert!(shown > 10_000, "{shown} pixels");
    let missing = falling(&folder, "none.obj");
    assert_eq!(count(&missing), 0);
    let told = done(&[text(&missing), "--png", text(&path("falling.png"))]);
    assert!(told.contains("none.obj"), "{told}");
}

#[test]
fn a_gif_plays_the_motion() {
    let folder = path("played");
    fs::create_dir_all(&folder).expect("a folder");
    let (scene, path) = (falling(&folder, "none.obj"), path("falling.gif"));
    let told = done(&[text(&scene), "--gif", text(&path)]);
    // Shorter motions than 2 s play for that long.
    assert!(
        told.contains("the GIF plays at 0.250 times the speed"),
        "{told}"
    );
    let mut options = DecodeOptions::new();
    options.set_color_output(ColorOutput::Indexed);
    let file = BufReader::new(File::open(&path).expect("a file"));
    let mut reader = options.read_info(file).expect("a GIF");
    assert_eq!((reader.width(), reader.height()), (640, 426));
    let palette = reader.global_palette().expect("colours").to_vec();
    let (mut delays, mut screen, mut changed) = (vec![], vec![0_u8; 640 * 426], vec![]);
    while let Some(frame) = reader.read_next_frame().expect("a frame") {
        let wide = usize::from(frame.width);
        let mut count = 0;
        for (place, index) in frame.buffer.iter().enumerate() {
            let (row, column) = (
                place / wide + usize::from(frame.top),
                place % wide + usize::from(frame.left),
            );
            if frame.transparent != Some(*index) {
                screen[row * 640 + column] = *index;
                count += 1;
            }
        }
        delays.push(frame.delay);
        changed.push(count);
    }
    // 26 samples within 0.5 s, and the last one for a second.
    assert_eq!(delays.len(), 26);
    assert_eq!(delays.iter().sum::<u16>(), 200 + 100);
    assert_eq!(changed[0], 640 * 426);
    assert!(
        changed[1..]
            .iter()
            .all(|count| *count > 100 && *count < 640 * 213),
        "{changed:?}"
    );
    let at = 3 * usize::from(screen[0]);
    let near = palette[at..at + 3]
        .iter()
        .zip(SKY)
        .all(|(a, b)| a.abs_diff(b) <= 3);
    assert!(near, "the sky is {:?}", &palette[at..at + 3]);
}

#[test]
fn a_picture_that_another_program_wrote_is_left() {
    for (name, option) in [("own.png", "--png"), ("own.gif", "--gif")] {
        let path = path(name);
        let _ = fs::remove_file(&path);
        let words = [
            "scenes/free_body.toml",
            "--quiet",
            "--t-end",
            "0.1",
            option,
            text(&path),
        ];
        done(&words);
        // Its own are replaced.
        done(&words);
        let mut bytes = fs::read(&path).expect("a picture");
        let mark = bytes
            .windows(5)
            .position(|part| part == b"hamel")
            .expect("the mark");
        bytes[mark] = b'H';
        fs::write(&path, &bytes).expect("a file");
        let output = run(&words);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains("--force"), "{told}");
        assert!(fs::read(&path).expect("a picture") == bytes);
    }
}

//! States that rows tell besides the last one, and the bands that are drawn of them.

use super::{pendulums, rows};

/// The numbers of `simulate` at the same times, bit for bit; nothing where a motion has ended before.
#[test]
fn samples_are_those_of_the_scene() {
    let place = pendulums(12);
    place.done(
        "sweep pendulum.toml --over table.csv -o out --no-error-estimate --quiet --at 0,0.1,0.25",
    );
    let results = rows(&place, "out");
    let (mut whole, mut stopped) = (0, 0);
    for (number, row) in results.iter().enumerate() {
        let words = format!(
            "sweep pendulum.toml --over table.csv --scene-of {}",
            number + 1
        );
        place.write(
            "row.toml",
            &String::from_utf8_lossy(&place.run(&words).stdout),
        );
        place.done("simulate row.toml --at 0,0.1,0.25 --t-end 0.3 --no-error-estimate --quiet --csv row.csv --force");
        let text = String::from_utf8(place.read("row.csv")).expect("text");
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let names = lines.next().expect("names");
        let place_of = |name: &str| names.iter().position(|known| *known == name).expect(name);
        let wanted = ["pivot.q.q_rad", "pivot.v.q_rad_per_s"].map(place_of);
        let samples: Vec<&str> = lines
            .clone()
            .flat_map(|line| wanted.map(|at| line[at]))
            .collect();
        let told: Vec<&str> = row.split(',').skip(9).collect();
        assert_eq!(told.len(), 6);
        assert_eq!(told[..samples.len()], samples);
        assert!(told[samples.len()..].iter().all(|cell| *cell == "NaN"));
        whole += usize::from(samples.len() == 6);
        stopped += usize::from(samples.len() < 6);
    }
    assert!(
        whole > 0 && stopped > 0,
        "{whole} to the end, {stopped} not"
    );
}

#[test]
fn names_say_when() {
    let place = pendulums(8);
    place.done(
        "sweep pendulum.toml --over table.csv -o out --no-error-estimate --quiet --sample-step 0.1",
    );
    let part = String::from_utf8(place.read("out/part-000001.csv")).expect("text");
    let names: Vec<&str> = part.lines().next().expect("names").split(',').collect();
    let wanted = [
        "pivot.q.q_rad",
        "pivot.v.q_rad_per_s",
        "pivot.q.q_rad@0",
        "pivot.v.q_rad_per_s@0",
        "pivot.q.q_rad@0.1",
        "pivot.v.q_rad_per_s@0.1",
        "pivot.q.q_rad@0.2",
        "pivot.v.q_rad_per_s@0.2",
        "pivot.q.q_rad@0.3",
        "pivot.v.q_rad_per_s@0.3",
    ];
    assert_eq!(names[7..], wanted);
}

#[test]
fn bands_are_drawn_over_time() {
    let place = pendulums(20);
    place.done("sweep pendulum.toml --over table.csv -o out --no-error-estimate --quiet --sample-step 0.05");
    let page = String::from_utf8(place.read("out/summary.html")).expect("text");
    assert_eq!(page.matches("over time</figcaption>").count(), 2);
    assert_eq!(page.matches("<polyline").count(), 2);
    // All start at one angle, so that the band begins in a point.
    let summary = String::from_utf8(place.read("out/summary.csv")).expect("text");
    let start = summary
        .lines()
        .find(|line| line.starts_with("pivot.q.q_rad@0,"));
    let cells: Vec<&str> = start.expect("a sample").split(',').skip(2).collect();
    assert_eq!(cells, vec!["0.2"; 8]);
}

/// What is there has other columns.
#[test]
fn a_folder_with_other_samples_is_left() {
    let place = pendulums(8);
    place.done("sweep pendulum.toml --over table.csv -o out --quiet --at 0.1,0.2");
    let said = place.refused("sweep pendulum.toml --over table.csv -o out --at 0.1", 2);
    assert!(
        said.ends_with("samples were at [0.1, 0.2] s, and are at [0.1] s\n"),
        "{said}"
    );
    let said = place.refused("sweep pendulum.toml --over table.csv -o out", 2);
    assert!(
        said.ends_with("samples were at [0.1, 0.2] s, and are none\n"),
        "{said}"
    );
}

#[test]
fn times_that_no_motion_has_are_refused_at_once() {
    let place = pendulums(1);
    let refused = |words: &str, wanted: &str| {
        let words = format!("sweep pendulum.toml --over table.csv -o out {words}");
        assert_eq!(place.refused(&words, 2), wanted);
        assert!(!place.path("out").exists());
    };
    refused(
        "--at=-1,0.2,0.1,0.2,4",
        "error: a sample at -1 s: times are finite, and not negative\n\
         error: a sample at 0.1 s comes after one at 0.2 s: times ascend, by more than rounding\n\
         error: a sample at 4 s: motions end at 0.3 s\n",
    );
    refused(
        "--sample-step 0",
        "error: the time between two samples is 0.0 s, it must be above 0\n",
    );
    refused(
        "--sample-step 1e-5",
        "error: 30001 samples of 2 coordinates and speeds make 60002 columns, and the limit is 20000\n",
    );
}

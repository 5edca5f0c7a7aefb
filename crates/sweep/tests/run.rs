//! Rows on many threads: order, ends and failures.

use hamel_sweep::{Block, Cells, Outcome, Row, Sweep, SweepError, Watch, run};
use std::collections::BTreeSet;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Condvar, Mutex};

const ARM: &str = r#"
hamel = 1
gravity = [0.0, 0.0, -9.81]

[[body]]
name = "arm"
parent = "world"
mass = 1.0
inertia = [[0.01, 0.0, 0.0], [0.0, 0.02, 0.0], [0.0, 0.0, 0.02]]
joint = { type = "revolute_circle" }
body_at = { position = [0.3, 0.0, 0.0] }
initial = { speeds = [0.0] }

[simulation]
t_end = 0.1
"#;

const SPEED: &str = "body.arm.initial.speeds.1";

fn sweep() -> Sweep {
    Sweep::new(ARM, "arm.toml", &[SPEED], &hamel_sweep::joints()).expect("a scene")
}

/// Blocks of three rows, whose speeds count up.
fn blocks(count: u64) -> impl FnMut() -> Result<Option<Block>, String> + Send {
    let mut next = 0;
    move || {
        let first = next;
        next += 3;
        let rows = (first..next).map(|row| Cells::from([row as f64])).collect();
        Ok((first < 3 * count).then_some(Block { first, rows }))
    }
}

fn moved(workers: usize, watch: Watch<'_>) -> Vec<(u64, Vec<Row>)> {
    let written = Mutex::new(Vec::new());
    let write = |block: &Block, rows: &[Row]| {
        written
            .lock()
            .expect("no panic")
            .push((block.first, rows.to_vec()));
        Ok(())
    };
    let (sweep, joints) = (sweep(), hamel_sweep::joints());
    let done = run(
        &sweep,
        &joints,
        NonZero::new(workers),
        blocks(10),
        &write,
        watch,
    );
    assert_eq!(done, Ok(()));
    let mut written = written.into_inner().expect("no panic");
    written.sort_by_key(|(first, _)| *first);
    written
}

#[test]
fn every_row_is_moved_once_and_has_its_own_result() {
    let count = AtomicUsize::new(0);
    let watch = Watch {
        done: &|rows| {
            count.fetch_add(rows, Ordering::Relaxed);
        },
        ..Watch::NONE
    };
    let many = moved(4, watch);
    assert_eq!(count.into_inner(), 30);
    assert_eq!(many, moved(1, Watch::NONE));
    let (sweep, joints) = (sweep(), hamel_sweep::joints());
    for (first, rows) in &many {
        for (row, result) in (*first..).zip(rows) {
            assert_eq!(*result, sweep.motion(&Cells::from([row as f64]), &joints));
            assert_eq!(result.outcome, Outcome::Ended);
        }
    }
}

/// Each of two threads waits until the other has moved a row too.
#[test]
fn threads_move_rows_at_the_same_time() {
    let (seen, changed) = (Mutex::new(BTreeSet::new()), Condvar::new());
    let watch = Watch {
        done: &|_| {
            let mut names = seen.lock().expect("no panic");
            names.insert(format!("{:?}", std::thread::current().id()));
            changed.notify_all();
            let limit = std::time::Duration::from_secs(100);
            let waited = changed.wait_timeout_while(names, limit, |names| names.len() < 2);
            let (names, limit) = waited.expect("no panic");
            assert!(!limit.timed_out(), "{names:?} alone");
        },
        ..Watch::NONE
    };
    assert_eq!(moved(2, watch).len(), 10);
}

/// An angle that is stored as cosine and sine is followed over the turns of the motion.
#[test]
fn angles_count_turns() {
    let (sweep, joints) = (sweep(), hamel_sweep::joints());
    let place = sweep
        .results()
        .iter()
        .position(|name| name.starts_with("arm.q."));
    let place = place.unwrap_or_else(|| panic!("{:?}", sweep.results()));
    let row = sweep.motion(&Cells::from([300.0]), &joints);
    // 30 rad, and what gravity along the axis does not change.
    assert!((row.numbers[place] - 30.0).abs() < 1e-6, "{row:?}");
}

#[test]
fn nothing_begins_after_a_pause_and_no_result_comes_after_a_stop() {
    let paused = Watch {
        pause: &|| true,
        ..Watch::NONE
    };
    assert_eq!(moved(2, paused), []);
    let stopped = Watch {
        stop: &|| true,
        ..Watch::NONE
    };
    assert_eq!(moved(2, stopped), []);
}

#[test]
fn the_first_failure_ends_it() {
    let (sweep, joints) = (sweep(), hamel_sweep::joints());
    let count = AtomicUsize::new(0);
    let write = |_: &Block, _: &[Row]| {
        count.fetch_add(1, Ordering::Relaxed);
        Err("full".to_owned())
    };
    let workers = NonZero::new(1);
    let ended = run(&sweep, &joints, workers, blocks(10), &write, Watch::NONE);
    assert_eq!((ended, count.into_inner()), (Err("full".into()), 1));
    let unread = || Err("gone".to_owned());
    let written = |_: &Block, _: &[Row]| Ok(());
    let ended = run(&sweep, &joints, workers, unread, &written, Watch::NONE);
    assert_eq!(ended, Err("gone".to_owned()));
}

#[test]
fn a_sound_row_does_not_help_a_scene_with_mistakes() {
    let joints = hamel_sweep::joints();
    let wrong = ARM.replace("mass = 1.0", "mass = -1.0");
    let refused = Sweep::new(&wrong, "arm.toml", &["body.arm.mass"], &joints);
    assert!(matches!(refused, Err(SweepError::Scene(_))));
}

/// The last state is between the ends of steps, where angles known up to turns were not followed before.
#[test]
fn an_event_ends_a_row_at_its_angle() {
    let stop = "[[event]]\nname = \"there\"\nbody = \"arm\"\nalong = [0.0, 1.0, 0.0]\nvalue = 0.2\ndirection = \"falling\"\nthen = \"stop\"\n[simulation]";
    let text = ARM
        .replace("[simulation]", stop)
        .replace("t_end = 0.1", "t_end = 5.0");
    let joints = hamel_sweep::joints();
    let sweep = Sweep::new(&text, "arm.toml", &[SPEED], &joints).expect("a scene");
    let row = sweep.motion(&Cells::from([9.0]), &joints);
    assert_eq!(row.outcome, Outcome::Event("there".into()));
    let place = sweep
        .results()
        .iter()
        .position(|name| name == "arm.q.q_rad");
    let angle = row.numbers[place.expect("an angle")];
    let wanted = std::f64::consts::PI - (0.2_f64 / 0.3).asin();
    assert!((angle - wanted).abs() < 1e-9, "{angle:?}, {wanted:?}");
}

/// Between the ends of steps too, beside the motions that estimates take.
#[test]
fn samples_are_the_states_at_their_times() {
    let joints = hamel_sweep::joints();
    let dense = ARM.replace("[simulation]", "[simulation]\nsampling = \"dense\"");
    for (text, tolerance) in [(ARM, 1e-9), (&*dense, 1e-6)] {
        let sweep = Sweep::new(text, "arm.toml", &[SPEED], &joints).expect("a scene");
        let sweep = sweep.sampling(&[0.0, 0.013, 0.1], &joints).expect("times");
        let sweep = sweep.estimating(&joints).expect("a scene");
        let row = sweep.motion(&Cells::from([3.0]), &joints);
        let shorter = text.replace("t_end = 0.1", "t_end = 0.013");
        let shorter = Sweep::new(&shorter, "arm.toml", &[SPEED], &joints).expect("a scene");
        let until = shorter.motion(&Cells::from([3.0]), &joints);
        let states: Vec<&[f64]> = sweep.states().map(|at| &row.numbers[at]).collect();
        assert_eq!(states[1], [0.0, 3.0]);
        assert_eq!(states[3], states[0]);
        let wanted = &until.numbers[shorter.states().next().expect("the last")];
        let pairs = states[2].iter().zip(wanted);
        for (found, wanted) in pairs {
            assert!((found - wanted).abs() < tolerance, "{found:e}, {wanted:e}");
        }
    }
}

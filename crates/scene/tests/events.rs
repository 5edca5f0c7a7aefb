//! Events, sampling and arithmetic of a scene: what is read, written back, and refused.

use hamel_integrate::{Direction, Sampling};
use hamel_scene::{Arithmetic, EventDescription, QuantityDescription, Scene, SceneDescription};

const BODY: &str = "hamel = 1
gravity = [0, 0, -9.81]
[[body]]
name = \"stone\"
parent = \"world\"
mass = 2.0
inertia_xx_yy_zz_xy_xz_yz = [0.1, 0.1, 0.1, 0.0, 0.0, 0.0]
joint = { type = \"any\" }
";

const EVENTS: &str = "
[[event]]
name = \"apex\"
joint = \"stone\"
speed = \"p3\"
direction = \"falling\"

[[event]]
name = \"level\"
joint = \"stone\"
coordinate = \"z\"
value = 0.3

[[event]]
name = \"landing\"
body = \"stone\"
point = [0.0, 0.1, 0.2]
along = [0.0, 0.0, 2.0]
direction = \"rising\"
then = \"stop\"

[simulation]
sampling = \"dense\"
arithmetic = \"refined\"
";

fn assert_is_read(scene: &SceneDescription) {
    let [apex, level, landing] = &scene.events[..] else {
        panic!("three events")
    };
    let told = |event: &EventDescription| {
        (
            event.name.value.clone(),
            event.value,
            event.direction,
            event.stops,
        )
    };
    assert_eq!(told(apex), ("apex".into(), 0.0, Direction::Falling, false));
    assert_eq!(told(level), ("level".into(), 0.3, Direction::Any, false));
    let expected = ("landing".into(), 0.0, Direction::Rising, true);
    assert_eq!(told(landing), expected);
    assert!(
        matches!(&apex.quantity, QuantityDescription::Speed { joint, name }
        if joint.value == "stone" && name.value == "p3")
    );
    assert!(
        matches!(&level.quantity, QuantityDescription::Coordinate { joint, name }
        if joint.value == "stone" && name.value == "z")
    );
    assert!(
        matches!(&landing.quantity, QuantityDescription::Point(point)
        if point.body == 0 && point.point.as_slice() == [0.0, 0.1, 0.2]
            && point.along.as_slice() == [0.0, 0.0, 1.0])
    );
    assert_eq!(scene.settings.sampling, Sampling::Dense);
    assert_eq!(scene.settings.arithmetic, Arithmetic::Refined);
}

#[test]
fn events_are_read_as_they_are_written() {
    let scene = Scene::from_toml(&format!("{BODY}{EVENTS}"), "scene.toml").expect("sound");
    assert_is_read(&scene);
    let written = scene.to_toml(&[], |_| Vec::new());
    assert_is_read(&Scene::from_toml(&written, "written.toml").expect("sound"));
    let plain = Scene::from_toml(BODY, "scene.toml").expect("sound");
    assert!(plain.events.is_empty());
    assert_eq!(plain.settings.sampling, Sampling::Landing);
    assert_eq!(plain.settings.arithmetic, Arithmetic::Doubles);
}

#[test]
fn mistakes_are_told_all_at_once() {
    let events = "
[[event]]
name = \"end\"
joint = \"ston\"
speed = \"p3\"
then = \"halt\"

[[event]]
name = \"end\"
body = \"world\"
along = [0, 0, 0]

[[event]]
name = \"nowhere\"
value = 1.0

[simulation]
sampling = \"thin\"
arithmetic = \"exact\"
";
    let errors = Scene::from_toml(&format!("{BODY}{events}"), "scene.toml").expect_err("wrong");
    let text = errors.to_string();
    println!("{text}");
    for expected in [
        "event `end`: `joint` is \"ston\", which is not a joint of the scene",
        "did you mean `stone`?",
        "`then` is \"halt\", but must be `record` or `stop`",
        "event `end`: `body` is the world: no point of it crosses anything",
        "`along` is zero; an axis must have a direction",
        "event `nowhere`: ",
        "`simulation.sampling` is \"thin\", but must be `landing` or `dense`",
        "`simulation.arithmetic` is \"exact\", but must be `doubles`, `refined` or `auto`",
    ] {
        assert!(text.contains(expected), "{expected} is not in:\n{text}");
    }
}

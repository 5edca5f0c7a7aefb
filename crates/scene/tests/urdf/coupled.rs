//! Joints that follow others, and loops, of robots with links that are fixed to each other.

use super::{INERTIAL, notices};
use hamel_scene::urdf::{Import, Options, Stops, read};

/// A robot of links of these names, in this order after `base`, and of what else it has.
fn robot(links: &[&str], more: &str) -> Import {
    robot_with(links, more, &Options::default())
}

fn robot_with(links: &[&str], more: &str, options: &Options) -> Import {
    let links = [&["base"], links].concat();
    let link = |name: &str| format!("<link name=\"{name}\">{INERTIAL}</link>");
    let links: String = links.into_iter().map(link).collect();
    let text = format!("<robot name=\"r\">{links}{more}</robot>");
    read(&text, "r.urdf", options).unwrap_or_else(|errors| panic!("{errors}"))
}

/// A joint of that name, which moves the link `of_` and that name.
pub fn joint(name: &str, kind: &str, parent: &str, inside: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"of_{name}\"/>\
         <axis xyz=\"0 0 1\"/>{inside}</joint>"
    )
}

/// The names of links in each of their orders.
fn orders<'n>(names: &[&'n str]) -> Vec<Vec<&'n str>> {
    if names.is_empty() {
        return vec![Vec::new()];
    }
    let with_first = |place: usize| {
        let (first, others) = (
            names[place],
            [&names[..place], &names[place + 1..]].concat(),
        );
        let rests = orders(&others).into_iter();
        rests.map(move |rest| [&[first], rest.as_slice()].concat())
    };
    (0..names.len()).flat_map(with_first).collect()
}

/// What the joints of a robot become, of its bodies in their order.
fn coupled(robot: &Import) -> Vec<String> {
    let scene = robot.scene.coupled();
    let scene = scene.unwrap_or_else(|errors| panic!("{errors}"));
    let bodies = scene.bodies.iter();
    bodies.map(|body| body.joint.name.value.clone()).collect()
}

const AT_MOUNT: &str = "<origin xyz=\"0.3 0 0\"/>";

#[test]
fn a_loop_may_hang_on_links_that_are_fixed_to_its_base() {
    let more = [
        joint("mount", "fixed", "base", AT_MOUNT),
        joint("crank", "continuous", "base", ""),
        joint(
            "coupler",
            "continuous",
            "of_crank",
            "<origin xyz=\"0 0.1 0\"/>",
        ),
        joint("rocker", "continuous", "of_mount", ""),
        String::from(
            "<loop name=\"loop\" type=\"revolute\"><predecessor link=\"of_coupler\"><origin xyz=\"0.3 0.1 0\"/></predecessor>\
             <successor link=\"of_rocker\"><origin xyz=\"0 0.2 0\"/></successor><axis xyz=\"0 0 1\"/></loop>",
        ),
    ];
    let more = more.concat();
    for links in orders(&["of_mount", "of_crank", "of_coupler", "of_rocker"]) {
        let robot = robot(&links, &more);
        assert_eq!(coupled(&robot), ["loop"; 3], "{links:?}");
        let [frame, _] = robot.scene.frames.as_slice() else {
            panic!("{:?}", robot.scene.frames)
        };
        assert_eq!(frame.name.value, "base");
    }
}

#[test]
fn a_follower_may_hang_on_links_that_are_fixed_to_its_base() {
    let more = [
        joint("mount", "fixed", "base", AT_MOUNT),
        joint("between", "continuous", "base", ""),
        joint(
            "follower",
            "continuous",
            "of_between",
            "<mimic joint=\"leader\"/>",
        ),
        joint("leader", "continuous", "of_mount", ""),
    ];
    let more = more.concat();
    for links in orders(&["of_mount", "of_between", "of_follower", "of_leader"]) {
        let joints = coupled(&robot(&links, &more));
        let [first, ..] = joints.as_slice() else {
            panic!("{joints:?}")
        };
        assert!(["leader+between", "between+leader"].contains(&&**first));
        assert_eq!(joints, [&**first; 3], "{links:?}");
    }
}

/// Nothing moves between `mount` and `base`: two hands on one mount are two couplings, each of one coordinate, which can have limits.
#[test]
fn couplings_on_links_that_are_fixed_stay_apart() {
    let limit = "<limit lower=\"-1\" upper=\"1\" effort=\"1\" velocity=\"1\"/>";
    let follows = |leader: &str| format!("{limit}<mimic joint=\"{leader}\"/>");
    let more = [
        joint("mount", "fixed", "base", AT_MOUNT),
        joint("a", "revolute", "base", limit),
        joint("b", "revolute", "base", limit),
        joint("a_too", "revolute", "of_mount", &follows("a")),
        joint("b_too", "revolute", "of_mount", &follows("b")),
    ];
    let options = Options {
        limits: Some(Stops {
            stiffness: 1e3,
            damping: 0.1,
        }),
        ..Options::default()
    };
    let links = ["of_a", "of_mount", "of_b_too", "of_b", "of_a_too"];
    let robot = robot_with(&links, &more.concat(), &options);
    assert_eq!(coupled(&robot), ["a", "a", "b", "b"]);
    let limited = robot.scene.bodies.iter();
    assert!(limited.clone().all(|body| body.forces.limit.is_some()));
    let warned = notices(&robot);
    assert!(
        !warned.iter().any(|own| own.starts_with("warning")),
        "{warned:?}"
    );
}

const EMPTY: &str = "<robot name=\"r\"><link name=\"base\"/>";

/// A leader on `base`, its follower and what moves between, whose links have what is said in them.
fn pair(leader: &str, between: &str, follower: &str) -> String {
    let link = |name: &str, inside: &str| format!("<link name=\"of_{name}\">{inside}</link>");
    [
        EMPTY.to_owned(),
        link("leader", leader),
        link("between", between),
        link("follower", follower),
        joint("leader", "continuous", "base", ""),
        joint("between", "continuous", "base", ""),
        joint(
            "follower",
            "continuous",
            "of_between",
            "<mimic joint=\"leader\" multiplier=\"-2\"/>",
        ),
        String::from("</robot>"),
    ]
    .concat()
}

/// Joints that follow each other have one acceleration, which any mass among them determines. A lenient reader changes nothing of them, and fixes those that move nothing.
#[test]
fn one_mass_is_enough_for_joints_that_follow_each_other() {
    let lenient = Options {
        lenient: true,
        ..Options::default()
    };
    for (text, moving, lenient_moving) in [
        (pair(INERTIAL, INERTIAL, ""), Some(3), 3),
        (pair("", INERTIAL, INERTIAL), Some(3), 3),
        (pair("", "", INERTIAL), Some(3), 3),
        (pair("", INERTIAL, ""), None, 1),
        // The follower's mass does nothing for what carries it without any.
        (pair(INERTIAL, "", ""), None, 2),
    ] {
        let strict = read(&text, "r.urdf", &Options::default());
        let strict = strict.map(|import| import.scene.bodies.len());
        assert_eq!(strict.as_ref().ok(), moving.as_ref(), "{text}: {strict:?}");
        let import = read(&text, "r.urdf", &lenient);
        let import = import.unwrap_or_else(|errors| panic!("{errors}"));
        assert_eq!(import.scene.bodies.len(), lenient_moving, "{text}");
        let is_fixed = |own: &String| own.contains("are fixed");
        let told = notices(&import);
        assert_eq!(told.iter().any(is_fixed), moving.is_none(), "{told:?}");
    }
}

#[test]
fn a_mimic_of_a_fixed_joint_is_told() {
    let more = [
        joint("a", "continuous", "base", ""),
        joint("b", "fixed", "base", "<mimic joint=\"a\"/>"),
    ];
    let told = notices(&robot(&["of_a", "of_b"], &more.concat()));
    let wanted = "note: fixed joints follow none: their mimic has no effect: joint `b`";
    assert!(told.iter().any(|own| own == wanted), "{told:?}");
}

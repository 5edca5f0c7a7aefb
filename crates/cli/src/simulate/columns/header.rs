//! Whether the names of a file's columns are such as trajectories have, of whatever scene.

use super::parts::{BODY, FRAME, MECHANISM, ends};

/// What stands between a joint and one of its numbers.
const OF_JOINTS: [&str; 7] = [
    ".q.", ".v.", ".port.", ".rate.", ".lambda.", ".pin.", ".tau.",
];

/// The columns of version 0.1: a file that it wrote is replaced as one of today's is.
const OLDER: [&str; 3] = [
    "t_s energy_J",
    ".x_m .y_m .z_m .rx_rad .ry_rad .rz_rad .vx_m_per_s .vy_m_per_s .vz_m_per_s .wx_rad_per_s .wy_rad_per_s .wz_rad_per_s",
    ".x_m .y_m .z_m .qw .qx .qy .qz",
];

/// Whether these are the columns of the mechanism, of bodies, of frames and of joints, one group after the other, and no others.
pub fn are_columns(names: &[&str]) -> bool {
    let today = [ends(&MECHANISM), ends(&BODY), ends(&FRAME)];
    let older = OLDER.map(|ends| ends.split(' ').map(str::to_owned).collect());
    are_groups(names, &today) || are_groups(names, &older)
}

fn are_groups(names: &[&str], [mechanism, body, frame]: &[Vec<String>; 3]) -> bool {
    let Some(mut names) = rest(names, "", mechanism) else {
        return false;
    };
    while let [first, ..] = names {
        let owner = first.strip_suffix(body[0].as_str()).unwrap_or_default();
        let group = [body, frame].into_iter();
        let mut group = group.filter_map(|ends| rest(names, owner, ends));
        names = match group.next() {
            Some(rest) if !owner.is_empty() => rest,
            _ if OF_JOINTS.iter().any(|of| first.contains(of)) => &names[1..],
            _ => return false,
        };
    }
    true
}

/// What follows on the columns of `owner` with these ends, if the names begin with them.
fn rest<'n, 't>(names: &'n [&'t str], owner: &str, ends: &[String]) -> Option<&'n [&'t str]> {
    let (group, rest) = names.split_at_checked(ends.len())?;
    let mut named = group.iter().zip(ends);
    let is_group = named.all(|(name, end)| name.strip_prefix(owner) == Some(end));
    is_group.then_some(rest)
}

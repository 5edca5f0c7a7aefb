//! What coupled joints call their bodies and coordinates, and the units of the latter.

use super::{Link, LinkMotion, MOST_LINKS};
use crate::joint::{Unit, Units};

/// Names of bodies.
pub(super) const BODIES: [&str; MOST_LINKS] = [
    "link_1", "link_2", "link_3", "link_4", "link_5", "link_6", "link_7", "link_8", "link_9",
    "link_10", "link_11", "link_12", "link_13", "link_14", "link_15", "link_16",
];

/// Names of N coordinates, of which the first are independent: `q` of one.
pub(super) const fn coordinates<const N: usize>(independent: usize) -> [&'static str; N] {
    let first = ["q_1", "q_2", "q_3", "q_4", "q_5", "q_6"];
    let others = [
        "y_1", "y_2", "y_3", "y_4", "y_5", "y_6", "y_7", "y_8", "y_9", "y_10", "y_11", "y_12",
        "y_13", "y_14", "y_15",
    ];
    let mut names = ["q"; N];
    let mut k = 0;
    while k < N {
        if k >= independent {
            names[k] = others[k - independent];
        } else if independent > 1 {
            names[k] = first[k];
        }
        k += 1;
    }
    names
}

/// Coordinates whose units are reported: those of all but the largest linkages.
const TOLD: usize = 6;

/// All combinations of angles and lengths: coordinate k of combination n is a length where bit k of n is 1.
static UNITS: [[Unit; TOLD]; 1 << TOLD] = {
    let mut all = [[Unit::ANGLE; TOLD]; 1 << TOLD];
    let mut n = 0;
    while n < all.len() {
        let mut k = 0;
        while k < TOLD {
            if n >> k & 1 == 1 {
                all[n][k] = Unit::LENGTH;
            }
            k += 1;
        }
        n += 1;
    }
    all
};

/// Those of so many coordinates, of which K are independent: each is what the first link that follows it is moved by.
pub(super) fn units<const K: usize>(links: &[Link], coordinates: usize) -> Units {
    let is_length = |k: usize| {
        let first = links.iter().find(|link| link.coordinate == k);
        first.is_some_and(|link| link.motion == LinkMotion::Slide)
    };
    let told = coordinates.min(TOLD);
    let combination = (0..told).map(|k| usize::from(is_length(k)) << k);
    let units = UNITS.get(combination.sum::<usize>());
    let all = units.and_then(|units| units.get(..told));
    let all = all.unwrap_or_default();
    let rates = all.get(..K).unwrap_or_default();
    Units::new(all, rates, rates, rates)
}

#[cfg(test)]
mod tests {
    use super::super::{Link, LinkMotion, coupled};
    use crate::joint::{Port, Unit};
    use crate::spatial::Pose;

    const PORTS: [Port; 3] = [Port {
        name: "y",
        unit: "rad",
        wraps: false,
    }; 3];

    /// A turn, a slide, and a turn that follows the slide.
    #[test]
    fn a_coordinate_is_measured_as_what_follows_it_first() {
        let link = |motion, coordinate| Link {
            before: None,
            frame: Pose::identity(),
            motion,
            coordinate,
            ratio: 1.0,
            offset: 0.0,
        };
        let links = [
            link(LinkMotion::Turn, 0),
            link(LinkMotion::Slide, 1),
            link(LinkMotion::Turn, 1),
        ];
        let joint = coupled(&links, &PORTS).expect("links of a joint");
        let units = joint.units();
        assert_eq!(units.coordinates, [Unit::ANGLE, Unit::LENGTH]);
        assert_eq!(units.speed(1), Unit::LENGTH);
        assert_eq!(units.speed(2), Unit::UNKNOWN);
    }
}

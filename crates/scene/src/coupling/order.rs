//! An order of bodies in which each stands after its parent, and those of a coupling follow each other.

use super::Group;
use crate::parse::order as by_parents;

/// Every body, after the one that `parents` names, which need not be the one that it hangs on; among those that could come next, the first in the file.
pub(crate) fn order(parents: &[Option<usize>], groups: &[Group]) -> Vec<usize> {
    if groups.is_empty() {
        return by_parents(parents);
    }
    // Each group stands for itself at the place of its first body.
    let mut first: Vec<usize> = (0..parents.len()).collect();
    let mut joined = parents.to_vec();
    let mut members: Vec<&[(usize, _)]> = vec![&[]; parents.len()];
    for group in groups {
        let places = group.members.iter().map(|(place, _)| *place);
        let Some(least) = places.clone().min() else {
            continue;
        };
        places.for_each(|place| first[place] = least);
        members[least] = &group.members;
    }
    for group in groups {
        // The first hangs on no other of them, and comes after all that has to be there.
        let base = group.members.first().and_then(|(root, _)| parents[*root]);
        for (place, _) in &group.members {
            joined[*place] = match first[*place] == *place {
                true => base,
                // After the place that stands for all.
                false => Some(first[*place]),
            };
        }
    }
    let stands_for = |place: Option<usize>| place.map(|place| first[place]);
    let joined: Vec<Option<usize>> = joined.into_iter().map(stands_for).collect();
    let is_told = |place: &usize| first[*place] == *place;
    let order = by_parents(&joined).into_iter().filter(is_told);
    order
        .flat_map(|place| match members[place] {
            [] => vec![place],
            own => own.iter().map(|(place, _)| *place).collect(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::Group;
    use super::super::graph::Law;
    use super::order;

    /// The order does not depend on what follows what.
    const OWN: Law = Law {
        leader: 0,
        ratio: 1.0,
        offset: 0.0,
    };

    #[test]
    fn bodies_of_a_coupling_follow_each_other() {
        // 4 and 1 are coupled on 0; 2 hangs on 4, 3 on 1.
        let parents = [None, Some(0), Some(4), Some(1), Some(0)];
        let group = Group {
            base: Some(0),
            members: vec![(1, OWN), (4, OWN)],
            ties: Vec::new(),
        };
        assert_eq!(order(&parents, &[group]), [0, 1, 4, 2, 3]);
        assert_eq!(order(&parents, &[]), [0, 1, 3, 4, 2]);
    }

    #[test]
    fn a_coupling_on_one_of_several_bodies_of_a_joint_comes_after_all_of_these() {
        // 2, 3 and 4 are bodies of one joint; 0 and 1 are coupled on 2.
        let parents = [Some(4), Some(4), None, None, None];
        let group = Group {
            base: Some(2),
            members: vec![(0, OWN), (1, OWN)],
            ties: Vec::new(),
        };
        assert_eq!(order(&parents, &[group]), [2, 3, 4, 0, 1]);
    }
}

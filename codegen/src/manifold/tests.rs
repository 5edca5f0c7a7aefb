use super::{Factor, Ideal, Kind, Manifold};
use crate::expr::{Expr, Role, Symbol};
use std::collections::BTreeSet;

fn manifold(kind: Kind) -> Manifold {
    Manifold::new(&[("Q".to_owned(), kind)])
}

#[test]
fn so3_has_twenty_quadrics() {
    let so3 = manifold(Kind::So3);
    let basis = so3.ideal().basis();
    assert_eq!(basis.len(), 20);
    assert!(basis.iter().all(|g| {
        g.leading()
            .is_some_and(|(monomial, _)| monomial.degree() == 2)
    }));
}

#[test]
fn a_rotation_has_determinant_one_and_is_its_own_cofactor() {
    let so3 = manifold(Kind::So3);
    let q = so3.factors()[0].matrix();
    let determinant = q.determinant(&Expr::clone);
    assert!(so3.ideal().normal_form(&determinant).is_one());
    let cofactor = q.adjugate(&Expr::clone).transpose();
    assert!(so3.ideal().normal_forms(&cofactor.minus(&q)).is_zero());
}

#[test]
fn normal_forms_separate_what_differs() {
    let so3 = manifold(Kind::So3);
    let q = so3.factors()[0].matrix();
    assert!(!so3.ideal().vanishes(&(q.at(0, 0) - q.at(1, 1))));
    assert!(!so3.ideal().vanishes(&(&q.at(0, 0).square() - &Expr::one())));
}

#[test]
fn the_home_of_every_manifold_lies_on_it() {
    for kind in [
        Kind::Real(3),
        Kind::S1,
        Kind::So2,
        Kind::Se2,
        Kind::S3,
        Kind::So3,
        Kind::Se3,
        Kind::S2,
    ] {
        let m = manifold(kind);
        let home = m.coordinates().into_iter().zip(m.home()).collect();
        assert!(
            m.relations().iter().all(|g| g.substitute(&home).is_zero()),
            "{}",
            kind.name()
        );
        assert_eq!(Kind::parse(&kind.name()), Some(kind));
    }
}

#[test]
fn inverses_are_inverses() {
    for kind in [
        Kind::Real(2),
        Kind::S1,
        Kind::So2,
        Kind::Se2,
        Kind::S3,
        Kind::So3,
        Kind::Se3,
    ] {
        let m = manifold(kind);
        let q = m.factors()[0].matrix();
        let inverse = m.factors()[0].inverse(&q).expect("a group");
        let identity = crate::matrix::Matrix::identity(q.rows());
        assert!(
            m.ideal()
                .normal_forms(&q.times(&inverse).minus(&identity))
                .is_zero(),
            "{}",
            kind.name()
        );
        assert_eq!(m.factors()[0].embed(&m.factors()[0].coordinates_of(&q)), q);
    }
}

#[test]
fn functions_bring_their_relations() {
    let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
    let free = Ideal::default();
    assert!(free.vanishes(&(&(&x.sin().square() + &x.cos().square()) - &Expr::one())));
    let u = &Expr::one() + &x.square();
    assert!(free.vanishes(&(&u.sqrt().square() - &u)));
    let quotient = u.recip().expect("not zero");
    assert!(free.vanishes(&(&(&quotient * &u) - &Expr::one())));
    // 1/√u · √u = 1 needs both relations at once.
    let root = u.sqrt();
    assert!(free.vanishes(&(&(&root.recip().expect("not zero") * &root) - &Expr::one())));
}

#[test]
fn polynomials_without_common_zero_are_recognised() {
    let so3 = manifold(Kind::So3);
    let q = so3.factors()[0].matrix();
    // A row of a rotation is never zero; one entry can be.
    let row = [q.at(0, 0), q.at(0, 1), q.at(0, 2)].map(Expr::clone);
    let none = BTreeSet::new();
    assert!(so3.ideal().has_no_zero_with(&row, &none, |_| false));
    assert!(!so3.ideal().has_no_zero_with(&row[..1], &none, |_| false));
}

#[test]
fn nothing_is_divided_by_parameters_that_may_be_zero() {
    let so3 = manifold(Kind::So3);
    let q = so3.factors()[0].matrix();
    let parameter = Symbol::new(Role::Parameter, 0, "a");
    let a = Expr::symbol(&parameter);
    let row = [q.at(0, 0), q.at(0, 1), q.at(0, 2)].map(|entry| &a * entry);
    let vanishing = BTreeSet::from([parameter]);
    assert!(
        so3.ideal()
            .has_no_zero_with(&row, &BTreeSet::new(), |_| false)
    );
    assert!(!so3.ideal().has_no_zero_with(&row, &vanishing, |_| false));
    // a r and 1 + a have no common zero, whatever a is: r is a row, and a = 0 leaves 1.
    let one_more = [&row[..], &[&Expr::one() + &a]].concat();
    assert!(
        so3.ideal()
            .has_no_zero_with(&one_more, &vanishing, |_| false)
    );
    // a x = 0 says nothing of x where a is 0; x + a = 0 says as much for every a.
    let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
    for (relation, undivided) in [(&a * &x, false), (&x + &a, true)] {
        let ideal = Ideal::new(std::slice::from_ref(&relation));
        assert_eq!(ideal.follows_undivided(&[relation], &vanishing), undivided);
    }
}

#[test]
fn factors_are_named_after_themselves_where_there_are_several() {
    let named = |alone| {
        Factor::new("R", Kind::So3, Role::Coordinate, 0, alone).coordinates[1]
            .name()
            .to_string()
    };
    assert_eq!(
        (named(true).as_str(), named(false).as_str()),
        ("q12", "r_q12")
    );
}

//! The fibres of H: whether one pose has one Q.

use super::{Claim, Proof};
use crate::domain::Domain;
use crate::expr::{Atom, Expr, Function, Monomial, Rational, Role, Symbol};
use crate::manifold::{Factor, Kind};
use crate::prepare::Prepared;
use std::collections::{BTreeMap, BTreeSet};

/// What is known of the configurations that share a pose; `None` where it was not decided.
///
/// Coordinates that move no body are known of no pose, and are named apart.
pub fn claim(joint: &Prepared, domain: &Domain<'_>, still: &[Symbol]) -> Option<Claim> {
    let (statement, detail) = Fibres::new(joint, domain, still).statement()?;
    let statement = match still {
        [] => statement,
        _ => format!("{statement}, apart from {}", names(still)),
    };
    let statement = match joint.spec.more.is_empty() {
        true => statement,
        false => format!("{statement}; the poses of all bodies count as one"),
    };
    Some(Claim {
        name: "fibres",
        statement,
        proof: Proof::Certificate,
        detail,
        points: 0,
    })
}

/// H, entry by entry in normal form.
struct Fibres<'a> {
    joint: &'a Prepared,
    domain: &'a Domain<'a>,
    entries: Vec<Expr>,
    still: &'a [Symbol],
}

impl<'a> Fibres<'a> {
    fn new(joint: &'a Prepared, domain: &'a Domain<'a>, still: &'a [Symbol]) -> Self {
        let entries = joint.spec.poses().flat_map(|pose| pose.value.entries());
        Self {
            joint,
            domain,
            still,
            entries: entries.map(|e| domain.ideal().normal_form(e)).collect(),
        }
    }

    /// Statement and reason.
    fn statement(&self) -> Option<(String, String)> {
        let known = self.known();
        let coordinates = self.joint.space.manifold.coordinates().into_iter();
        let rest: Vec<Symbol> = coordinates
            .filter(|symbol| !known.contains(&Atom::Symbol(symbol.clone())))
            .filter(|symbol| !self.still.contains(symbol))
            .collect();
        if rest.is_empty() {
            let reason = match self.still {
                [] => "every stored scalar can be read off H",
                _ => "every other stored scalar can be read off H",
            };
            return Some(("one pose has one Q".into(), reason.into()));
        }
        self.double_cover(&rest)
            .or_else(|| self.full_turns(&rest, &known))
            .or_else(|| self.negated(&rest))
    }

    /// Scalars, and sines and cosines of them, that a pose determines: those that are linear in an entry of H of which
    /// everything else is determined already.
    fn known(&self) -> BTreeSet<Atom> {
        let coordinates = self.joint.space.manifold.coordinates();
        let mut open: BTreeSet<Atom> = coordinates.into_iter().map(Atom::Symbol).collect();
        let atoms = self.entries.iter().flat_map(Expr::atoms);
        open.extend(atoms.filter(|atom| turned(atom).is_some()));
        let mut known = BTreeSet::new();
        loop {
            let gives = |entry: &Expr, atom: &Atom| self.gives(entry, atom, &known);
            let found: BTreeSet<Atom> = open
                .iter()
                .filter(|atom| {
                    self.follows(atom, &known) || self.entries.iter().any(|e| gives(e, atom))
                })
                .cloned()
                .collect();
            if found.is_empty() {
                return known;
            }
            open.retain(|atom| !found.contains(atom));
            known.extend(found);
        }
    }

    /// Whether the manifold's relations express a scalar by known ones.
    fn follows(&self, atom: &Atom, known: &BTreeSet<Atom>) -> bool {
        let normal = self.domain.ideal().normal_form(&Expr::atom(atom.clone()));
        let mut atoms = normal.atoms().into_iter();
        atoms.all(|atom| is_known(&atom, known))
    }

    /// Whether the entry is `u atom + rest` with a u that is never 0 and a known rest.
    fn gives(&self, entry: &Expr, atom: &Atom, known: &BTreeSet<Atom>) -> bool {
        let (with, without): (Vec<_>, Vec<_>) = entry
            .terms()
            .partition(|(monomial, _)| monomial.power(atom) != 0);
        let [(monomial, _)] = with.as_slice() else {
            return false;
        };
        let units = Expr::one().scaled(&Rational::from_integer(1.into()), &monomial.split().1);
        monomial.main() == [(atom.clone(), 1)]
            && self.domain.is_unit(&units)
            && without
                .iter()
                .flat_map(|(monomial, _)| monomial.main())
                .all(|(other, _)| is_known(other, known))
    }

    /// The scalars are those of one unit quaternion, and H determines the product of any two of them, so that only their
    /// common sign is open.
    fn double_cover(&self, rest: &[Symbol]) -> Option<(String, String)> {
        let mut factors = self.joint.space.manifold.factors().iter();
        let factor =
            factors.find(|factor| factor.kind == Kind::S3 && factor.coordinates == rest)?;
        if !self.gives_products(factor) || !self.is_even(rest) {
            return None;
        }
        let name = &factor.name;
        let others = match self.joint.space.manifold.factors().len() {
            1 => "",
            _ => ", all else being equal,",
        };
        Some((
            format!("{name} and −{name}{others} have one pose: a double cover"),
            format!("H determines the products of any two entries of {name}"),
        ))
    }

    /// Whether the products of two entries of the factor are sums of multiples of 1 and of the entries of H.
    fn gives_products(&self, factor: &Factor) -> bool {
        let of_factor =
            |atom: &Atom| matches!(atom, Atom::Symbol(s) if factor.coordinates.contains(s));
        let numbers_apart = |entry: &&Expr| {
            let mut terms = entry.terms();
            terms.all(|(m, _)| m.units().is_empty() && m.main().iter().all(|(a, _)| of_factor(a)))
        };
        let one = Expr::one();
        let mut span: Vec<Expr> = vec![];
        for entry in self.entries.iter().filter(numbers_apart).chain([&one]) {
            let left = reduced(entry, &span);
            if !left.is_zero() {
                span.push(left);
            }
        }
        let q: Vec<Expr> = factor.coordinates.iter().map(Expr::symbol).collect();
        let product = |i: usize, j: usize| self.domain.ideal().normal_form(&(&q[i] * &q[j]));
        let mut pairs = (0..q.len()).flat_map(|i| (0..=i).map(move |j| (i, j)));
        pairs.all(|(i, j)| reduced(&product(i, j), &span).is_zero())
    }

    /// The scalars enter H through sine and cosine alone, and H determines these.
    fn full_turns(&self, rest: &[Symbol], known: &BTreeSet<Atom>) -> Option<(String, String)> {
        let turns: BTreeSet<(Function, &Symbol)> = known.iter().filter_map(turned).collect();
        let determined = |symbol: &Symbol| {
            turns.contains(&(Function::Cos, symbol)) && turns.contains(&(Function::Sin, symbol))
        };
        let periodic = |symbol: &Symbol| {
            let mut atoms = self.entries.iter().flat_map(Expr::atoms);
            atoms.all(|atom| !symbols_of(&atom).contains(symbol) || known.contains(&atom))
        };
        let all = rest
            .iter()
            .all(|symbol| determined(symbol) && periodic(symbol));
        all.then(|| {
            let statement = format!("one pose has one Q up to full turns of {}", names(rest));
            let reason =
                "their sines and cosines can be read off H, and nothing else of them enters it";
            (statement, reason.into())
        })
    }

    /// The scalars negated share the pose.
    fn negated(&self, rest: &[Symbol]) -> Option<(String, String)> {
        self.is_even(rest).then(|| {
            (
                format!("Q and the one with {} negated share a pose", names(rest)),
                "H is even in them; whether other Q have that pose was not decided".into(),
            )
        })
    }

    /// Whether H does not change where the scalars change their signs, and neither do the relations and the domain.
    fn is_even(&self, scalars: &[Symbol]) -> bool {
        let negative = |symbol: &Symbol| (symbol.clone(), -Expr::symbol(symbol));
        let negative: BTreeMap<Symbol, Expr> = scalars.iter().map(negative).collect();
        let ideal = self.domain.ideal();
        let relations = self.joint.space.manifold.relations();
        let stays = relations
            .iter()
            .all(|g| ideal.vanishes(&g.substitute(&negative)));
        let even = |entry: &Expr| ideal.vanishes(&(&entry.substitute(&negative) - entry));
        let odd = |entry: &Expr| ideal.vanishes(&(&entry.substitute(&negative) + entry));
        let declared = self.joint.critical();
        let loci = self
            .joint
            .space
            .loci
            .iter()
            .map(|locus| &locus.value.function);
        stays
            && self.entries.iter().all(even)
            && loci.into_iter().all(|f| even(f) || odd(f))
            && self.domain.sides(&declared).iter().all(even)
    }
}

/// The function and its argument, where the atom is the sine or cosine of a scalar.
fn turned(atom: &Atom) -> Option<(Function, &Symbol)> {
    let Atom::Apply(application) = atom else {
        return None;
    };
    let trigonometric = matches!(application.function, Function::Cos | Function::Sin);
    let symbol = application.arguments.first()?.as_symbol()?;
    (trigonometric && symbol.role == Role::Coordinate).then_some((application.function, symbol))
}

fn symbols_of(atom: &Atom) -> BTreeSet<Symbol> {
    Expr::atom(atom.clone()).symbols()
}

/// Whether the atom, or every scalar in it, is among the known ones.
fn is_known(atom: &Atom, known: &BTreeSet<Atom>) -> bool {
    let is_coordinate = |symbol: &Symbol| symbol.role == Role::Coordinate;
    let mut scalars = symbols_of(atom).into_iter().filter(is_coordinate);
    known.contains(atom) || scalars.all(|symbol| known.contains(&Atom::Symbol(symbol)))
}

/// The expression less multiples of the members of a span, which have different leading monomials: 0 where it lies in the span.
fn reduced(expression: &Expr, span: &[Expr]) -> Expr {
    let mut left = expression.clone();
    while let Some((monomial, coefficient)) = left.leading() {
        let member = span
            .iter()
            .filter_map(|e| Some((e, e.leading()?)))
            .find(|(_, (leading, _))| *leading == monomial);
        let Some((member, (_, of_member))) = member else {
            return left;
        };
        let factor = coefficient / of_member;
        left = &left - &member.scaled(&factor, &Monomial::one());
    }
    left
}

fn names(symbols: &[Symbol]) -> String {
    let names: Vec<&str> = symbols.iter().map(|symbol| symbol.name()).collect();
    names.join(", ")
}

#[cfg(test)]
mod tests {
    use super::claim;
    use crate::domain::Domain;
    use crate::prepare::Prepared;
    use crate::spec;

    fn statement(declared: &str) -> Option<String> {
        let source = format!(
            "hamel = 1;\njoint test(gain: m >= 0, arm: m > 0) {{ require arm > gain; {declared} }}"
        );
        let joint = spec::parse(&source, "test.joint").expect("a valid spec");
        let joint = Prepared::new(joint).expect("its conditions say something");
        claim(&joint, &Domain::new(&joint.space), &[]).map(|claim| claim.statement)
    }

    #[test]
    fn full_turns_need_sine_and_cosine_in_h() {
        let up_to = |names: &str| Some(format!("one pose has one Q up to full turns of {names}"));
        let pose = |h: &str| statement(&format!("config a: R1, b: R1, c: R1; H = {h};"));
        assert_eq!(pose("trans([b, c, gain]) * rot_z(a)"), up_to("a"));
        assert_eq!(pose("rot_z(a) * rot_y(b) * trans_z(arm * c)"), None);
        assert_eq!(
            pose("trans([arm * cos(a) + b, sin(a), cos(a)]) * rot_x(c)"),
            up_to("a, c")
        );
        // (a, b, c) and (a + π, π − b, c + π) have one pose.
        assert_eq!(pose("rot_z(a) * rot_y(b) * rot_x(c)"), None);
        // π/2 and 3π/2 have one pose.
        assert_eq!(pose("trans([cos(a), sin(a) * cos(a), b]) * rot_z(c)"), None);
        assert_eq!(
            pose("trans([gain * cos(a), gain * sin(a), b]) * rot_z(c)"),
            None
        );
    }

    #[test]
    fn a_double_cover_is_that_of_one_quaternion() {
        let r = "pose(rot(q), [arm, 0, gain])";
        assert_eq!(
            statement(&format!(
                "config q: S3; basis x, y, z of so3; velocity in child; H = {r};"
            )),
            Some("q and −q have one pose: a double cover".into())
        );
        // H gives the products of q, and at another place q itself: (p, w p).
        let odd = "pose(rot(q), [p, p * q.w, 0])";
        assert_eq!(
            statement(&format!(
                "config q: S3, p: R1; basis x, y, z of so3; velocity in child; H = {odd};"
            )),
            None
        );
    }

    #[test]
    fn what_is_not_in_the_domain_shares_no_pose() {
        let half = "velocity in child; except q.w = 0; A = [log(q.w); 1; 0];";
        let quaternion = format!(
            "config q: S3; basis x, y, z of so3; {half} S_bar = [1, 0; -log(q.w), 0; 0, 1]; H = pose(rot(q), [0, 0, 0]);"
        );
        assert_eq!(statement(&quaternion), None);
        let beside = "config a: R1, b: R1; home = 1, 0; except a = 0; except a + 1 = 0;";
        assert_eq!(
            statement(&format!("{beside} H = trans([a * a, b, 0]);")),
            None
        );
    }

    #[test]
    fn even_functions_share_poses_and_no_more_is_said() {
        let pose = |h: &str| statement(&format!("config a: R1; H = {h};"));
        let negated = Some("Q and the one with a negated share a pose".to_owned());
        assert_eq!(pose("rot_z(a * a * a * a)"), negated);
        assert_eq!(pose("trans_x(arm * a)"), Some("one pose has one Q".into()));
        assert_eq!(pose("trans_x(gain * a)"), None);
        assert_eq!(pose("rot_z(a + a * a)"), None);
    }
}

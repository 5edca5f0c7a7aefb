//! What a spec declares, in symbols: the border between the spec language and the derivation.

use crate::expr::curve::Curve;
use crate::expr::{Expr, Rational, Symbol};
use crate::manifold::Manifold;
use crate::matrix::Matrix;
use crate::units::Units;
use std::collections::BTreeMap;
use std::ops::Range;

/// A value together with the bytes of the spec that declare it.
#[derive(Clone, Debug)]
pub struct Declared<T> {
    /// The value.
    pub value: T,
    /// Where it is declared: bytes of the source.
    pub span: Range<usize>,
}

/// A parameter of a joint.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its symbol; its name is also the name of the field in Rust.
    pub symbol: Symbol,
    /// SI unit as written: `m`, `rad`, `1`, ….
    pub unit: String,
    /// Doc comment.
    pub docs: String,
    /// Values that it may take: without bounds, every number but zero.
    pub range: Interval,
}

impl Parameter {
    /// Whether its range says that it may be zero; a parameter without a range is not.
    pub fn may_vanish(&self) -> bool {
        self.range != Interval::default() && self.range.contains(&Rational::default())
    }
}

/// An interval of values; `None` is unbounded.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Interval {
    /// Lower end.
    pub lower: Option<End>,
    /// Upper end.
    pub upper: Option<End>,
}

impl Interval {
    /// Whether it holds one value alone.
    pub fn is_one_number(&self) -> bool {
        matches!((&self.lower, &self.upper), (Some(a), Some(b)) if a.value == b.value)
    }

    /// Whether the value lies in it.
    pub fn contains(&self, value: &Rational) -> bool {
        let above = |end: &End| *value > end.value || end.included && *value == end.value;
        let below = |end: &End| *value < end.value || end.included && *value == end.value;
        self.lower.as_ref().is_none_or(above) && self.upper.as_ref().is_none_or(below)
    }
}

/// One end of an [`Interval`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct End {
    /// Its value.
    pub value: Rational,
    /// Whether the value itself belongs to the interval.
    pub included: bool,
}

/// A set that the joint's configuration must stay away from: the zeros of a function of Q.
#[derive(Clone, Debug)]
pub struct Locus {
    /// The function.
    pub function: Expr,
    /// The equation as the spec writes it, `cos(b) = 0`.
    pub text: String,
    /// Doc comment: why the joint ends there.
    pub docs: String,
}

/// A condition on the parameters: `value` is positive.
#[derive(Clone, Debug)]
pub struct Requirement {
    /// A polynomial in the parameters.
    pub value: Expr,
    /// As the spec writes it, `outer > inner`.
    pub text: String,
}

/// A scalar that the author names: a `let`, or an entry of one.
#[derive(Clone, Debug)]
pub struct Named {
    /// `lean`; `contact1` for an entry of a vector, `arm11` for one of a matrix.
    pub symbol: Symbol,
    /// Its value in parameters, stored scalars and the names before it.
    pub value: Expr,
}

/// What a spec declares in the author's own names.
#[derive(Clone, Debug, Default)]
pub struct Worded {
    /// The `let`s, entry by entry, in order.
    pub named: Vec<Named>,
    /// H of each body; empty where one of them cannot be said in names.
    pub poses: Vec<PoseExpr>,
    /// X, where declared.
    pub twist_map: Option<Matrix>,
    /// A, where declared.
    pub constraint: Option<Matrix>,
    /// S̄, where declared.
    pub speed_basis: Option<Matrix>,
}

/// One direction of local motion: a local coordinate ϕ and a velocity v of the same name.
#[derive(Clone, Debug)]
pub struct Freedom {
    /// Name of the local coordinate and of the velocity.
    pub name: String,
    /// The symbol ϕ_k, `Role::Local`, named `phi_<name>`.
    pub local: Symbol,
    /// The factor that it moves.
    pub factor: usize,
    /// Its generator: coordinates in the standard basis of that factor's algebra; rational or of parameters. Empty for a
    /// degree of freedom to which only Φ gives a meaning: one of `local`, or one on a manifold of relations.
    pub generator: Vec<Expr>,
}

/// How v moves Q where the spec declares relations and no Φ.
#[derive(Clone, Debug)]
pub enum Implicit {
    /// Along these directions of factors, each with its generator in the standard basis of that factor's algebra. All other directions
    /// follow by the relations.
    Independent(Vec<(usize, Vec<Expr>)>),
    /// Along the generalised cross product of the relations' gradients: one degree of freedom.
    CrossProduct,
}

/// A coordinate of a joint that is none of its local coordinates: the angle of a motor inside a linkage.
#[derive(Clone, Debug)]
pub struct Port {
    /// Its name.
    pub name: String,
    /// `rad` or `m`.
    pub unit: String,
    /// Doc comment.
    pub docs: String,
    /// The expression as the spec writes it.
    pub text: String,
    /// Its value as a function of Q.
    pub value: PortValue,
}

/// The value of a port.
#[derive(Clone, Debug)]
pub enum PortValue {
    /// A scalar.
    Scalar(Expr),
    /// The angle of a direction in a plane, up to whole turns.
    Angle {
        /// Its cosine.
        cos: Expr,
        /// Its sine.
        sin: Expr,
    },
}

impl Port {
    /// What its value is made of.
    pub fn entries(&self) -> Vec<&Expr> {
        match &self.value {
            PortValue::Scalar(value) => vec![value],
            PortValue::Angle { cos, sin } => vec![cos, sin],
        }
    }

    /// Whether its value is an angle up to whole turns.
    pub fn wraps(&self) -> bool {
        matches!(self.value, PortValue::Angle { .. })
    }
}

/// A point at which two bodies of a joint hold each other, or a body and the frame that the joint hangs on.
#[derive(Clone, Debug)]
pub struct Pin {
    /// Its name.
    pub name: String,
    /// Doc comment.
    pub docs: String,
    /// What it says, as the spec writes it.
    pub text: String,
    /// The point in the frame of each.
    pub ends: [PinEnd; 2],
    /// The axis of the second one about which the first turns.
    pub about: Option<Axis>,
    /// The axis of the second one along which the first slides.
    pub along: Option<Axis>,
}

/// A point of a body.
#[derive(Clone, Debug)]
pub struct PinEnd {
    /// The place of the body; `None` for the frame that the joint hangs on.
    pub body: Option<usize>,
    /// Three coordinates in its frame.
    pub point: Vec<Expr>,
}

/// An axis of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Its x axis.
    X,
    /// Its y axis.
    Y,
    /// Its z axis.
    Z,
}

impl Pin {
    /// What its points are made of.
    pub fn entries(&self) -> impl Iterator<Item = &Expr> {
        self.ends.iter().flat_map(|end| &end.point)
    }
}

/// The frame in which v is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityFrame {
    /// Child frame: `X^c` at ϕ = 0 is the velocity of Φ itself.
    Child,
    /// Parent frame: X is the constant that `X^c` would be.
    Parent,
    /// Not declared: v = ϕ̇ at ϕ = 0 (path joints), or X is declared.
    Rates,
}

/// H(Q).
#[derive(Clone, Debug)]
pub struct PoseExpr {
    /// 3×3.
    pub rotation: Matrix,
    /// 3×1.
    pub translation: Matrix,
}

impl PoseExpr {
    /// The entries of both.
    pub fn entries(&self) -> impl Iterator<Item = &Expr> {
        let rotation = self.rotation.entries().iter();
        rotation.chain(self.translation.entries())
    }
}

/// Where a joint lives: its manifold without the exceptions, for the values that its parameters may take.
#[derive(Clone, Debug)]
pub struct ConfigurationSpace {
    /// Parameters in order.
    pub parameters: Vec<Parameter>,
    /// Conditions on the parameters.
    pub requirements: Vec<Declared<Requirement>>,
    /// Where Q lives.
    pub manifold: Manifold,
    /// Where Q must not come.
    pub loci: Vec<Declared<Locus>>,
    /// The stored scalars at home, in order.
    pub home: Vec<Expr>,
    /// Whether they are a guess, off the relations.
    pub home_is_guess: bool,
}

impl ConfigurationSpace {
    /// That of a spec, as declared.
    pub fn declared(spec: &JointSpec) -> Self {
        let declared = spec.home.as_ref().map(|home| home.value.clone());
        Self {
            parameters: spec.parameters.clone(),
            requirements: spec.requirements.clone(),
            manifold: spec.manifold.value.clone(),
            loci: spec.loci.clone(),
            home_is_guess: spec.home_is_guess,
            home: declared.unwrap_or_else(|| spec.manifold.value.home()),
        }
    }

    /// Parameters and stored scalars, in order.
    pub(crate) fn symbols(&self) -> Vec<Symbol> {
        let parameters = self.parameters.iter().map(|p| p.symbol.clone());
        parameters.chain(self.manifold.coordinates()).collect()
    }

    /// Each stored scalar at home; none where that is a guess, so that nothing is concluded from it.
    pub(crate) fn home_values(&self) -> BTreeMap<Symbol, Expr> {
        if self.home_is_guess {
            return BTreeMap::new();
        }
        let coordinates = self.manifold.coordinates().into_iter();
        coordinates.zip(self.home.iter().cloned()).collect()
    }
}

/// A joint as its spec declares it: parsed, evaluated, shapes checked; nothing derived, nothing proved.
#[derive(Clone, Debug)]
pub struct JointSpec {
    /// Name, a Rust identifier in snake case.
    pub name: Declared<String>,
    /// Doc comment, line by line.
    pub docs: Vec<String>,
    /// The spec's text.
    pub source: String,
    /// Parameters in order.
    pub parameters: Vec<Parameter>,
    /// Conditions on the parameters.
    pub requirements: Vec<Declared<Requirement>>,
    /// Where Q lives; relations that the spec declares are part of it.
    pub manifold: Declared<Manifold>,
    /// Where each relation that the spec declares stands; a matrix of relations is several.
    pub relation_spans: Vec<Range<usize>>,
    /// What everything is measured in.
    pub units: Units,
    /// Where Q must not come: H, Φ, X, A or S̄ lose their meaning or their rank there.
    pub loci: Vec<Declared<Locus>>,
    /// The stored scalars of the home configuration, where declared.
    pub home: Option<Declared<Vec<Expr>>>,
    /// Whether these are a guess, from which home is found by projection onto the relations.
    pub home_is_guess: bool,
    /// Local coordinates, in order: those of a `basis`, else the coordinates of the real factors.
    pub freedoms: Declared<Vec<Freedom>>,
    /// Frame of v.
    pub velocity: Declared<VelocityFrame>,
    /// Names of the bodies, where the spec gives some; `pose` is that of the first.
    pub bodies: Vec<String>,
    /// H(Q).
    pub pose: Declared<PoseExpr>,
    /// H(Q) of the bodies after the first.
    pub more: Vec<Declared<PoseExpr>>,
    /// Coordinates at which efforts act and rates are read, besides v.
    pub ports: Vec<Declared<Port>>,
    /// Where bodies hold each other.
    pub pins: Vec<Declared<Pin>>,
    /// Φ(Q, ϕ) as stored scalars, where declared.
    pub retract: Option<Declared<Vec<Expr>>>,
    /// How v moves Q on the manifold of the relations, where these say more than the basis and Φ is not declared.
    pub implicit: Option<Implicit>,
    /// X(Q), 6×k, where declared; of several bodies one below the other.
    pub twist_map: Option<Declared<Matrix>>,
    /// A(Q), k×(k−k̄), where declared.
    pub constraint: Option<Declared<Matrix>>,
    /// S̄(Q), k×k̄, where declared.
    pub speed_basis: Option<Declared<Matrix>>,
    /// Names of the speeds, where declared.
    pub speed_names: Option<Declared<Vec<String>>>,
    /// The same in the author's names.
    pub worded: Worded,
    /// Claims that need no proof.
    pub unproved: Vec<Declared<Unproved>>,
    /// Curves in order.
    pub curves: Vec<DeclaredCurve>,
    /// Where they are called, with which argument.
    pub calls: Vec<Declared<(Curve, Expr)>>,
}

/// A curve, and where it is declared.
#[derive(Clone, Debug)]
pub struct DeclaredCurve {
    /// The curve.
    pub curve: Curve,
    /// Units of its argument and of its values, as they are after those of the knots are brought to metres and radians.
    pub units: [String; 2],
    /// The bytes of its statement.
    pub span: Range<usize>,
    /// The file with its knots, where they stand in one.
    pub file: Option<KnotFile>,
}

/// A file with the knots of a curve.
#[derive(Clone, Debug)]
pub struct KnotFile {
    /// The bytes that name it: `from "profile.csv"`.
    pub span: Range<usize>,
    /// Its name; it stands beside the spec.
    pub name: String,
    /// The knots as a spec writes them: `through [0, 0], …`.
    pub knots: String,
}

/// The claims that a spec may leave unproved: identities.
pub const CHECKABLE: &[&str] = &[
    "pose_in_se3",
    "retract_at_zero",
    "retract_on_manifold",
    "twist_map_in_frame",
    "twist_map_matches_pose",
    "velocity_map_first_order",
    "velocity_map_inverse",
    "twist_map_child",
    "speeds_meet_constraint",
    "port_angles",
    "port_rates",
    "pins_meet",
    "pins_hold",
];

/// A claim that the author wants to rest on evaluation at points.
#[derive(Clone, Debug)]
pub struct Unproved {
    /// The stable name of the claim, `speeds_meet_constraint` and the like.
    pub claim: String,
    /// Why it is true, in the author's words.
    pub reason: String,
}

impl JointSpec {
    /// The curves.
    pub fn curves(&self) -> Vec<Curve> {
        self.curves.iter().map(|declared| declared.curve).collect()
    }

    /// The text with the knots of files in it: one that needs no file beside it.
    pub fn whole_source(&self) -> String {
        let mut text = self.source.clone();
        for declared in self.curves.iter().rev() {
            if let Some(file) = &declared.file {
                text.replace_range(file.span.clone(), &file.knots);
            }
        }
        text
    }

    /// H of every body, in order.
    pub fn poses(&self) -> impl Iterator<Item = &Declared<PoseExpr>> {
        std::iter::once(&self.pose).chain(&self.more)
    }

    /// The same joint as if it carried that body alone; as it is where there is no such body.
    pub fn carrying(&self, body: usize) -> Self {
        let mut alone = self.clone();
        if let Some(pose) = self.poses().nth(body) {
            alone.pose = pose.clone();
            alone.more = vec![];
            let own = |map: &mut Matrix| *map = map.rows_of_body(body);
            alone.twist_map.iter_mut().for_each(|x| own(&mut x.value));
            alone.worded.twist_map.iter_mut().for_each(own);
            let pose = self.worded.poses.get(body).cloned();
            alone.worded.poses = pose.into_iter().collect();
        }
        alone
    }

    /// What is declared of Q in matrices: H of every body, X, A and S̄.
    pub(crate) fn matrices(&self) -> impl Iterator<Item = &Matrix> {
        let poses = self
            .poses()
            .flat_map(|pose| [&pose.value.rotation, &pose.value.translation]);
        let others = [&self.twist_map, &self.constraint, &self.speed_basis];
        let others = others.into_iter().flatten().map(|matrix| &matrix.value);
        poses.chain(others)
    }

    /// The degrees of freedom of one factor.
    pub(crate) fn freedoms_of(&self, factor: usize) -> impl Iterator<Item = &Freedom> {
        let freedoms = self.freedoms.value.iter();
        freedoms.filter(move |freedom| freedom.factor == factor)
    }
}

//! The tree of a spec as it is written, with the bytes of the source that each part comes from.

use crate::expr::Rational;
use crate::expr::curve::{Ends, Kind, Outside};
use crate::model::Axis;
use std::collections::BTreeSet;
use std::ops::Range;

/// A name and where it stands.
#[derive(Clone, Debug)]
pub(super) struct Name {
    pub text: String,
    pub span: Range<usize>,
}

/// A spec file.
#[derive(Debug)]
pub(super) struct File {
    pub docs: Vec<String>,
    pub name: Name,
    pub parameters: Vec<Parameter>,
    pub statements: Vec<Statement>,
    /// Whether some of the text could not be read: what is missing may stand there.
    pub partial: bool,
}

impl File {
    /// All names that expressions of the file speak of.
    pub fn used_names(&self) -> BTreeSet<&str> {
        let mut names = BTreeSet::new();
        self.statements
            .iter()
            .flat_map(Statement::nodes)
            .for_each(|node| node.collect_names(&mut names));
        names
    }
}

/// `name: unit`, and the values that it may take.
#[derive(Debug)]
pub(super) struct Parameter {
    pub docs: Vec<String>,
    pub name: Name,
    pub unit: Name,
    pub range: Option<Bounds>,
}

/// `> 0`, `>= 0 < 5`, `in 0..=1`.
#[derive(Debug)]
pub(super) struct Bounds {
    pub span: Range<usize>,
    pub lower: Option<Bound>,
    pub upper: Option<Bound>,
}

/// One end of the range of a parameter.
#[derive(Debug)]
pub(super) struct Bound {
    pub value: Node,
    pub included: bool,
}

/// One statement, up to its `;`.
#[derive(Debug)]
pub(super) struct Statement {
    pub span: Range<usize>,
    pub kind: StatementKind,
}

impl Statement {
    fn nodes(&self) -> Vec<&Node> {
        match &self.kind {
            StatementKind::Basis(basis) => basis
                .elements
                .iter()
                .filter_map(|(_, value)| value.as_ref())
                .collect(),
            StatementKind::Let(_, value) => vec![value],
            StatementKind::Relation(equation) | StatementKind::Except(equation) => {
                vec![&equation.left, &equation.right]
            }
            StatementKind::Require(requirement) => vec![&requirement.larger, &requirement.smaller],
            StatementKind::Port(port) => vec![&port.value],
            StatementKind::Pin(pin) => pin.ends.iter().map(|end| &end.point).collect(),
            StatementKind::Assign(_, values) | StatementKind::BodyPose(_, values) => {
                values.iter().collect()
            }
            _ => vec![],
        }
    }
}

#[derive(Debug)]
pub(super) enum StatementKind {
    /// `config Q: SO3, …;`
    Config(Vec<(Name, Name)>),
    /// `basis a, b = …, … of algebra(factor);`
    Basis(Basis),
    /// `local a, b;`
    Local(Vec<Name>),
    /// `velocity in child;`
    Velocity { child: bool },
    /// `speeds a, b;`
    Speeds(Vec<Name>),
    /// `bodies a, b;`
    Bodies(Vec<Name>),
    /// `port a: unit = …;`
    Port(Port),
    /// `pin a: body at … = body at … about z;`
    Pin(Pin),
    /// `let a = …;`
    Let(Name, Node),
    /// `curve f(unit): unit = … ;`
    Curve(Curve),
    /// `relation a = b;`
    Relation(Equation),
    /// `except a = b;`
    Except(Equation),
    /// `require a > b;`
    Require(Requirement),
    /// `unproved claim because "…";`
    Unproved(Name, Name),
    /// `H = …;` and its like; Phi and home have one value for each factor.
    Assign(Target, Vec<Node>),
    /// `H.a = …;`, the pose of one of several bodies: one value.
    BodyPose(Name, Vec<Node>),
}

/// A function through knots.
#[derive(Debug)]
pub(super) struct Curve {
    pub name: Name,
    /// Unit of the argument.
    pub argument: Name,
    /// Unit of the values.
    pub unit: Name,
    pub kind: Kind,
    pub ends: Ends,
    pub knots: Knots,
    /// `continue …`, and where it stands.
    pub outside: Option<(Outside, Range<usize>)>,
}

/// `through [x, y], …`, or `from "file"`.
#[derive(Debug)]
pub(super) enum Knots {
    Points(Vec<(Range<usize>, [Rational; 2])>),
    /// Its name, and the bytes from `from` on.
    File(Name, Range<usize>),
}

/// `left = right`, with the doc comment before the statement.
#[derive(Debug)]
pub(super) struct Equation {
    pub docs: Vec<String>,
    pub left: Node,
    pub right: Node,
}

impl Equation {
    /// The bytes of both sides.
    pub fn span(&self) -> Range<usize> {
        self.left.span.start..self.right.span.end
    }
}

/// `larger > smaller`, or written the other way round.
#[derive(Debug)]
pub(super) struct Requirement {
    pub larger: Node,
    pub smaller: Node,
}

impl Requirement {
    /// The bytes of both sides.
    pub fn span(&self) -> Range<usize> {
        let (a, b) = (&self.larger.span, &self.smaller.span);
        a.start.min(b.start)..a.end.max(b.end)
    }
}

/// `name: unit = value`, with the doc comment before the statement.
#[derive(Debug)]
pub(super) struct Port {
    pub docs: Vec<String>,
    pub name: Name,
    pub unit: Name,
    pub value: Node,
}

/// `name: body at point = body at point`, with `about axis` and `along axis`, and with the doc comment before the statement.
#[derive(Debug)]
pub(super) struct Pin {
    pub docs: Vec<String>,
    pub name: Name,
    pub ends: [PinEnd; 2],
    pub about: Option<Axis>,
    pub along: Option<Axis>,
    /// The bytes after the name.
    pub span: Range<usize>,
}

/// `body at point`.
#[derive(Debug)]
pub(super) struct PinEnd {
    pub body: Name,
    pub point: Node,
}

#[derive(Debug)]
pub(super) struct Basis {
    pub elements: Vec<(Name, Option<Node>)>,
    pub algebra: Name,
    pub factor: Option<Name>,
}

/// What a spec declares by `=`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Target {
    Home,
    /// `home near …;`: a guess of home, which is projected onto the relations.
    Near,
    Retract,
    Pose,
    TwistMap,
    Constraint,
    SpeedBasis,
}

impl Target {
    pub const ALL: [Self; 7] = [
        Self::Home,
        Self::Near,
        Self::Retract,
        Self::Pose,
        Self::TwistMap,
        Self::Constraint,
        Self::SpeedBasis,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Home => "home",
            Self::Near => "home near",
            Self::Retract => "Phi",
            Self::Pose => "H",
            Self::TwistMap => "X",
            Self::Constraint => "A",
            Self::SpeedBasis => "S_bar",
        }
    }
}

/// An expression.
#[derive(Debug)]
pub(super) struct Node {
    pub span: Range<usize>,
    pub kind: NodeKind,
}

impl Node {
    fn collect_names<'a>(&'a self, names: &mut BTreeSet<&'a str>) {
        let mut all = |nodes: &'a [Node]| nodes.iter().for_each(|node| node.collect_names(names));
        match &self.kind {
            NodeKind::Number(_) => {}
            NodeKind::Name(name) => _ = names.insert(name),
            NodeKind::Call(name, arguments) => {
                all(arguments);
                names.insert(&name.text);
            }
            NodeKind::Field(base, _) | NodeKind::Negative(base) => base.collect_names(names),
            NodeKind::Index(base, indices) => {
                all(indices);
                base.collect_names(names);
            }
            NodeKind::Literal(rows) => rows.iter().for_each(|row| all(row)),
            NodeKind::Sum(items) | NodeKind::Product(items) => {
                items.iter().for_each(|(_, node)| node.collect_names(names))
            }
        }
    }
}

/// Chains of one precedence are one node, so that the depth of the tree is that of the brackets.
#[derive(Debug)]
pub(super) enum NodeKind {
    Number(Rational),
    Name(String),
    Call(Name, Vec<Node>),
    Field(Box<Node>, Name),
    Index(Box<Node>, Vec<Node>),
    /// Rows of blocks.
    Literal(Vec<Vec<Node>>),
    Negative(Box<Node>),
    /// Terms, each with whether it is subtracted.
    Sum(Vec<(bool, Node)>),
    /// Factors, each with whether it divides.
    Product(Vec<(bool, Node)>),
}

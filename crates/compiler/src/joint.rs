//! The kernels of one joint of a scene, on the graph.

use super::graph::{Sym, call, call_two, primitive, sin_cos};
use super::linkage;
use super::products::{JointType, Product};
use super::spatial::{Mat3, Step, Twist, Vec3, Wrench, simplified};
use hamel_codegen::derived::KernelKind;
use hamel_codegen::expr::{Function, Symbol};
use hamel_codegen::formula::{Binding, Node, Program};
use num_traits::ToPrimitive;
use std::collections::BTreeMap;

/// A joint at one state.
pub struct Joint<'a> {
    joint: &'a JointType,
    values: BTreeMap<Symbol, Sym>,
    /// Where it is a joint of links, these.
    linkage: Option<linkage::At<'a>>,
}

impl<'a> Joint<'a> {
    /// The joint with numbers for its parameters, at Q and v̄.
    pub fn new(joint: &'a JointType, parameters: &[f64], q: &[Sym], speeds: &[Sym]) -> Self {
        let derived = &joint.derived;
        let numbers = parameters.iter().map(|&number| Sym::from(number));
        let parameters = derived.spec.parameters.iter().map(|known| &known.symbol);
        let mut values: BTreeMap<Symbol, Sym> = parameters.cloned().zip(numbers).collect();
        let arguments = &derived.arguments;
        values.extend(
            arguments
                .configuration
                .iter()
                .cloned()
                .zip(q.iter().copied()),
        );
        values.extend(arguments.speeds.iter().cloned().zip(speeds.iter().copied()));
        // Home is asked for without Q.
        let linkage = joint.linkage.as_ref();
        let linkage = linkage.filter(|_| q.len() == derived.shape.configuration);
        let linkage = linkage.map(|linkage| linkage.at(q, speeds));
        Self {
            joint,
            values,
            linkage,
        }
    }

    /// The stored scalars of the home configuration.
    pub fn home(&self) -> Vec<Sym> {
        if let Some(linkage) = &self.joint.linkage {
            return linkage.home();
        }
        self.entries(KernelKind::Home)
    }

    /// H(Q), from child to parent.
    pub fn pose(&self) -> Vec<Step> {
        if let Some(links) = &self.linkage {
            return links.pose();
        }
        let entries = self.entries(KernelKind::Pose);
        let Some((rotation, translation)) = entries.split_at_checked(9) else {
            return vec![];
        };
        let steps = [
            Step::Shift(Vec3::from_iterator(translation.iter().copied())),
            Step::rotation(&Mat3::from_row_iterator(rotation.iter().copied())),
        ];
        simplified(steps)
    }

    /// The rotation of H(Q).
    pub fn rotation(&self) -> Mat3 {
        if let Some(links) = &self.linkage {
            return links.rotation();
        }
        let entries = self.entries(KernelKind::Pose);
        Mat3::from_fn(|i, j| entries.get(3 * i + j).copied().unwrap_or(Sym::Number(0.0)))
    }

    /// The columns of X^c.
    pub fn freedoms(&self) -> Vec<Twist> {
        if let Some(links) = &self.linkage {
            return links.freedoms_in_child();
        }
        let entries = self.entries(KernelKind::TwistMapChild);
        columns(&entries, self.joint.derived.shape.freedoms)
    }

    /// S̄ by rows, one per degree of freedom.
    pub fn speed_basis(&self) -> Vec<Vec<Sym>> {
        let (freedoms, speeds) = (
            self.joint.derived.shape.freedoms,
            self.joint.derived.shape.speeds,
        );
        let entries = self.entries(KernelKind::SpeedBasis);
        if entries.len() == freedoms * speeds {
            return entries.chunks(speeds.max(1)).map(<[Sym]>::to_vec).collect();
        }
        let unit = |i: usize, j: usize| Sym::from(f64::from(u8::from(i == j)));
        let row = |i: usize| (0..speeds).map(|j| unit(i, j)).collect();
        (0..freedoms).map(row).collect()
    }

    /// `c = Ẋ̄^c v̄`.
    pub fn bias_acceleration(&self) -> Twist {
        if let Some(links) = &self.linkage {
            return links.bias();
        }
        let entries = self.entries(KernelKind::BiasAcceleration);
        columns(&entries, 1).pop().unwrap_or_else(Twist::zero)
    }

    /// The columns of X.
    pub fn freedoms_in_parent(&self) -> Vec<Twist> {
        if let Some(links) = &self.linkage {
            return links.freedoms_in_parent();
        }
        let entries = self.entries(KernelKind::TwistMap);
        columns(&entries, self.joint.derived.shape.freedoms)
    }

    /// S₀ by rows, one row after the other.
    pub fn velocity_map(&self) -> Vec<Sym> {
        self.entries(KernelKind::VelocityMap)
    }

    /// ∂S/∂ϕ at ϕ = 0, for each ϕ as S₀; none where the velocities are rates of coordinates.
    pub fn velocity_map_gradient(&self) -> Vec<Vec<Sym>> {
        if self.linkage.is_some() {
            return vec![];
        }
        let size = self.joint.derived.shape.freedoms.pow(2).max(1);
        let entries = self.entries(KernelKind::VelocityMapGradient);
        entries.chunks(size).map(<[Sym]>::to_vec).collect()
    }

    /// S₀⁻¹ by columns.
    pub fn velocity_map_inverse(&self) -> Vec<Vec<Sym>> {
        if self.linkage.is_some() {
            return self.speed_basis();
        }
        let freedoms = self.joint.derived.shape.freedoms;
        let entries = self.entries(KernelKind::VelocityMapInverse);
        let column = |j: usize| entries.iter().skip(j).step_by(freedoms).copied().collect();
        (0..freedoms).map(column).collect()
    }

    /// The columns of X^c S₀: ϕ̇ to the twist in the child frame.
    pub fn local_twist_map(&self) -> Vec<Twist> {
        if let Some(links) = &self.linkage {
            return links.freedoms_in_child();
        }
        let entries = self.product(&self.joint.products.local_twist_map, &[]);
        columns(&entries, self.joint.derived.shape.freedoms)
    }

    /// ∂(X̄^c x)/∂ϕ, one column per degree of freedom.
    pub fn twist_gradient(&self, x: &[Sym]) -> Vec<Twist> {
        if let Some(links) = &self.linkage {
            return links.gradient(x);
        }
        let given = [(self.joint.derived.arguments.speeds.as_slice(), x)];
        let entries = self.product(&self.joint.products.twist_gradient, &given);
        columns(&entries, self.joint.derived.shape.freedoms)
    }

    /// ∂c/∂ϕ, one column per degree of freedom.
    pub fn bias_gradient(&self) -> Vec<Twist> {
        if let Some(links) = &self.linkage {
            return links.bias_gradient();
        }
        let entries = self.product(&self.joint.products.bias_acceleration_gradient, &[]);
        columns(&entries, self.joint.derived.shape.freedoms)
    }

    /// ∂c/∂v̄, one column per speed.
    pub fn bias_slope(&self) -> Vec<Twist> {
        if let Some(links) = &self.linkage {
            return links.bias_slope();
        }
        let entries = self.product(&self.joint.products.bias_acceleration_slope, &[]);
        columns(&entries, self.joint.derived.shape.speeds)
    }

    /// ∂(X̄^cᵀ h)/∂ϕ by rows, one per speed; none where X̄^c is constant.
    pub fn effort_gradient(&self, wrench: &Wrench) -> Vec<Vec<Sym>> {
        if let Some(links) = &self.linkage {
            return links.effort_gradient(wrench);
        }
        let parts = parts_of(wrench);
        let given = [(self.joint.derived.arguments.wrench.as_slice(), &parts[..])];
        let entries = self.product(&self.joint.products.effort_gradient, &given);
        let rows = entries.chunks(self.joint.derived.shape.freedoms.max(1));
        rows.map(<[Sym]>::to_vec).collect()
    }

    /// `Q̇(Q, v)`.
    pub fn configuration_rate(&self, velocity: &[Sym]) -> Vec<Sym> {
        if let Some(links) = &self.linkage {
            return links.configuration_rate(velocity);
        }
        let given = [(self.joint.derived.arguments.velocity.as_slice(), velocity)];
        self.entries_with(KernelKind::ConfigurationRate, &given)
    }

    /// How the stored scalars of Q change with each ϕ, at ϕ = 0: `Q̇(Q, S₀ e)`.
    pub fn configuration_slopes(&self) -> Vec<Vec<Sym>> {
        if let Some(links) = &self.linkage {
            return links.tangent();
        }
        let freedoms = self.joint.derived.shape.freedoms;
        let map = self.entries(KernelKind::VelocityMap);
        let column = |k: usize| -> Vec<Sym> {
            let velocity = map.iter().skip(k).step_by(freedoms).copied();
            self.configuration_rate(&velocity.collect::<Vec<_>>())
        };
        (0..freedoms).map(column).collect()
    }

    /// Φ(Q, ϕ); not of a joint of links.
    pub fn retract(&self, phi: &[Sym]) -> Vec<Sym> {
        let given = [(self.joint.derived.arguments.local.as_slice(), phi)];
        self.entries_with(KernelKind::Retract, &given)
    }

    /// ϕ with Φ(Q, ϕ) = Q′.
    pub fn local(&self, target: &[Sym]) -> Vec<Sym> {
        if let Some(links) = &self.linkage {
            return links.local(target);
        }
        let given = [(self.joint.derived.arguments.target.as_slice(), target)];
        self.entries_with(KernelKind::Local, &given)
    }

    /// ϕ̇ at ϕ, from S₀(Q′)⁻¹ v at Q′ = Φ(Q, ϕ).
    pub fn retract_differential_inverse(&self, phi: &[Sym], rate: &[Sym]) -> Vec<Sym> {
        if self.linkage.is_some() {
            return rate.to_vec();
        }
        let arguments = &self.joint.derived.arguments;
        let given = [
            (arguments.local.as_slice(), phi),
            (arguments.velocity.as_slice(), rate),
        ];
        self.entries_with(KernelKind::RetractDifferentialInverse, &given)
    }

    /// P by rows, one per port.
    pub fn port_map(&self) -> Vec<Vec<Sym>> {
        if let Some(links) = &self.linkage {
            return links.port_map();
        }
        let entries = self.entries(KernelKind::PortMap);
        let rows = entries.chunks(self.joint.derived.shape.freedoms.max(1));
        rows.map(<[Sym]>::to_vec).collect()
    }

    /// The values of the ports.
    pub fn port_values(&self) -> Vec<Sym> {
        self.entries(KernelKind::PortValues)
    }

    /// Whether the value of a port is an angle up to whole turns.
    pub fn port_wraps(&self, port: usize) -> bool {
        let ports = &self.joint.derived.spec.ports;
        ports.get(port).is_some_and(|port| port.value.wraps())
    }

    /// Σ_k γ_k v_k by rows, at v; none where velocities commute because they are rates of coordinates.
    pub fn gamma(&self, velocity: &[Sym]) -> Vec<Vec<Sym>> {
        if self.linkage.is_some() {
            return vec![];
        }
        let given = [(self.joint.derived.arguments.velocity.as_slice(), velocity)];
        let entries = self.entries_with(KernelKind::Gamma, &given);
        let rows = entries.chunks(velocity.len().max(1));
        rows.map(<[Sym]>::to_vec).collect()
    }

    /// `Ẋ̄^cᵀ h` at v̄.
    pub fn bias_momentum(&self, momentum: &Wrench) -> Vec<Sym> {
        if let Some(links) = &self.linkage {
            return links.bias_momentum(momentum);
        }
        let parts = parts_of(momentum);
        let given = [(self.joint.derived.arguments.wrench.as_slice(), &parts[..])];
        self.entries_with(KernelKind::BiasMomentum, &given)
    }

    /// The nearest point of the manifold; not of a joint of links.
    pub fn project(&self) -> Vec<Sym> {
        self.entries(KernelKind::Project)
    }

    /// The entries of a kernel's results, row by row; none where the joint has no such kernel.
    fn entries(&self, kind: KernelKind) -> Vec<Sym> {
        self.entries_with(kind, &[])
    }

    /// The same with values for more symbols.
    fn entries_with(&self, kind: KernelKind, given: &[(&[Symbol], &[Sym])]) -> Vec<Sym> {
        let Some(kernel) = self.joint.derived.kernel(kind) else {
            return vec![];
        };
        run(self.joint.derived.program(kernel), self.values_with(given))
    }

    /// The entries of a product of kernels, row by row, with values for more symbols.
    fn product(&self, product: &Product, given: &[(&[Symbol], &[Sym])]) -> Vec<Sym> {
        run(self.joint.program(product), self.values_with(given))
    }

    fn values_with(&self, given: &[(&[Symbol], &[Sym])]) -> BTreeMap<Symbol, Sym> {
        let mut values = self.values.clone();
        for (symbols, given) in given {
            values.extend(symbols.iter().cloned().zip(given.iter().copied()));
        }
        values
    }
}

/// The six entries of a wrench or a momentum, moment first.
fn parts_of(wrench: &Wrench) -> Vec<Sym> {
    let parts = wrench.moment.iter().chain(&wrench.force);
    parts.copied().collect()
}

fn run(program: &Program, mut values: BTreeMap<Symbol, Sym>) -> Vec<Sym> {
    for binding in &program.bindings {
        match binding {
            Binding::Value { name, value } => {
                let value = evaluate(value, &values);
                values.insert(name.clone(), value);
            }
            Binding::SinCos { sin, cos, angle } => {
                let (sine, cosine) = sin_cos(evaluate(angle, &values));
                let named = [(sin, sine), (cos, cosine)];
                let named = named.into_iter();
                values.extend(named.filter_map(|(name, value)| Some((name.clone()?, value))));
            }
            Binding::Call {
                primitive: function,
                argument,
                outputs,
            } => {
                let arguments: Vec<Sym> = argument
                    .iter()
                    .map(|part| evaluate(part, &values))
                    .collect();
                let results = primitive(*function, &arguments);
                values.extend(outputs.iter().cloned().zip(results));
            }
        }
    }
    let outputs = program.outputs.iter();
    outputs.map(|output| evaluate(output, &values)).collect()
}

/// The columns of a matrix of six rows, given row by row.
fn columns(entries: &[Sym], count: usize) -> Vec<Twist> {
    let at = |i: usize, j: usize| {
        entries
            .get(i * count + j)
            .copied()
            .unwrap_or(Sym::Number(0.0))
    };
    let column = |j: usize| Twist {
        angular: Vec3::from_fn(|i, _| at(i, j)),
        linear: Vec3::from_fn(|i, _| at(i + 3, j)),
    };
    (0..count).map(column).collect()
}

fn evaluate(node: &Node, values: &BTreeMap<Symbol, Sym>) -> Sym {
    let of = |part: &Node| evaluate(part, values);
    match node {
        // A rational beyond the range of doubles becomes infinite, which the check of the result finds.
        Node::Number(value) => value.to_f64().unwrap_or(f64::INFINITY).into(),
        Node::Pi => std::f64::consts::PI.into(),
        Node::Symbol(symbol) => values.get(symbol).copied().unwrap_or(Sym::Number(f64::NAN)),
        Node::Negative(inner) => -of(inner),
        Node::Quotient(above, below) => of(above) / of(below),
        Node::Product(factors) => factors
            .iter()
            .map(of)
            .reduce(|product, factor| product * factor)
            .unwrap_or(Sym::Number(1.0)),
        Node::Sum(terms) => terms
            .iter()
            .map(|(minus, term)| if *minus { -of(term) } else { of(term) })
            .sum(),
        Node::Call(function, arguments) => match (function, arguments.as_slice()) {
            (Function::Group, [inner]) => of(inner),
            (Function::Recip, [inner]) => Sym::Number(1.0) / of(inner),
            (Function::Pi, []) => std::f64::consts::PI.into(),
            (function, [argument]) => call(*function, of(argument)),
            (function, [first, second]) => call_two(*function, of(first), of(second)),
            _ => Sym::Number(f64::NAN),
        },
    }
}

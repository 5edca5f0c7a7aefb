//! The kernels of a joint from its expansion, in the order in which they are emitted.

use super::{Expansion, Flow, finite, general, hamel, implicit, ports, structure_constants};
use crate::diagnostic::Diagnostic;
use crate::domain::{Critical, Domain};
use crate::expr::Symbol;
use crate::kernel::{Kernel, KernelKind, Method, Step, Structure};
use crate::manifold::Ideal;
use crate::matrix::Matrix;
use crate::model::{ConfigurationSpace, Declared, Locus};
use crate::prepare::Prepared;
use crate::spec::code;

/// The kernels that belong to Q and v alone, of a joint that must stay away from `loci`; those of each body are apart.
pub fn kernels(
    joint: &Prepared,
    expansion: &Expansion,
    loci: &[Declared<Locus>],
) -> Result<Vec<Kernel>, Vec<Diagnostic>> {
    let maker = Maker {
        joint,
        loci,
        x: expansion,
        ideal: joint.space.manifold.ideal(),
    };
    let mut kernels = maker.velocity();
    kernels.extend(maker.nonholonomic());
    kernels.extend(maker.ports());
    kernels.extend(maker.pins());
    kernels.extend(maker.finite_maps()?);
    kernels.sort_by_key(|kernel| kernel.kind);
    Ok(kernels)
}

/// The kernels that are different for each body of a joint: H, X, X^c and ∂X^c/∂ϕ of the one that it carries.
pub fn of_body(joint: &Prepared, expansion: &Expansion) -> Vec<Kernel> {
    let pose = &joint.spec.pose.value;
    let child = &expansion.twist_map_child;
    let forbidden = expansion.forbidden.as_ref().map(|forbidden| {
        let along = vec![forbidden.twists.clone()];
        through(KernelKind::RelationTwists, along)
    });
    let own = vec![
        plain(
            KernelKind::Pose,
            vec![pose.rotation.clone(), pose.translation.clone()],
        ),
        plain(KernelKind::TwistMap, vec![expansion.twist_map.clone()]),
        plain(KernelKind::TwistMapChild, vec![child.clone()]),
        plain(
            KernelKind::TwistMapChildGradient,
            child_slopes(joint, expansion),
        ),
    ];
    own.into_iter().chain(forbidden).collect()
}

struct Maker<'a> {
    joint: &'a Prepared,
    loci: &'a [Declared<Locus>],
    x: &'a Expansion,
    ideal: &'a Ideal,
}

/// X̄^c = X^c S̄.
pub fn speed_map(joint: &Prepared, x: &Expansion) -> Matrix {
    let map = x.twist_map_child.times(&x.nonholonomic.speed_basis);
    joint.space.manifold.ideal().simplest_entries(&map)
}

/// ∂X^c/∂ϕ, by the chain rule: multiplied out, what the definition adds up before it divides would cancel.
fn child_slopes(joint: &Prepared, x: &Expansion) -> Vec<Matrix> {
    let slope = |k| x.motion.along_each(&x.twist_map_child, k);
    let ideal = joint.space.manifold.ideal();
    (0..x.shape.freedoms)
        .map(|k| ideal.simplest_entries(&slope(k)))
        .collect()
}

impl Maker<'_> {
    /// P and the values of the ports; nothing where there are none.
    fn ports(&self) -> Vec<Kernel> {
        let ports = &self.joint.spec.ports;
        if ports.is_empty() {
            return vec![];
        }
        vec![
            plain(KernelKind::PortMap, vec![self.x.port_map.clone()]),
            plain(KernelKind::PortValues, vec![ports::values(ports)]),
        ]
    }

    /// Where the pins are; nothing where there are none.
    fn pins(&self) -> Option<Kernel> {
        let has_pins = self.x.shape.pins > 0;
        has_pins.then(|| plain(KernelKind::Pins, vec![self.x.pins.clone()]))
    }

    fn short(&self, matrix: &Matrix) -> Matrix {
        self.ideal.simplest_entries(matrix)
    }

    fn velocity(&self) -> Vec<Kernel> {
        let s = &self.x.velocity_map;
        let velocity = Matrix::symbols(&self.x.arguments.velocity);
        let momentum = Matrix::symbols(&self.x.arguments.momentum);
        let inverse = &self.x.velocity_map_inverse;
        let home = self.joint.spec.home.as_ref().map(|home| home.value.clone());
        let home = Matrix::column_vector(home.unwrap_or_else(|| self.joint.space.manifold.home()));
        let mut home = plain(KernelKind::Home, vec![home]);
        if self.joint.spec.home_is_guess {
            home.method = Method::Newton;
        }
        vec![
            home,
            plain(KernelKind::VelocityMap, vec![s.base.clone()]),
            // Always a formula: adj S₀ / det S₀ exists, its sums are shared, and Γ, J22 and the rates are made of it. Where it is too
            // long for the bound on work, so are they, and det S₀ has no certificate: the spec is refused.
            plain(KernelKind::VelocityMapInverse, vec![inverse.clone()]),
            plain(KernelKind::VelocityMapGradient, s.slopes.clone()),
            plain(
                KernelKind::Gamma,
                vec![self.short(&hamel::gamma(s, inverse, &velocity))],
            ),
            plain(
                KernelKind::J22,
                vec![self.short(&hamel::j22(s, inverse, &momentum))],
            ),
        ]
    }

    fn nonholonomic(&self) -> Vec<Kernel> {
        let parts = &self.x.nonholonomic;
        vec![
            plain(KernelKind::Constraint, vec![parts.constraint.clone()]),
            plain(KernelKind::SpeedBasis, vec![parts.speed_basis.clone()]),
            plain(KernelKind::SpeedBasisGradient, parts.slopes.clone()),
        ]
    }

    fn finite_maps(&self) -> Result<Vec<Kernel>, Vec<Diagnostic>> {
        let moving = match (&self.x.flow, self.x.exponential) {
            (Some(flow), _) => self
                .implicit_maps(flow)
                .ok_or_else(|| vec![no_closed_form(self.joint)])?,
            (None, true) => self
                .exponential_maps()
                .ok_or_else(|| vec![no_closed_form(self.joint)])?,
            (None, false) => self.general_maps(),
        };
        Ok([moving, self.manifold_maps()].concat())
    }

    /// Φ = Q exp(ϕ): closed forms.
    fn exponential_maps(&self) -> Option<Vec<Kernel>> {
        let (joint, arguments) = (self.joint, &self.x.arguments);
        let (retract_steps, retract) = finite::retract(joint)?;
        let (local_steps, local) = finite::local(joint, &joint.space.manifold.target())?;
        let constants = &self.x.structure_constants;
        let (inverse_steps, inverse) =
            finite::retract_differential_inverse(joint, constants, &arguments.velocity)?;
        let structure = same_or_general(&inverse, &arguments.velocity);
        let (forward_steps, forward) = finite::retract_differential(joint, constants)?;
        let forward_structure = match forward.is_identity() {
            true => Structure::Identity,
            false => Structure::General,
        };
        Some(vec![
            with(
                KernelKind::Retract,
                retract_steps,
                retract,
                Structure::General,
            ),
            with(KernelKind::Local, local_steps, local, Structure::General),
            with(
                KernelKind::RetractDifferential,
                forward_steps,
                forward,
                forward_structure,
            ),
            with(
                KernelKind::RetractDifferentialInverse,
                inverse_steps,
                inverse,
                structure,
            ),
        ])
    }

    /// Any other Φ: as declared, the rest by the runtime's solvers.
    fn general_maps(&self) -> Vec<Kernel> {
        let retract = general::retract(self.joint)
            .map(|value| with(KernelKind::Retract, vec![], value, Structure::General));
        let solved = [
            (KernelKind::Local, Method::Newton),
            (KernelKind::RetractDifferential, Method::Solve),
            (KernelKind::RetractDifferentialInverse, Method::Solve),
        ];
        retract
            .into_iter()
            .chain(solved.map(|(kind, method)| by_runtime(kind, method)))
            .collect()
    }

    /// Φ on a manifold of relations alone: by Newton's method, from closed forms of Q exp(ξ).
    fn implicit_maps(&self, flow: &Flow) -> Option<Vec<Kernel>> {
        let free = implicit::freely(self.joint);
        let (steps, displaced) = finite::retract(&free)?;
        let displaced = with(KernelKind::Displaced, steps, displaced, Structure::General);
        let (steps, displacement) = finite::local(&free, &free.space.manifold.target())?;
        let displacement = with(
            KernelKind::Displacement,
            steps,
            displacement,
            Structure::General,
        );
        let (steps, differential) =
            finite::retract_differential(&free, &structure_constants(&free))?;
        let differential = (!differential.is_identity()).then(|| {
            let kind = KernelKind::DisplacedDifferential;
            with(kind, steps, differential, Structure::General)
        });
        let bases = [
            plain(KernelKind::TangentBasis, vec![flow.tangent.clone()]),
            plain(KernelKind::NormalBasis, vec![flow.normal.clone()]),
            plain(KernelKind::RelationGradient, vec![flow.gradient.clone()]),
            displaced,
            displacement,
            by_runtime(KernelKind::Retract, Method::Newton),
            by_runtime(KernelKind::Local, Method::Solve),
            by_runtime(KernelKind::RelationDisplacements, Method::Solve),
        ];
        let ports = self.x.forbidden.as_ref().filter(|_| self.x.shape.ports > 0);
        let ports = ports
            .map(|forbidden| through(KernelKind::RelationPorts, vec![forbidden.ports.clone()]));
        let all = bases.into_iter().chain(differential).chain(ports);
        Some(all.chain(self.implicit_differentials(flow)).collect())
    }

    /// D and D⁻¹ where relations alone give Φ.
    fn implicit_differentials(&self, flow: &Flow) -> [Kernel; 2] {
        let rate = Matrix::symbols(&self.x.arguments.velocity);
        let identities = [
            (
                KernelKind::RetractDifferential,
                Matrix::identity(rate.rows()),
            ),
            (KernelKind::RetractDifferentialInverse, rate),
        ];
        identities.map(|(kind, identity)| match flow.adds {
            true => with(kind, vec![], identity, Structure::Identity),
            false => by_runtime(kind, Method::Solve),
        })
    }

    /// Projection and residual; Newton's method where the spec declares relations.
    fn manifold_maps(&self) -> Vec<Kernel> {
        let joint = self.joint;
        let (steps, start) = finite::project(joint);
        let relations = general::relations(joint);
        let structure = match relations {
            None => same_or_general(&start, &self.x.arguments.configuration),
            Some(_) => Structure::General,
        };
        let mut project = with(KernelKind::Project, steps, start, structure);
        let rate = plain(
            KernelKind::ConfigurationRate,
            vec![self.configuration_rate()],
        );
        let residual = plain(KernelKind::Residual, vec![finite::residual(joint)]);
        let singular = match self.loci.is_empty() {
            true => Structure::Constant,
            false => Structure::General,
        };
        let mut singular = with(
            KernelKind::Singularity,
            vec![],
            singular_functions(self.loci),
            singular,
        );
        singular.outputs.extend(side_of_home(joint, self.loci));
        let Some(relations) = relations else {
            return vec![rate, project, residual, singular];
        };
        project.method = Method::Newton;
        let relations = plain(KernelKind::Relations, vec![relations]);
        vec![rate, project, residual, singular, relations]
    }

    /// `Q̇ = Σ_k δ_k (S₀⁻¹ v)_k`, (31).
    fn configuration_rate(&self) -> Matrix {
        let rates = self
            .x
            .velocity_map_inverse
            .times(&Matrix::symbols(&self.x.arguments.velocity));
        self.short(&self.x.motion.tangent().times(&rates))
    }
}

/// The functions whose zeros the joint must stay away from: a column, empty for a joint that is global.
fn singular_functions(loci: &[Declared<Locus>]) -> Matrix {
    let functions = loci.iter().map(|locus| locus.value.function.clone());
    Matrix::column_vector(functions.collect())
}

/// What is positive on the side of home of the loci, where functions of the joint have no value on the other.
fn side_of_home(joint: &Prepared, loci: &[Declared<Locus>]) -> Option<Matrix> {
    if loci.is_empty() {
        return None;
    }
    let space = ConfigurationSpace {
        loci: loci.to_vec(),
        ..joint.space.clone()
    };
    let mut functions = joint.critical();
    let loci = loci.iter().map(|locus| &locus.value.function);
    loci.for_each(|function| Critical::collect(function, &[], &mut functions));
    let sides = Domain::new(&space).sides(&functions);
    (!sides.is_empty()).then(|| Matrix::column_vector(sides))
}

/// A kernel without intermediate lines.
fn plain(kind: KernelKind, outputs: Vec<Matrix>) -> Kernel {
    let structure = Structure::of(&outputs);
    Kernel {
        kind,
        steps: vec![],
        outputs,
        method: Method::Formula,
        structure,
    }
}

/// A kernel that the runtime evaluates from others.
fn by_runtime(kind: KernelKind, method: Method) -> Kernel {
    Kernel {
        kind,
        steps: vec![],
        outputs: vec![],
        method,
        structure: Structure::General,
    }
}

/// A kernel that is a matrix of formulas times the displacements at which relations change.
fn through(kind: KernelKind, outputs: Vec<Matrix>) -> Kernel {
    Kernel {
        outputs,
        ..by_runtime(kind, Method::Solve)
    }
}

fn same_or_general(value: &Matrix, argument: &[Symbol]) -> Structure {
    match *value == Matrix::symbols(argument) {
        true => Structure::Identity,
        false => Structure::General,
    }
}

fn with(kind: KernelKind, steps: Vec<Step>, output: Matrix, structure: Structure) -> Kernel {
    Kernel {
        kind,
        steps,
        outputs: vec![output],
        method: Method::Formula,
        structure,
    }
}

fn no_closed_form(joint: &Prepared) -> Diagnostic {
    Diagnostic::new(
        code::NO_CLOSED_FORM,
        joint.spec.freedoms.span.clone(),
        "exp of this basis has no closed form that the generator knows",
    )
    .label("Φ = Q exp(ϕ) cannot be emitted")
    .help("use a basis of a known algebra: r1 … r6, so2, se2, so3, se3")
}

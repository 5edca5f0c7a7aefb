//! What each statement of a spec says of units.

use super::system::Form;
use super::{Analysis, Asked, Blame, Role};
use crate::expr::{Expr, Rational};
use crate::manifold::{Factor, Kind};
use crate::matrix::Matrix;
use crate::model::{Implicit, PortValue, PoseExpr, VelocityFrame};
use crate::units::Dimension;
use std::ops::Range;

fn length() -> Form {
    Form::known(Dimension::length())
}

impl Analysis<'_> {
    /// All equations, and the units that are asked for.
    pub(super) fn declarations(&mut self) -> Asked {
        let coordinates = self.coordinates();
        self.poses();
        self.calls();
        let relations = self.relations();
        self.conditions();
        self.home(&coordinates);
        let freedoms = self.freedoms(&coordinates, &relations);
        self.retract(&coordinates);
        let velocities = self.velocities(&freedoms);
        let speeds = self.speeds(&velocities);
        self.ports();
        self.pins();
        Asked {
            coordinates,
            freedoms,
            velocities,
            speeds,
            relations,
        }
    }

    /// Real coordinates are looked for; of groups all but displacements are numbers.
    fn coordinates(&mut self) -> Vec<Form> {
        let spec = self.spec;
        let mut all = vec![];
        for factor in spec.manifold.value.factors() {
            for symbol in &factor.coordinates {
                let unit = match factor.kind {
                    Kind::Real(_) => self.new_unknown(),
                    _ if factor.is_free(symbol) => length(),
                    _ => Form::default(),
                };
                match factor.is_free(symbol) {
                    true => self.quantity(symbol, unit.clone()),
                    false => _ = self.symbols.insert(symbol.clone(), unit.clone()),
                }
                all.push(unit);
            }
        }
        all
    }

    fn poses(&mut self) {
        let spec = self.spec;
        for (number, pose) in spec.poses().enumerate() {
            let name = match spec.bodies.get(number) {
                Some(body) => format!("H.{body}"),
                None => "H".to_owned(),
            };
            self.pose(&name, &pose.value, &pose.span);
        }
    }

    fn pose(&mut self, name: &str, pose: &PoseExpr, span: &Range<usize>) {
        let rotation = Blame::new(format!("the rotation of {name}"), span).of(Role::Rotation);
        for entry in pose.rotation.entries() {
            self.fixed(&rotation, entry, &Form::default());
        }
        for (entry, axis) in pose.translation.entries().iter().zip(["x", "y", "z"]) {
            let blame = Blame::new(format!("the {axis} of {name}"), span).of(Role::Length);
            self.fixed(&blame, entry, &length());
        }
    }

    /// Arguments of curves.
    fn calls(&mut self) {
        let spec = self.spec;
        for call in &spec.calls {
            let (curve, argument) = &call.value;
            let mut declared = spec.curves.iter();
            let Some(declared) = declared.find(|declared| declared.curve == *curve) else {
                continue;
            };
            let unit = Form::known(Dimension::parsed(&declared.units[0]));
            let blame = Blame::new(
                format!("the argument of the curve `{}`", curve.name()),
                &call.span,
            );
            let before = self.equations.len();
            self.fixed(&blame, argument, &unit);
            if declared.units[0] == "1" {
                // As a number that the spec writes, it may stand for a quantity.
                let own = self.equations.iter_mut().skip(before);
                own.for_each(|equation| equation.is_strict = false);
            }
        }
    }

    fn relations(&mut self) -> Vec<Form> {
        let spec = self.spec;
        let declared = spec.manifold.value.declared().iter();
        let spans = spec.relation_spans.iter();
        let relations = declared.zip(spans);
        relations
            .map(|(relation, span)| self.alike(&Blame::new("a relation", span), relation))
            .collect()
    }

    fn conditions(&mut self) {
        let spec = self.spec;
        for locus in &spec.loci {
            let blame = Blame::new("an exception", &locus.span).of(Role::Condition);
            self.alike(&blame, &locus.value.function);
        }
        for requirement in &spec.requirements {
            let blame = Blame::new("a requirement", &requirement.span).of(Role::Condition);
            self.alike(&blame, &requirement.value.value);
        }
    }

    fn home(&mut self, coordinates: &[Form]) {
        let spec = self.spec;
        if let Some(home) = &spec.home {
            let blame = Blame::new("home", &home.span);
            self.entries(&blame, &home.value, coordinates);
        }
    }

    fn retract(&mut self, coordinates: &[Form]) {
        let spec = self.spec;
        if let Some(retract) = &spec.retract {
            let blame = Blame::new("Phi", &retract.span);
            self.entries(&blame, &retract.value, coordinates);
        }
    }

    /// Stored scalars, each with the unit of its coordinate.
    fn entries(&mut self, blame: &Blame, scalars: &[Expr], coordinates: &[Form]) {
        let names = self.spec.manifold.value.coordinates();
        for ((scalar, unit), name) in scalars.iter().zip(coordinates).zip(names) {
            let element = format!("`{}` in {}", name.spelling(), blame.element);
            self.fixed(&Blame::new(element, &blame.span), scalar, unit);
        }
    }

    /// ϕ: what moves Q along a generator by a unit of it.
    fn freedoms(&mut self, coordinates: &[Form], relations: &[Form]) -> Vec<Form> {
        let spec = self.spec;
        let along = match &spec.implicit {
            Some(Implicit::CrossProduct) => {
                return vec![self.cross_product(coordinates, relations)];
            }
            Some(Implicit::Independent(directions)) => Some(directions),
            None => None,
        };
        let mut all = vec![];
        for (k, freedom) in spec.freedoms.value.iter().enumerate() {
            let (factor, generator) = match along.and_then(|along| along.get(k)) {
                Some((factor, generator)) => (*factor, generator),
                None => (freedom.factor, &freedom.generator),
            };
            let displacements = self.displacements(factor, coordinates);
            let unit = self.along(&freedom.name, generator, &displacements);
            self.quantity(&freedom.local, unit.clone());
            all.push(unit);
        }
        all
    }

    /// That of a coordinate along a generator: of the displacement itself where it is one of the standard basis.
    fn along(&mut self, name: &str, generator: &[Expr], displacements: &[Form]) -> Form {
        let entries = generator.iter().zip(displacements);
        let mut moved = entries.filter(|(entry, _)| !entry.is_zero());
        if let (Some((one, displacement)), None) = (moved.next(), moved.next())
            && one.is_one()
        {
            return displacement.clone();
        }
        let unit = self.new_unknown();
        let span = &self.spec.freedoms.span;
        let blame = Blame::new(format!("the direction `{name}`"), span);
        for (entry, displacement) in generator.iter().zip(displacements) {
            self.fixed(&blame, entry, &displacement.over(&unit));
        }
        unit
    }

    /// The units of displacements of a factor, along the standard basis of its algebra.
    fn displacements(&self, factor: usize, coordinates: &[Form]) -> Vec<Form> {
        let factors = self.spec.manifold.value.factors();
        let before = factors
            .iter()
            .take(factor)
            .map(|factor| factor.coordinates.len());
        let first: usize = before.sum();
        let (turns, slides) = match factors.get(factor).map(|factor: &Factor| factor.kind) {
            Some(Kind::Real(size)) => return coordinates[first..first + size].to_vec(),
            Some(Kind::Se2) => (1, 2),
            Some(Kind::Se3) => (3, 3),
            Some(kind) => (kind.dimension(), 0),
            None => (0, 0),
        };
        let angle = Form::known(Dimension::angle());
        [vec![angle; turns], vec![length(); slides]].concat()
    }

    /// Of the parameter along the generalised cross product of the relations' derivatives: a displacement is that times the product of all relations by all
    /// other displacements.
    fn cross_product(&mut self, coordinates: &[Form], relations: &[Form]) -> Form {
        let mut unit = Form::default();
        for factor in 0..self.spec.manifold.value.factors().len() {
            for displacement in self.displacements(factor, coordinates) {
                unit.multiply(&displacement, &Rational::from(1));
            }
        }
        for relation in relations {
            unit.multiply(relation, &Rational::from(-1));
        }
        for freedom in &self.spec.freedoms.value {
            self.quantity(&freedom.local, unit.clone());
        }
        unit
    }

    /// What v are the rates of: ϕ, or what a declared X makes of them.
    fn velocities(&mut self, freedoms: &[Form]) -> Vec<Form> {
        let spec = self.spec;
        let Some(twist_map) = &spec.twist_map else {
            return freedoms.to_vec();
        };
        let velocities: Vec<Form> = match spec.velocity.value {
            VelocityFrame::Rates => freedoms.iter().map(|_| self.new_unknown()).collect(),
            _ => freedoms.to_vec(),
        };
        let blame = Blame::new("X", &twist_map.span);
        let twist = |row: usize| match row % 6 {
            0..3 => Form::known(Dimension::angle()),
            _ => length(),
        };
        self.matrix(&blame, &twist_map.value, |i, k| {
            twist(i).over(&velocities[k])
        });
        velocities
    }

    /// What the speeds are the rates of, by S̄; A is checked beside it.
    fn speeds(&mut self, velocities: &[Form]) -> Vec<Form> {
        let spec = self.spec;
        if let Some(constraint) = &spec.constraint {
            let columns = constraint.value.columns();
            let scales: Vec<Form> = (0..columns).map(|_| self.new_unknown()).collect();
            let blame = Blame::new("A", &constraint.span);
            self.matrix(&blame, &constraint.value, |i, k| {
                scales[k].over(&velocities[i])
            });
        }
        let Some(speed_basis) = &spec.speed_basis else {
            return vec![];
        };
        let columns = speed_basis.value.columns();
        let speeds: Vec<Form> = (0..columns).map(|_| self.new_unknown()).collect();
        let blame = Blame::new("S_bar", &speed_basis.span);
        self.matrix(&blame, &speed_basis.value, |i, j| {
            velocities[i].over(&speeds[j])
        });
        speeds
    }

    fn matrix(&mut self, blame: &Blame, matrix: &Matrix, unit: impl Fn(usize, usize) -> Form) {
        for i in 0..matrix.rows() {
            for k in 0..matrix.columns() {
                let element = format!("entry ({}, {}) of {}", i + 1, k + 1, blame.element);
                let blame = Blame::new(element, &blame.span);
                self.fixed(&blame, matrix.at(i, k), &unit(i, k));
            }
        }
    }

    fn ports(&mut self) {
        let spec = self.spec;
        for port in &spec.ports {
            let blame = Blame::new(format!("port `{}`", port.value.name), &port.span);
            match &port.value.value {
                PortValue::Scalar(value) => {
                    let unit = Form::known(Dimension::parsed(&port.value.unit));
                    self.fixed(&blame, value, &unit);
                }
                PortValue::Angle { cos, sin } => {
                    self.fixed(&blame, cos, &Form::default());
                    self.fixed(&blame, sin, &Form::default());
                }
            }
        }
    }

    fn pins(&mut self) {
        let spec = self.spec;
        for pin in &spec.pins {
            let blame = Blame::new(format!("a point of pin `{}`", pin.value.name), &pin.span);
            for entry in pin.value.entries() {
                self.fixed(&blame, entry, &length());
            }
        }
    }
}

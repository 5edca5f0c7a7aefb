//! Columns of joints: coordinates, speeds, and what a controller exerts.

use super::{Columns, Ending, List};
use hamel::joint::{Port, Unit, Units};
use hamel::mechanism::{Body, Mechanism};
use hamel_sweep::columns::{Angle, Factor, Turn, port_rate, velocity};
use hamel_sweep::columns::{coordinate_endings, speed_endings, turns};

impl<'a> Columns<'a> {
    /// Coordinates and speeds of all joints.
    pub(super) fn joints(&mut self, mechanism: &'a Mechanism, tells_forces: bool) {
        for (index, body) in mechanism.joints() {
            let units = body.joint().units();
            self.enter(Some(List::Joints), body.joint_name());
            self.coordinates(index, body, &units);
            let speeds = body.ranges().speeds.clone();
            self.add("v", speed_endings(body, &units), move |moment, row| {
                row.extend(&moment.speeds[speeds.clone()]);
            });
            if !body.joint().ports().is_empty() {
                self.ports(index, body);
            }
            if tells_forces {
                self.forces(index, body);
            }
        }
    }

    /// Values and rates of a joint's ports.
    fn ports(&mut self, index: usize, body: &'a Body) {
        let ports = body.joint().ports();
        let first = self.turns.len();
        let wrapping = ports.iter().enumerate().filter(|(_, port)| port.wraps);
        self.turns.extend(wrapping.map(|(port, _)| Turn {
            body: index,
            angle: Angle::Port(port),
        }));
        let values = ports.iter().map(|port| Ending {
            name: format!("port.{}", port.name),
            unit: port.unit,
            meaning: String::from(match port.wraps {
                true => "angle of the port, not reduced to a turn",
                false => "value of the port",
            }),
        });
        self.add("port", values.collect(), move |moment, row| {
            let q = body.configuration(moment.configuration);
            let mut angles = moment.angles[first..].iter();
            for (place, port) in ports.iter().enumerate() {
                let angle = port.wraps.then(|| angles.next().copied());
                let value = angle.map(|angle| angle.unwrap_or(f64::NAN));
                row.push(value.unwrap_or_else(|| body.joint().port_value(q, place)));
            }
        });
        let rates = ports.iter().map(|port| Ending {
            name: format!("rate.{}", port.name),
            unit: unit(port).rate,
            meaning: String::from("rate of the port"),
        });
        let speeds = body.ranges().speeds.clone();
        self.add("rate", rates.collect(), move |moment, row| {
            let q = body.configuration(moment.configuration);
            let v = velocity(body, q, &moment.speeds[speeds.clone()]);
            row.extend((0..ports.len()).map(|port| port_rate(body, q, &v, port)));
        });
    }

    /// τ of all joints.
    pub(super) fn efforts(&mut self, mechanism: &'a Mechanism) {
        for (_, body) in mechanism.joints() {
            let units = body.joint().units();
            self.enter(Some(List::Efforts), body.joint_name());
            let freedoms = body.ranges().freedoms.clone();
            self.add("tau", effort_endings(body, &units), move |moment, row| {
                row.extend(&moment.efforts[freedoms.clone()]);
            });
        }
    }

    fn coordinates(&mut self, index: usize, body: &'a Body, units: &Units) {
        let factors = Factor::all(body.joint());
        let endings = coordinate_endings(&factors, units);
        let first = self.turns.len();
        self.turns.extend(turns(index, &factors));
        self.add("q", endings, move |moment, row| {
            let q = body.configuration(moment.configuration);
            let mut angles = moment.angles[first..].iter();
            for factor in &factors {
                let angle = factor.kind.turn().and_then(|_| angles.next());
                factor.read(q, angle.copied().unwrap_or(f64::NAN), row);
            }
        });
    }
}

fn unit(port: &Port) -> Unit {
    match port.unit {
        "rad" => Unit::ANGLE,
        "m" => Unit::LENGTH,
        _ => Unit::UNKNOWN,
    }
}

fn effort_endings(body: &Body, units: &Units) -> Vec<Ending> {
    let freedoms = body.joint().freedoms().iter().enumerate();
    let endings = freedoms.map(|(place, name)| Ending {
        name: format!("tau.{name}"),
        unit: units.velocity(place).effort,
        meaning: String::from("effort of the controller"),
    });
    endings.collect()
}

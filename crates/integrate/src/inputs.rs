//! The efforts that a caller gives: as functions of time and state, and as they are held between two readings of the state.

use alloc::vec::Vec;
use hamel_runtime::dynamics::EffortAtPort;
use hamel_runtime::mechanism::Mechanism;

/// Efforts τ (one entry per degree of freedom) from time, q and v̄; entries are zero when it is called.
pub type Inputs<'a> = dyn FnMut(f64, &[f64], &[f64], &mut [f64]) + 'a;

/// Functions of time, q and v̄ at whose zeros inputs bend, as at the limit of an effort, pushed onto a list that is empty when it is called: as many at all
/// times, each continuous.
pub type InputBends<'a> = dyn FnMut(f64, &[f64], &[f64], &mut Vec<f64>) + 'a;

/// What of the inputs acts at ports of joints, from time, q and v̄, pushed onto a list that is empty when it is called.
pub type PortInputs<'a> = dyn FnMut(f64, &[f64], &[f64], &mut Vec<EffortAtPort>) + 'a;

/// Inputs that are held while the mechanism moves on.
///
/// An effort at a port is held there: what it amounts to on v̄ follows the configuration. All other efforts stay as they are.
#[derive(Clone, Debug, Default)]
pub struct HeldInputs {
    /// τ without what acts at ports.
    efforts: Vec<f64>,
    at_ports: Vec<EffortAtPort>,
}

impl HeldInputs {
    /// Holds `efforts`, τ at the configuration `q`, of which `at_ports` act at ports.
    #[must_use]
    pub fn new(
        mechanism: &Mechanism,
        q: &[f64],
        mut efforts: Vec<f64>,
        at_ports: Vec<EffortAtPort>,
    ) -> Self {
        let opposite: Vec<_> = at_ports.iter().map(EffortAtPort::reversed).collect();
        mechanism.add_efforts_at_ports(q, &opposite, &mut efforts);
        Self { efforts, at_ports }
    }

    /// τ at the configuration `q`, in place of `efforts`.
    pub fn efforts_at(&self, mechanism: &Mechanism, q: &[f64], efforts: &mut [f64]) {
        efforts.copy_from_slice(&self.efforts);
        mechanism.add_efforts_at_ports(q, &self.at_ports, efforts);
    }

    /// What is held at ports.
    #[must_use]
    pub fn at_ports(&self) -> &[EffortAtPort] {
        &self.at_ports
    }
}

/// An instant for new inputs that is nearer to a sample than this part of the period falls on it: the rest is rounding.
const SAME_INSTANT: f64 = 1e-9;

/// When inputs that are held are taken anew.
pub(super) struct Hold {
    start: f64,
    period: f64,
    /// How many times they have been.
    count: u64,
}

impl Hold {
    /// They have just been taken, for the first time.
    pub(super) const fn new(start: f64, period: f64) -> Self {
        let count = 1;
        Self {
            start,
            period,
            count,
        }
    }

    /// They have been taken once more.
    pub(super) const fn pass(&mut self) {
        self.count += 1;
    }

    /// The next instant.
    pub(super) fn next(&self) -> f64 {
        self.start + self.period * self.count as f64
    }

    /// Whether the next instant is `time`, up to rounding.
    pub(super) fn falls_on(&self, time: f64) -> bool {
        (self.next() - time).abs() <= SAME_INSTANT * self.period
    }
}

/// What is given of inputs.
#[derive(Default)]
pub(super) struct Given<'a> {
    /// Their efforts; `None` where there are none.
    pub(super) inputs: Option<&'a mut Inputs<'a>>,
    /// Where they bend, if they say so.
    pub(super) bends: Option<&'a mut InputBends<'a>>,
    /// What of them acts at ports, if they say so.
    pub(super) at_ports: Option<&'a mut PortInputs<'a>>,
}

impl Given<'_> {
    /// τ at a time, `q` and v̄, in place of `efforts`.
    pub(super) fn fill(&mut self, time: f64, q: &[f64], speeds: &[f64], efforts: &mut [f64]) {
        efforts.fill(0.0);
        if let Some(inputs) = &mut self.inputs {
            inputs(time, q, speeds, efforts);
        }
    }

    /// What acts at ports at a time, `q` and v̄.
    pub(super) fn at_ports(&mut self, time: f64, q: &[f64], speeds: &[f64]) -> Vec<EffortAtPort> {
        let mut efforts = Vec::new();
        if let Some(at_ports) = &mut self.at_ports {
            at_ports(time, q, speeds, &mut efforts);
        }
        efforts
    }
}

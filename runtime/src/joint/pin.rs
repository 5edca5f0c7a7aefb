//! Pins of joints: points at which bodies of a joint hold each other.

/// A point at which two bodies of a joint hold each other, or a body and the frame that the joint hangs on.
///
/// What the second exerts on the first there is a force across the axis along which it slides, if it does; and a moment: none where it turns freely, across
/// the axis where it turns about one, else any. It does no work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin {
    /// Its name, unique in its joint.
    pub name: &'static str,
    /// The places of both among [`Joint::BODIES`](super::Joint::BODIES); `None` for the frame that the joint hangs on.
    pub bodies: [Option<usize>; 2],
    /// How the first turns relative to the second.
    pub turning: Turning,
    /// Whether it slides along an axis.
    pub slides: bool,
    /// The efforts that act there.
    pub drives: &'static [PinDrive],
}

/// How a body turns relative to another at a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// In every way.
    Freely,
    /// About one axis.
    AboutAxis,
    /// Not at all.
    Not,
}

/// An effort that acts at a pin, of the second body on the first: a couple about its axis of turning, or a force along its axis of sliding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PinDrive {
    /// Which effort.
    pub source: DriveSource,
    /// Whether it is a couple, else a force.
    pub turns: bool,
    /// Whether it acts against the axis.
    pub reversed: bool,
}

/// An effort on a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveSource {
    /// On the degree of freedom of this number.
    Freedom(usize),
    /// At the port of this number.
    Port(usize),
}

impl Pin {
    /// Whether an effort acts there.
    pub fn is_driven_by(&self, source: DriveSource) -> bool {
        self.drives.iter().any(|drive| drive.source == source)
    }
}

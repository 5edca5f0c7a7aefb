//! Instants at which a function of the state crosses zero.

use super::State;
use alloc::boxed::Box;
use alloc::string::String;
use core::fmt::{Debug, Formatter};

/// Time, q and v̄ of all joints to a number that is positive on one side and negative on the other.
pub(super) type Function<'a> = dyn FnMut(f64, &[f64], &[f64]) -> f64 + 'a;

/// Time, q and v̄ of all joints to whether a crossing there counts.
pub(super) type Condition<'a> = dyn FnMut(f64, &[f64], &[f64]) -> bool + 'a;

/// Which crossings count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
    /// Both.
    #[default]
    Any,
}

/// A function g(t, q, v̄) whose zeros are wanted, where it changes its sign.
///
/// It must be continuous along the motion. It is evaluated at the initial state, at both ends of every step and at three points between them, so that two opposite crossings within a quarter of a step may both be missed. Touching zero without a change of sign is no event, and no jump of the speeds at an impact. A state at
/// which g is exactly 0 belongs to neither side: a motion that starts there crosses nothing.
pub struct Event<'a> {
    pub(super) name: String,
    pub(super) function: Box<Function<'a>>,
    pub(super) condition: Option<Box<Condition<'a>>>,
    pub(super) direction: Direction,
    pub(super) stops: bool,
}

impl<'a> Event<'a> {
    /// Crossings in both directions, that are recorded and nothing else.
    pub fn new(
        name: impl Into<String>,
        function: impl FnMut(f64, &[f64], &[f64]) -> f64 + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            function: Box::new(function),
            condition: None,
            direction: Direction::Any,
            stops: false,
        }
    }

    /// The same event for one integration, after which it can be asked for again.
    pub fn by_ref(&mut self) -> Event<'_> {
        let function = &mut self.function;
        let condition = self.condition.as_mut();
        let condition = condition.map(|condition| -> Box<Condition<'_>> {
            Box::new(|time, q, speeds| condition(time, q, speeds))
        });
        Event {
            name: self.name.clone(),
            function: Box::new(|time, q, speeds| function(time, q, speeds)),
            condition,
            direction: self.direction,
            stops: self.stops,
        }
    }

    /// Only crossings at states where the condition holds: of an angle up to whole turns, whose sine is 0 on the other side of the circle as well.
    #[must_use]
    pub fn provided(mut self, condition: impl FnMut(f64, &[f64], &[f64]) -> bool + 'a) -> Self {
        self.condition = Some(Box::new(condition));
        self
    }

    /// Only crossings in that direction.
    #[must_use]
    pub const fn towards(mut self, direction: Direction) -> Self {
        self.direction = direction;
        self
    }

    /// Only crossings from negative to positive.
    #[must_use]
    pub const fn rising(self) -> Self {
        self.towards(Direction::Rising)
    }

    /// Only crossings from positive to negative.
    #[must_use]
    pub const fn falling(self) -> Self {
        self.towards(Direction::Falling)
    }

    /// The first of them ends the integration.
    #[must_use]
    pub const fn stopping(mut self) -> Self {
        self.stops = true;
        self
    }
}

impl Debug for Event<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Event")
            .field("name", &self.name)
            .field("direction", &self.direction)
            .field("stops", &self.stops)
            .finish_non_exhaustive()
    }
}

/// What became of an event.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// Which event, in the order in which they were given; their number for what a joint does.
    pub event: usize,
    /// The body whose joint hits a limit, or begins or ceases to stick; `None` for events that were given.
    pub joint: Option<usize>,
    /// Its name.
    pub name: String,
    /// Whether the function rises there; of a joint, whether it moves towards larger coordinates, before it where it is at rest after it.
    pub rising: bool,
    /// The state, at the first time at which the function is known to be on the other side: the zero, up to the rounding of time. It lies on the dense
    /// output, and has its accuracy. After an impact, with the speeds that it leaves.
    pub state: State,
}

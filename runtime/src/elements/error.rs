//! Why an element does not fit its mechanism.

use crate::mechanism::Mechanism;
use crate::shown::Number;
use crate::time_function::TimeFunction;
use alloc::string::String;

/// Why an element does not fit its mechanism.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ElementError {
    /// No body has that index.
    #[error("{element}: there is no body of index {index}, the mechanism has {count}")]
    UnknownBody {
        /// The element.
        element: String,
        /// The index given.
        index: usize,
        /// How many bodies there are.
        count: usize,
    },
    /// A value out of range.
    #[error("{element}: {quantity} is {value}, it must be {requirement}", value = Number(*.value))]
    Value {
        /// The element.
        element: String,
        /// Which value.
        quantity: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        requirement: &'static str,
    },
    /// A vector or matrix of the wrong size.
    #[error("{element}: {quantity} has {found} entries, it must have {expected}")]
    Size {
        /// The element.
        element: String,
        /// Which vector.
        quantity: &'static str,
        /// Size it must have.
        expected: usize,
        /// Size given.
        found: usize,
    },
    /// A prescribed speed that jumps.
    #[error("{element}: {what} jumps, and a prescribed speed must have a derivative")]
    Jump {
        /// The element.
        element: String,
        /// What jumps.
        what: &'static str,
    },
    /// The joint has no port of that index.
    #[error("{element}: joint `{joint}` has no port of index {index}, it has {count}")]
    UnknownPort {
        /// The element.
        element: String,
        /// The joint.
        joint: String,
        /// The index given.
        index: usize,
        /// How many ports it has.
        count: usize,
    },
    /// The joint is of a kind that the element is not defined for.
    #[error("{element}: joint `{joint}` {reason}")]
    Joint {
        /// The element.
        element: String,
        /// The joint.
        joint: String,
        /// What stands against it.
        reason: &'static str,
    },
}

/// Whether there are as many functions as there must be, with numbers that are finite.
pub(super) fn functions(
    element: &str,
    quantity: &'static str,
    functions: &[TimeFunction],
    expected: usize,
) -> Result<(), ElementError> {
    if functions.len() != expected {
        return Err(ElementError::Size {
            element: element.into(),
            quantity,
            expected,
            found: functions.len(),
        });
    }
    match functions.iter().find_map(TimeFunction::infinite_number) {
        None => Ok(()),
        Some(value) => Err(ElementError::Value {
            element: element.into(),
            quantity,
            value,
            requirement: "finite",
        }),
    }
}

/// The body, if there is one of that index.
pub(super) fn body<'a>(
    element: &str,
    mechanism: &'a Mechanism,
    index: usize,
) -> Result<&'a crate::mechanism::Body, ElementError> {
    let count = mechanism.bodies().len();
    mechanism
        .bodies()
        .get(index)
        .ok_or_else(|| ElementError::UnknownBody {
            element: element.into(),
            index,
            count,
        })
}

/// Whether a slice has the size that it must have, and every value is finite and, where asked, not negative.
pub(crate) fn values(
    element: &str,
    quantity: &'static str,
    values: &[f64],
    expected: usize,
    negative: bool,
) -> Result<(), ElementError> {
    if values.len() != expected {
        return Err(ElementError::Size {
            element: element.into(),
            quantity,
            expected,
            found: values.len(),
        });
    }
    let requirement = match negative {
        true => "finite",
        false => "finite and not negative",
    };
    let allowed = |value: f64| value.is_finite() && (negative || value >= 0.0);
    match values.iter().find(|value| !allowed(**value)) {
        None => Ok(()),
        Some(&value) => Err(ElementError::Value {
            element: element.into(),
            quantity,
            value,
            requirement,
        }),
    }
}

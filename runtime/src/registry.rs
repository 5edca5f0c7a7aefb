//! Joint types by name: what a scene file can ask for.

use crate::erased::AnyJoint;
use alloc::collections::BTreeMap;
use alloc::sync::Arc;

/// Builds a joint from the values of its parameters, in the order of [`JointEntry::parameters`].
pub type BuildJoint = fn(&[f64]) -> Result<Arc<dyn AnyJoint>, ParameterError>;

/// A parameter of a joint type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterInfo {
    /// Its name in the spec.
    pub name: &'static str,
    /// Its unit, such as `m` or `m/rad`.
    pub unit: &'static str,
    /// What it means, in a sentence.
    pub description: &'static str,
}

/// A joint type that can be asked for by name.
#[derive(Clone, Copy, Debug)]
pub struct JointEntry {
    /// Name of the spec.
    pub name: &'static str,
    /// One line on what the joint does.
    pub summary: &'static str,
    /// Its parameters, in order.
    pub parameters: &'static [ParameterInfo],
    /// Builds a joint of this type.
    pub build: BuildJoint,
}

/// Why a joint cannot be built from the values given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// Too few or too many values.
    #[error("joint type `{joint}` takes {expected} parameter(s), not {found}")]
    Count {
        /// Joint type.
        joint: &'static str,
        /// How many it takes.
        expected: usize,
        /// How many were given.
        found: usize,
    },
    /// A value is NaN or infinite.
    #[error("parameter `{parameter}` of joint type `{joint}` is {value}, not a finite number")]
    NotFinite {
        /// Joint type.
        joint: &'static str,
        /// Parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// A value lies outside what the spec allows.
    #[error("parameter `{parameter}` of joint type `{joint}` is {value}: it must be {requirement}")]
    OutOfRange {
        /// Joint type.
        joint: &'static str,
        /// Parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed, such as `positive`.
        requirement: &'static str,
    },
}

/// Why an entry cannot be added to a registry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a joint type of the name `{name}` is already registered")]
pub struct DuplicateJoint {
    /// The name given twice.
    pub name: &'static str,
}

/// The parameters as an array, when there are `P` of them and all are finite: how generated `build` functions begin.
///
/// # Errors
/// A wrong number of values, or one that is NaN or infinite.
pub fn check_parameters<const P: usize>(
    joint: &'static str,
    parameters: &[ParameterInfo; P],
    values: &[f64],
) -> Result<[f64; P], ParameterError> {
    let array = <[f64; P]>::try_from(values).map_err(|_| ParameterError::Count {
        joint,
        expected: P,
        found: values.len(),
    })?;
    match parameters
        .iter()
        .zip(array)
        .find(|(_, value)| !value.is_finite())
    {
        Some((info, value)) => Err(ParameterError::NotFinite {
            joint,
            parameter: info.name,
            value,
        }),
        None => Ok(array),
    }
}

/// Joint types by name, in alphabetical order.
#[derive(Clone, Debug, Default)]
pub struct JointRegistry {
    entries: BTreeMap<&'static str, JointEntry>,
}

impl JointRegistry {
    /// A registry without entries.
    pub const fn new() -> Self {
        Self {
            entries: BTreeMap::new(),
        }
    }

    /// Adds a joint type.
    ///
    /// # Errors
    /// When the name is taken; the registry then stays as it was.
    pub fn insert(&mut self, entry: JointEntry) -> Result<(), DuplicateJoint> {
        if self.entries.contains_key(entry.name) {
            return Err(DuplicateJoint { name: entry.name });
        }
        self.entries.insert(entry.name, entry);
        Ok(())
    }

    /// Adds every joint type of `entries`.
    ///
    /// # Errors
    /// At the first name that is taken; the entries before it have been added.
    pub fn extend(
        &mut self,
        entries: impl IntoIterator<Item = JointEntry>,
    ) -> Result<(), DuplicateJoint> {
        entries.into_iter().try_for_each(|entry| self.insert(entry))
    }

    /// The joint type called `name`.
    pub fn get(&self, name: &str) -> Option<&JointEntry> {
        self.entries.get(name)
    }

    /// All names, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.entries.keys().copied()
    }

    /// All entries, in alphabetical order.
    pub fn entries(&self) -> impl Iterator<Item = &JointEntry> {
        self.entries.values()
    }
}

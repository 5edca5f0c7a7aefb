//! Joint types by name: what a scene file can ask for.

use crate::erased::Shared;
use crate::shown::Number;
#[cfg(feature = "alloc")]
use alloc::{collections::BTreeMap, sync::Arc};
use core::fmt::{Display, Formatter};

/// Builds a joint from the values of its parameters, in the order of [`JointEntry::parameters`].
pub type BuildJoint = fn(&[f64]) -> Result<Shared, ParameterError>;

/// One end of the values that a parameter may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Its value.
    pub value: f64,
    /// Whether the value itself is allowed.
    pub included: bool,
}

/// A parameter of a joint type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterInfo {
    /// Its name in the spec.
    pub name: &'static str,
    /// Its unit, such as `m` or `m/rad`.
    pub unit: &'static str,
    /// What it means, in a sentence.
    pub description: &'static str,
    /// Least value; `None` where there is none.
    pub lower: Option<Limit>,
    /// Greatest value; `None` where there is none.
    pub upper: Option<Limit>,
}

impl ParameterInfo {
    /// A parameter of any finite value.
    pub const fn new(name: &'static str, unit: &'static str, description: &'static str) -> Self {
        Self {
            name,
            unit,
            description,
            lower: None,
            upper: None,
        }
    }

    /// With values greater than this alone.
    pub const fn above(mut self, value: f64) -> Self {
        self.lower = Some(Limit {
            value,
            included: false,
        });
        self
    }

    /// With values from this on.
    pub const fn at_least(mut self, value: f64) -> Self {
        self.lower = Some(Limit {
            value,
            included: true,
        });
        self
    }

    /// With values less than this alone.
    pub const fn below(mut self, value: f64) -> Self {
        self.upper = Some(Limit {
            value,
            included: false,
        });
        self
    }

    /// With values up to this.
    pub const fn at_most(mut self, value: f64) -> Self {
        self.upper = Some(Limit {
            value,
            included: true,
        });
        self
    }

    /// The limit that `value` breaks, and how a value must stand to it.
    fn broken_limit(&self, value: f64) -> Option<(&'static str, f64)> {
        let below = self.lower.filter(|limit| match limit.included {
            true => value < limit.value,
            false => value <= limit.value,
        });
        let above = self.upper.filter(|limit| match limit.included {
            true => value > limit.value,
            false => value >= limit.value,
        });
        let lower = |limit: Limit| {
            (
                if limit.included {
                    "at least"
                } else {
                    "greater than"
                },
                limit.value,
            )
        };
        let upper = |limit: Limit| {
            (
                if limit.included {
                    "at most"
                } else {
                    "less than"
                },
                limit.value,
            )
        };
        below.map(lower).or(above.map(upper))
    }
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
#[non_exhaustive]
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
    #[error("parameter `{parameter}` of joint type `{joint}` is {value}, not a finite number", value = Number(*.value))]
    NotFinite {
        /// Joint type.
        joint: &'static str,
        /// Parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
    },
    /// A value lies outside the range that the spec declares.
    #[error(
        "parameter `{parameter}` of joint type `{joint}` is {value}: it must be {relation} {limit}", value = Number(*.value), limit = Number(*.limit))]
    Limit {
        /// Joint type.
        joint: &'static str,
        /// Parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// `at least`, `greater than`, `at most` or `less than`.
        relation: &'static str,
        /// The end of the range.
        limit: f64,
    },
    /// The values together break a requirement of the spec.
    #[error(
        "joint type `{joint}` requires `{requirement}`: with {values} the two sides differ by {margin}", margin = Number(*.margin))]
    Requirement {
        /// Joint type.
        joint: &'static str,
        /// As the spec writes it, such as `outer > inner`.
        requirement: &'static str,
        /// Names and values of the parameters.
        values: ParameterValues,
        /// What must be positive: the greater side minus the less.
        margin: f64,
    },
    /// A value lies outside what the formulas allow.
    #[error("parameter `{parameter}` of joint type `{joint}` is {value}: it must be {requirement}", value = Number(*.value))]
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
    /// The type was made while the program runs: the registry that has it builds it.
    #[error(
        "a joint type that was made while the program runs is built by its registry: JointRegistry::build"
    )]
    Made,
}

/// Names and values of parameters, for messages: as many as an error carries without allocating.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterValues {
    parameters: &'static [ParameterInfo],
    values: [f64; Self::MOST],
}

impl ParameterValues {
    /// How many are named.
    const MOST: usize = 6;

    fn new(parameters: &'static [ParameterInfo], values: &[f64]) -> Self {
        Self {
            parameters,
            values: core::array::from_fn(|i| values.get(i).copied().unwrap_or(f64::NAN)),
        }
    }
}

impl Display for ParameterValues {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        for (n, (info, value)) in self.parameters.iter().zip(self.values).enumerate() {
            let comma = if n == 0 { "" } else { ", " };
            write!(f, "{comma}{} = {}", info.name, Number(value))?;
        }
        match self.parameters.len() > Self::MOST {
            true => f.write_str(", …"),
            false => Ok(()),
        }
    }
}

/// Why an entry cannot be added to a registry.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a joint type of the name `{name}` is already registered")]
pub struct DuplicateJoint {
    /// The name given twice.
    pub name: &'static str,
}

/// The parameters as an array, when there are `P` of them, all finite and in range: how generated `build` functions begin.
///
/// # Errors
/// A wrong number of values, or the first that is NaN, infinite or out of range.
pub fn check_parameters<const P: usize>(
    joint: &'static str,
    parameters: &[ParameterInfo; P],
    values: &[f64],
) -> Result<[f64; P], ParameterError> {
    check_values(joint, parameters, values)?;
    <[f64; P]>::try_from(values).map_err(|_| count(joint, P, values))
}

/// Whether there is a value for each of the parameters, finite and in range.
///
/// # Errors
/// As [`check_parameters`].
pub fn check_values(
    joint: &'static str,
    parameters: &[ParameterInfo],
    values: &[f64],
) -> Result<(), ParameterError> {
    if values.len() != parameters.len() {
        return Err(count(joint, parameters.len(), values));
    }
    for (info, &value) in parameters.iter().zip(values) {
        let parameter = info.name;
        if !value.is_finite() {
            return Err(ParameterError::NotFinite {
                joint,
                parameter,
                value,
            });
        }
        if let Some((relation, limit)) = info.broken_limit(value) {
            return Err(ParameterError::Limit {
                joint,
                parameter,
                value,
                relation,
                limit,
            });
        }
    }
    Ok(())
}

const fn count(joint: &'static str, expected: usize, values: &[f64]) -> ParameterError {
    ParameterError::Count {
        joint,
        expected,
        found: values.len(),
    }
}

/// Whether `margin`, which the spec's `requirement` says is positive, is so.
///
/// # Errors
/// When it is not, with the parameters' names and values.
pub fn check_requirement(
    joint: &'static str,
    requirement: &'static str,
    margin: f64,
    parameters: &'static [ParameterInfo],
    values: &[f64],
) -> Result<(), ParameterError> {
    if margin > 0.0 {
        return Ok(());
    }
    Err(ParameterError::Requirement {
        joint,
        requirement,
        values: ParameterValues::new(parameters, values),
        margin,
    })
}

/// Builds a joint of a type that is made while the program runs.
#[cfg(feature = "alloc")]
pub type MakeJoint = Arc<dyn Fn(&[f64]) -> Result<Shared, ParameterError> + Send + Sync>;

/// A joint type and what builds it, where that is no function of its own.
#[cfg(feature = "alloc")]
#[derive(Clone)]
struct Registered {
    entry: JointEntry,
    made: Option<MakeJoint>,
}

#[cfg(feature = "alloc")]
impl core::fmt::Debug for Registered {
    fn fmt(&self, f: &mut Formatter<'_>) -> core::fmt::Result {
        self.entry.fmt(f)
    }
}

/// Joint types by name, in alphabetical order.
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, Default)]
pub struct JointRegistry {
    entries: BTreeMap<&'static str, Registered>,
}

#[cfg(feature = "alloc")]
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
        self.add(Registered { entry, made: None })
    }

    /// Adds a joint type that is made while the program runs: [`JointRegistry::build`] builds it, and the entry's own [`JointEntry::build`] refuses to.
    ///
    /// # Errors
    /// As [`JointRegistry::insert`].
    pub fn insert_made(
        &mut self,
        (name, summary): (&'static str, &'static str),
        parameters: &'static [ParameterInfo],
        make: MakeJoint,
    ) -> Result<(), DuplicateJoint> {
        let entry = JointEntry {
            name,
            summary,
            parameters,
            build: |_| Err(ParameterError::Made),
        };
        self.add(Registered {
            entry,
            made: Some(make),
        })
    }

    fn add(&mut self, registered: Registered) -> Result<(), DuplicateJoint> {
        let name = registered.entry.name;
        if self.entries.contains_key(name) {
            return Err(DuplicateJoint { name });
        }
        self.entries.insert(name, registered);
        Ok(())
    }

    /// A joint of the type called `name`, from the values of its parameters in their order; `None` where there is no such type.
    ///
    /// # Errors
    /// Values that the type refuses.
    pub fn build(&self, name: &str, values: &[f64]) -> Option<Result<Shared, ParameterError>> {
        let registered = self.entries.get(name)?;
        Some(match &registered.made {
            Some(make) => make(values),
            None => (registered.entry.build)(values),
        })
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
        self.entries.get(name).map(|registered| &registered.entry)
    }

    /// All names, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.entries.keys().copied()
    }

    /// All entries, in alphabetical order.
    pub fn entries(&self) -> impl Iterator<Item = &JointEntry> {
        self.entries.values().map(|registered| &registered.entry)
    }
}

//! Φ(Q, ϕ) = Q exp(ϕ) and what belongs to it on the known groups, as generated joints store their elements and call for them.
//!
//! One module a group: [`real`], [`s1`], [`so2`], [`se2`], [`s3`], [`so3`], [`se3`]. With N stored scalars of Q (matrices row by row) and
//! ϕ in the standard basis of the algebra (K numbers, angular part first, in child axes), each has
//!
//! | function | value |
//! |---|---|
//! | `times_exp(q, phi)` | Q exp(ϕ), N scalars |
//! | `log_between(q, target)` | the ϕ with Q exp(ϕ) = Q′, principal branch, K numbers |
//! | `rate(q, v)` | Q̇ = Q v^, N scalars |
//! | `differential(phi)` | `D = Σ (−ad_ϕ)ⁿ/(n+1)!`, K×K: `exp(ϕ + δ) = exp(ϕ) exp(D δ)` to first order in δ |
//! | `differential_inverse(phi, rate)` | `D⁻¹ rate`, K numbers, for rotations by less than 2π |
//! | `nearest(q)` | the element nearest to scalars that are off the group, N scalars |
//! | `residual_squared(q)` | sum of the squares of the group's relations: 0 on the group |
//!
//! [`s2`], which is no group, has the last two. Rotations in radians; coefficients are Stumpff functions, accurate at every angle.

mod parts;
pub mod real;
pub mod s1;
pub mod s2;
pub mod s3;
pub mod se2;
pub mod se3;
pub mod so2;
pub mod so3;

pub use parts::{part, put, put_block, stacked};

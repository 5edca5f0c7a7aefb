//! Second derivatives of the dynamics, contracted with given weights.
//!
//! Under virtual speeds μ the bodies have the virtual twists `P_i = P_λ + X̄ μ`, and
//!
//! ```text
//! L = μᵀτ̄ = Σ_i P_iᵀ (N_i V̇_i − ad_{V_i}ᵀ N_i V_i) − W
//! ```
//!
//! with W the power of what else acts under the virtual speeds. One unit of a coordinate ϕ_k, speed or acceleration of a joint moves all that it carries by Z and
//! adds U to V, W_k to V̇ and p to P, as the module above has it for the first derivatives; `p = ad_{P_λ} Z + ∂X̄ μ`, and all but Z are 0 where they are not
//! said of a coordinate: `U = X, W = W_v` for a speed and `W = X` for an acceleration. With the sums over what the joint carries
//!
//! ```text
//! F = Σ f_i      h = Σ N_i P_i      β = Σ B_iᵀ P_i      N = Σ N_i      B = Σ B_i      B^P = Σ (B_i at the twist P_i)
//! ```
//!
//! the first derivative of L is `g_k = pᵀF + Wᵀh + Uᵀβ`. One unit of a direction l above k moves all of this along and changes `dU_k = ad_{U_l} Z_k`,
//! `dp_k = ad_{p_l} Z_k`, `dW_k = ad_{W_l} Z_k + 2 ad_{U_l} U_k`, so that
//!
//! ```text
//! H_lk = p_lᵀ (N W_k + B U_k − ad_{Z_k}ᵀ F) + W_lᵀ (N p_k − ad_{Z_k}ᵀ h) + U_lᵀ (Bᵀ p_k − ad_{Z_k}ᵀ β − 2 ad_{U_k}ᵀ h − B^P U_k)
//! ```
//!
//! Three wrenches for each direction, carried up the branch: O(n · depth). For two directions of one joint
//!
//! ```text
//! E_l g_k = p_kᵀ (N W_l + B U_l) + p_lᵀ (N W_k + B U_k) − U_lᵀ B^P U_k + (E_l p_k)ᵀF + (E_l W_k)ᵀh + (E_l U_k)ᵀβ
//! ```
//!
//! where `E_l` is the derivative along `Q̇(Q, S₀ e_l)`; the last three are the joint's own
//! ([`AnyJoint::second_variations`](crate::erased::AnyJoint::second_variations)). `E_l E_k` depends on the order: the Hessian of L(Φ(Q, ϕ)) at ϕ = 0 is
//!
//! ```text
//! H_lk = E_l g_k + Σ_m g_m [S₀⁻¹ (∂S_l − E_l S₀)]_mk
//! ```
//!
//! for l and k of one joint, and symmetric. Of different joints the order does not matter. A joint that carries several bodies is a joint for each body here as well,
//! with places in H that they share.
//!
//! Forward dynamics is `ID(x, v̄̇) = S̄ᵀτ`. With `M̄ μ = λ` and H of `μᵀ(ID − S̄ᵀτ)`, in which v̄̇ enters linearly,
//!
//! ```text
//! λᵀ∂²v̄̇ = −(H_xx + H_xa v̄̇_x + v̄̇_xᵀ H_ax)
//! ```
//!
//! over x = (ϕ, v̄, τ). Nothing is differenced, and nothing allocates after construction.

mod contraction;
mod forward;
mod inverse;
mod own;
mod pairs;

pub use forward::ForwardSecondDerivatives;
pub use inverse::InverseSecondDerivatives;

//! Second derivatives, contracted with weights: the Hessians of μᵀτ̄ of inverse dynamics and of λᵀv̄̇ of forward dynamics in local coordinates, as the tree finds
//! them.
//!
//! Under virtual speeds μ bodies have the virtual twists P. One unit of a coordinate or speed of joint k changes the motion of what that carries by Z, U and W
//! ([`Variation`](super::variation::Variation)) and P by `p = ad_{P_λ} Z + ∂X̄ μ`. With the sums over what the joint carries
//!
//! ```text
//! F = Σ f_i      h = Σ N_i P_i      β = Σ B_iᵀ P_i      N = Σ N_i      B = Σ B_i      B^P = Σ (B_i at the twist P_i)
//! ```
//!
//! the gradient of μᵀτ̄ is `g_k = pᵀF + Wᵀh + Uᵀβ`, and for a direction l of a joint above
//!
//! ```text
//! H_lk = p_lᵀ (N W_k + B U_k − ad_{Z_k}ᵀ F) + W_lᵀ (N p_k − ad_{Z_k}ᵀ h) + U_lᵀ (Bᵀ p_k − ad_{Z_k}ᵀ β − B^Pᵀ U_k)
//! ```
//!
//! since `B^P U + 2 ad_Uᵀ h = B^Pᵀ U`. The wrench that U meets is a pure moment, and the wrenches that p meets are those of the first derivatives: nodes of the
//! graph that are there already. β is a pure moment as well. Half of the pairs are written.
//!
//! All of this is of v̄̇ and μ as they are given, inputs of the graph on which joints and elements are differentiated ([`Slopes`](crate::graph::Slopes)); what
//! forward dynamics makes of them is put in their place afterwards.

mod acting;
mod contracted;
mod forward;
mod hessian;
mod own;
mod paired;
mod pairs;

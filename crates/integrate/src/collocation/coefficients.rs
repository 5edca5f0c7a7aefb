//! Coefficients of collocation methods: Gauss and Radau IIA (E. Hairer and G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed.
//! 1996, §IV.5 and §IV.8), rounded to doubles.

/// A collocation method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coefficients {
    /// Order of the result.
    pub(super) order: u32,
    /// c_i.
    pub(super) nodes: &'static [f64],
    /// a_ij.
    pub(super) matrix: &'static [&'static [f64]],
    /// b_i.
    pub(super) weights: &'static [f64],
    /// What the doubles b_i lack of the true weights. Over millions of steps it would show as a drift.
    pub(super) rests: &'static [f64],
    /// `bᵀ A⁻¹`: the end of the step from the increments of its stages.
    pub(super) ends: &'static [f64],
    /// Weights of the increments in the error estimate, for a method that has one.
    pub(super) estimate: Option<&'static [f64]>,
}

/// The implicit midpoint rule.
pub(crate) const MIDPOINT: Coefficients = Coefficients {
    order: 2,
    nodes: &[0.5],
    matrix: &[&[0.5]],
    weights: &[1.0],
    rests: &[0.0],
    ends: &[2.0],
    estimate: None,
};

/// Gauss with two stages.
pub(crate) const GAUSS_2: Coefficients = Coefficients {
    order: 4,
    nodes: &[0.2113248654051871, 0.7886751345948129],
    matrix: &[&[0.25, -0.03867513459481288], &[0.5386751345948129, 0.25]],
    weights: &[0.5, 0.5],
    rests: &[0.0, 0.0],
    ends: &[-1.7320508075688772, 1.7320508075688772],
    estimate: None,
};

/// Gauss with three stages.
pub(crate) const GAUSS_3: Coefficients = Coefficients {
    order: 6,
    nodes: &[0.11270166537925831, 0.5, 0.8872983346207417],
    matrix: &[
        &[
            0.1388888888888889,
            -0.0359766675249389,
            0.009789444015308325,
        ],
        &[
            0.30026319498086457,
            0.2222222222222222,
            -0.022485417203086815,
        ],
        &[0.26798833376246944, 0.48042111196938336, 0.1388888888888889],
    ],
    weights: &[5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0],
    rests: &[
        -1.2335811384723961e-17,
        2.4671622769447922e-17,
        -1.2335811384723961e-17,
    ],
    ends: &[5.0 / 3.0, -4.0 / 3.0, 5.0 / 3.0],
    estimate: None,
};

/// Radau IIA with three stages. The estimate is that of RADAU5: `(γ − hJ)⁻¹ (h f₀ + Σ e_i Z_i)`, γ the real eigenvalue of A⁻¹.
pub(crate) const RADAU_5: Coefficients = Coefficients {
    order: 5,
    nodes: &[0.1550510257216822, 0.6449489742783178, 1.0],
    matrix: &[
        &[
            0.1968154772236604,
            -0.06553542585019839,
            0.02377097434822015,
        ],
        &[0.3944243147390873, 0.2920734116652285, -0.04154875212599793],
        &[0.37640306270046725, 0.5124858261884216, 0.1111111111111111],
    ],
    weights: &[0.37640306270046725, 0.5124858261884216, 0.1111111111111111],
    rests: &[0.0; 3],
    ends: &[0.0, 0.0, 1.0],
    estimate: Some(&[-10.048809399827416, 1.382142733160749, -0.3333333333333333]),
};

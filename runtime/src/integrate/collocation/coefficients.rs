//! Coefficients of collocation methods: Gauss and Radau IIA (E. Hairer and G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed.
//! 1996, §IV.5 and §IV.8), rounded to doubles.

/// A collocation method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::integrate) struct Coefficients {
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
pub(in crate::integrate) const MIDPOINT: Coefficients = Coefficients {
    order: 2,
    nodes: &[0.5],
    matrix: &[&[0.5]],
    weights: &[1.0],
    rests: &[0.0],
    ends: &[2.0],
    estimate: None,
};

/// Gauss with two stages.
pub(in crate::integrate) const GAUSS_2: Coefficients = Coefficients {
    order: 4,
    nodes: &[0.21132486540518711775, 0.78867513459481288225],
    matrix: &[
        &[0.25, -0.038675134594812882255],
        &[0.53867513459481288225, 0.25],
    ],
    weights: &[0.5, 0.5],
    rests: &[0.0, 0.0],
    ends: &[-1.7320508075688772935, 1.7320508075688772935],
    estimate: None,
};

/// Gauss with three stages.
pub(in crate::integrate) const GAUSS_3: Coefficients = Coefficients {
    order: 6,
    nodes: &[0.11270166537925831148, 0.5, 0.88729833462074168852],
    matrix: &[
        &[
            0.13888888888888888889,
            -0.035976667524938903456,
            0.0097894440153083260496,
        ],
        &[
            0.30026319498086459244,
            0.22222222222222222222,
            -0.02248541720308681466,
        ],
        &[
            0.26798833376246945173,
            0.4804211119693833479,
            0.13888888888888888889,
        ],
    ],
    weights: &[5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0],
    rests: &[
        -1.233581138472396156e-17,
        2.4671622769447923121e-17,
        -1.233581138472396156e-17,
    ],
    ends: &[5.0 / 3.0, -4.0 / 3.0, 5.0 / 3.0],
    estimate: None,
};

/// Radau IIA with three stages. The estimate is that of RADAU5: `(γ − hJ)⁻¹ (h f₀ + Σ e_i Z_i)`, γ the real eigenvalue of A⁻¹.
pub(in crate::integrate) const RADAU_5: Coefficients = Coefficients {
    order: 5,
    nodes: &[0.15505102572168219018, 0.64494897427831780982, 1.0],
    matrix: &[
        &[
            0.19681547722366042587,
            -0.065535425850198388109,
            0.02377097434822015242,
        ],
        &[
            0.394424314739087277,
            0.29207341166522846302,
            -0.041548752125997930198,
        ],
        &[
            0.37640306270046727505,
            0.51248582618842161384,
            0.11111111111111111111,
        ],
    ],
    weights: &[
        0.37640306270046727505,
        0.51248582618842161384,
        0.11111111111111111111,
    ],
    rests: &[0.0; 3],
    ends: &[0.0, 0.0, 1.0],
    estimate: Some(&[
        -10.048809399827415562,
        1.3821427331607488958,
        -0.33333333333333333333,
    ]),
};

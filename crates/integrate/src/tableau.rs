//! Coefficients of explicit Runge–Kutta methods.

use super::dop853::DORMAND_PRINCE_8;
use super::verner::VERNER_9;
use alloc::format;
use alloc::string::String;

/// An explicit method; row i of `matrix` has i entries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tableau {
    /// Order of the result.
    pub order: u32,
    /// c_i.
    pub nodes: &'static [f64],
    /// a_ij.
    pub matrix: &'static [&'static [f64]],
    /// b_i.
    pub weights: &'static [f64],
    /// How the error of a step is estimated.
    pub estimate: Estimate,
    /// Whether the last stage is the first stage of the next step.
    pub first_same_as_last: bool,
}

impl Tableau {
    /// The classical method of order 4.
    pub const RK4: Self = CLASSICAL;
    /// Dormand and Prince's of order 5(4).
    pub const DORMAND_PRINCE: Self = DORMAND_PRINCE;
    /// Dormand and Prince's of order 8(5,3), known as DOP853.
    pub const DORMAND_PRINCE_8: Self = DORMAND_PRINCE_8;
    /// Verner's of order 9(8).
    pub const VERNER_9: Self = VERNER_9;
}

/// What rounding may leave of conditions on coefficients: some roundings of each of up to sixteen that are written in decimals.
const ROUNDING: f64 = 1e-13;

impl Tableau {
    /// What keeps it from being an explicit method, if anything does: sizes that do not fit, or rows that do not sum to their nodes, weights to 1 and
    /// estimates to 0. Whether it has the order that it claims is not asked.
    pub fn fault(&self) -> Option<String> {
        let count = self.nodes.len();
        if count == 0 || self.order == 0 {
            return Some(format!("has {count} stages and order {}", self.order));
        }
        let fits = |name: &str, size: usize, wanted: usize| {
            (size != wanted).then(|| format!("has {size} {name} where {wanted} are due"))
        };
        let estimates = match self.estimate {
            Estimate::None => [None, None],
            Estimate::One(weights) => [Some(weights), None],
            Estimate::Pair { fifth, third } => [Some(fifth), Some(third)],
        };
        let estimates = || estimates.into_iter().flatten();
        let mut rows = self.matrix.iter().enumerate();
        let sums = |name: &str, entries: &[f64], wanted: f64| {
            let sum: f64 = entries.iter().sum();
            let size: f64 = entries.iter().map(|entry| entry.abs()).sum();
            let off = (sum - wanted).abs() > ROUNDING * size.max(1.0);
            (off || sum.is_nan())
                .then(|| format!("has {name} that sum to {sum:?} instead of {wanted:?}"))
        };
        fits("rows", self.matrix.len(), count)
            .or_else(|| fits("weights", self.weights.len(), count))
            .or_else(|| {
                estimates().find_map(|own| fits("weights of the estimate", own.len(), count))
            })
            .or_else(|| {
                rows.find_map(|(i, row)| fits(&format!("entries in row {i}"), row.len(), i))
            })
            .or_else(|| sums("weights", self.weights, 1.0))
            .or_else(|| estimates().find_map(|own| sums("weights of the estimate", own, 0.0)))
            .or_else(|| {
                let rows = self.matrix.iter().zip(self.nodes).enumerate();
                let mut rows =
                    rows.map(|(i, (row, node))| sums(&format!("entries in row {i}"), row, *node));
                rows.find_map(|fault| fault)
            })
    }
}

/// What a method says about the error of its steps: weights b_i − b̂_i against embedded methods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Estimate {
    /// Nothing.
    None,
    /// The difference e to one embedded method.
    One(&'static [f64]),
    /// The differences e₅ and e₃ to methods of order 5 and 3, which make `|e₅|² / √(|e₅|² + 0.01 |e₃|²)`.
    Pair {
        /// Against the method of order 5.
        fifth: &'static [f64],
        /// Against the method of order 3.
        third: &'static [f64],
    },
}

/// The classical method of order 4.
const CLASSICAL: Tableau = Tableau {
    order: 4,
    nodes: &[0.0, 0.5, 0.5, 1.0],
    matrix: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
    weights: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
    estimate: Estimate::None,
    first_same_as_last: false,
};

/// J. R. Dormand and P. J. Prince, *A family of embedded Runge–Kutta formulae*, 1980: RK5(4)7M.
const DORMAND_PRINCE: Tableau = Tableau {
    order: 5,
    nodes: &[0.0, 1.0 / 5.0, 3.0 / 10.0, 4.0 / 5.0, 8.0 / 9.0, 1.0, 1.0],
    matrix: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[
            19372.0 / 6561.0,
            -25360.0 / 2187.0,
            64448.0 / 6561.0,
            -212.0 / 729.0,
        ],
        &[
            9017.0 / 3168.0,
            -355.0 / 33.0,
            46732.0 / 5247.0,
            49.0 / 176.0,
            -5103.0 / 18656.0,
        ],
        &[
            35.0 / 384.0,
            0.0,
            500.0 / 1113.0,
            125.0 / 192.0,
            -2187.0 / 6784.0,
            11.0 / 84.0,
        ],
    ],
    weights: &[
        35.0 / 384.0,
        0.0,
        500.0 / 1113.0,
        125.0 / 192.0,
        -2187.0 / 6784.0,
        11.0 / 84.0,
        0.0,
    ],
    estimate: Estimate::One(&[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339_200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ]),
    first_same_as_last: true,
};

//! Every compiled kernel at one case against the definition, and what must hold of both.

use super::lines::Place;
use crate::accuracy::{AtPhi, Case, Definition, Grid, Output, Sheet, Tracked, Worst, numbers};
use hamel_codegen::expr::Number;

/// Beyond this, products of a few numbers leave the range of doubles: nothing is asked of a kernel there.
const LARGEST_SCALE: f64 = 1e100;

/// Below this, squares of its factors do: beside numbers of order 1 such an entry is 0.
const SMALLEST_SCALE: f64 = 1e-100;

/// Kernels that are, for some joints, solutions of linear systems or of Newton's method.
const SOLVED: [&str; 4] = [
    "local",
    "project",
    "retract_differential",
    "retract_differential_inverse",
];

/// By how much their systems may raise the roundings of their entries: beside an exception directions are nearly dependent.
const CONDITION: f64 = 1024.0;

/// The definition at one case.
pub(super) struct Definitions<'a> {
    definition: &'a Definition,
    case: &'a Case,
    at: Sheet<Tracked>,
    finite: AtPhi,
}

/// The entries in the order of storage.
fn columns(grid: &Grid<Tracked>) -> Vec<Tracked> {
    grid.transpose().entries().to_vec()
}

/// Where errors go.
pub(super) struct Met<'a> {
    pub worst: &'a mut Worst,
    pub place: &'a Place<'a>,
    pub case: &'a Case,
}

impl Met<'_> {
    /// Whether some function inside the kernels is asked for an argument that doubles cannot work with: too large, or rounded to 0.
    fn overflows(&self) -> bool {
        let notes = self.place.joint.notes(self.case);
        notes
            .iter()
            .any(|note| note.is_nan() || note.abs() > LARGEST_SCALE || *note == 0.0)
    }

    /// Takes the error in ulp of the largest summand, where that has a size in doubles.
    fn meet(&mut self, name: &'static str, got: f64, want: &Tracked) {
        let is_asked = (SMALLEST_SCALE..=LARGEST_SCALE).contains(&want.scale) || want.scale == 0.0;
        if !is_asked {
            return;
        }
        // What is asked of kernels whose intermediate results overflow is another suite's matter.
        if !got.is_finite() && self.overflows() {
            return;
        }
        let distance = Tracked::input(got).plus(&want.negative());
        let unit = f64::EPSILON * self.place.slack * want.scale.max(f64::MIN_POSITIVE);
        // A value that is no number has no distance.
        let error = distance.value.to_f64().abs() / unit;
        let Case {
            q,
            phi,
            v,
            speeds,
            wrench,
            ..
        } = self.case;
        let parameters = self.place.parameters;
        self.worst.error(name, if got.is_finite() { error } else { f64::NAN }, || {
            let (value, scale) = (want.value.to_f64(), want.scale);
            format!(
                "got {got:e} for {value:e} of scale {scale:e} at parameters {parameters:?}, Q = {q:?}, phi = {phi:?}, v = {v:?}, \
                 speeds = {speeds:?}, h = {wrench:?}"
            )
        });
    }
}

impl<'a> Definitions<'a> {
    /// All definitions; nothing where H has no value, or none that doubles can work with.
    pub fn new(definition: &'a Definition, case: &'a Case) -> Option<Self> {
        let at = definition.kernels(&case.q, &case.v, &case.speeds, &case.wrench);
        let pose = at.all("pose").flat_map(Grid::entries);
        let defined = pose.into_iter().all(|x| x.scale <= LARGEST_SCALE);
        defined.then(|| Self {
            finite: definition.at_phi(&case.q, &case.phi),
            definition,
            case,
            at,
        })
    }

    /// Takes the errors of all kernels, and of the laws between them.
    pub fn measure(&self, place: &Place, worst: &mut Worst) {
        let found = place.joint.doubles(self.case);
        let moved = named(&found, "retract");
        let mut met = Met {
            worst,
            place,
            case: self.case,
        };
        for (kernel, got) in &found {
            for (got, want) in got.iter().zip(self.scaled(kernel, &moved)) {
                met.meet(kernel, *got, &want);
            }
        }
        self.laws(&found, &mut met);
    }

    /// As [`Self::wanted`]; of kernels that the runtime solves equations for, each entry with the largest scale of all, raised: there errors go from one
    /// entry to the others.
    fn scaled(&self, kernel: &str, moved: &[f64]) -> Vec<Tracked> {
        let wanted = self.wanted(kernel, moved);
        if !SOLVED.contains(&kernel) {
            return wanted;
        }
        let largest = wanted.iter().map(|x| x.scale).fold(0.0, f64::max);
        let scale = CONDITION * largest;
        wanted
            .into_iter()
            .map(|x| Tracked::computed(x.value, scale))
            .collect()
    }

    /// What a kernel has by its definition, in the order of storage.
    fn wanted(&self, kernel: &str, moved: &[f64]) -> Vec<Tracked> {
        let (definition, case) = (self.definition, self.case);
        let pose = |n: usize| self.at.all("pose").nth(n).map(columns).unwrap_or_default();
        match kernel {
            // A guess is projected, and any way to do so is right: a law asks that it ends on the manifold.
            "home" if definition.spec().home_is_guess => vec![],
            "home" => definition.home(),
            "rotation" => pose(0),
            "translation" => pose(1),
            "retract" => self.finite.moved.clone(),
            "retract_differential" => columns(&self.finite.differential),
            "retract_differential_inverse" => {
                let rate = Grid::column(numbers(&case.v));
                columns(&self.finite.inverse.times(&rate))
            }
            "local" => columns(&definition.local(&self.finite, &case.q, moved, &case.phi)),
            "project" => definition.nearest(&case.q, &case.exact),
            "residual" => vec![definition.residual(&case.q)],
            // Infinite where nothing is excepted.
            "singularity" => definition.singularity(&case.q).into_iter().collect(),
            other => self.at.all(other).flat_map(columns).collect(),
        }
    }

    /// Laws that comparing kernels one by one does not see.
    fn laws(&self, found: &[Output<f64>], met: &mut Met) {
        let case = self.case;
        let zero = vec![0.0; case.phi.len()];
        let start = self.definition.at_phi(&case.q, &zero).moved;
        let still = met.place.joint.retract(&case.q, &zero);
        for (i, want) in start.iter().enumerate() {
            let stored = Tracked::computed(Tracked::input(case.q[i]).value, want.scale);
            met.meet("Φ(Q, 0) = Q", still[i], &stored);
        }
        let nothing = |scale: f64| Tracked::computed(Tracked::input(0.0).value, scale);
        // Linear relations between small entries of a matrix: those are off by roundings of its large ones.
        let sizes = start.iter().map(|x| x.scale);
        let largest = sizes.fold(0.0, f64::max);
        for (law, kernel) in [
            ("Φ(Q, ϕ) on the manifold", "retract"),
            ("home on the manifold", "home"),
        ] {
            let relations = self.definition.relations(&named(found, kernel));
            for relation in relations.entries() {
                let (got, scale) = (relation.value.to_f64(), relation.scale.max(largest));
                met.meet(law, got, &nothing(scale));
            }
        }
        for mismatch in self.at.all("mismatch").flat_map(Grid::entries) {
            let got = mismatch.value.to_f64();
            met.meet("X S = J to first order", got, &nothing(mismatch.scale));
        }
        let k = case.phi.len();
        let (a, basis) = (named(found, "constraint"), named(found, "speed_basis"));
        for (a, s) in pairs(&a, &basis, k) {
            let terms = a.iter().zip(s).map(|(a, s)| a * s);
            let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), x| (sum + x, size + x.abs()));
            met.meet("Aᵀ S̄ = 0", sum, &nothing(size));
        }
    }
}

/// Every column of `a` with every column of `b`, of `size` entries each.
fn pairs<'b>(
    a: &'b [f64],
    b: &'b [f64],
    size: usize,
) -> impl Iterator<Item = (&'b [f64], &'b [f64])> {
    let of_b = move || b.chunks_exact(size);
    a.chunks_exact(size)
        .flat_map(move |a| of_b().map(move |b| (a, b)))
}

fn named(found: &[Output<f64>], name: &str) -> Vec<f64> {
    let output = found.iter().find(|(kernel, _)| *kernel == name);
    output.map(|(_, values)| values.clone()).unwrap_or_default()
}

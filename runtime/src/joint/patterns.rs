//! Which entries of a joint's kernels are 0 or 1 at every configuration, known where it is compiled.

/// What is known of one entry of a kernel's value at compile time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// 0 at every configuration.
    Zero,
    /// 1 at every configuration.
    One,
    /// Anything else.
    Other,
}

/// The [`Entry`] of each place in the kernels that recursions spend their time on, so that they multiply by nothing that is
/// known to be 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patterns<const K: usize, const S: usize> {
    /// The rotation matrix of H, by rows.
    pub rotation: [[Entry; 3]; 3],
    /// The translation of H.
    pub translation: [Entry; 3],
    /// X^c, by rows.
    pub twist_map_child: [[Entry; K]; 6],
    /// S̄, by rows.
    pub speed_basis: [[Entry; S]; K],
    /// The slices of ∂X^c/∂ϕ, by rows.
    pub twist_map_child_gradient: [[[Entry; K]; 6]; K],
    /// The slices of ∂S̄/∂ϕ, by rows.
    pub speed_basis_gradient: [[[Entry; S]; K]; K],
    /// The columns of ∂c/∂ϕ, and those of its dual.
    pub bias_gradient: [Entry; K],
}

impl<const K: usize, const S: usize> Patterns<K, S> {
    /// Nothing is known.
    pub const DENSE: Self = Self {
        rotation: [[Entry::Other; 3]; 3],
        translation: [Entry::Other; 3],
        twist_map_child: [[Entry::Other; K]; 6],
        speed_basis: [[Entry::Other; S]; K],
        twist_map_child_gradient: [[[Entry::Other; K]; 6]; K],
        speed_basis_gradient: [[[Entry::Other; S]; K]; K],
        bias_gradient: [Entry::Other; K],
    };

    /// The pattern of a holonomic joint whose X^c is constant, from rows of the signs `0`, `1` and `x` for anything else: S̄ is the
    /// identity, derivatives along ϕ are zero.
    pub const fn new(rotation: [&str; 3], translation: &str, twist_map_child: [&str; 6]) -> Self {
        let [translation] = entries([translation]);
        Self {
            rotation: entries(rotation),
            translation,
            twist_map_child: entries(twist_map_child),
            speed_basis: identity(),
            twist_map_child_gradient: [[[Entry::Zero; K]; 6]; K],
            speed_basis_gradient: [[[Entry::Zero; S]; K]; K],
            bias_gradient: [Entry::Other; K],
        }
    }

    /// With the slices of ∂X^c/∂ϕ that are not zero, each with its number.
    pub const fn twist_map_child_gradient(mut self, slices: &[(usize, [&str; 6])]) -> Self {
        self.twist_map_child_gradient = self::slices(slices);
        self
    }

    /// With this S̄, by rows.
    pub const fn speed_basis(mut self, rows: [&str; K]) -> Self {
        self.speed_basis = entries(rows);
        self
    }

    /// With the slices of ∂S̄/∂ϕ that are not zero, each with its number.
    pub const fn speed_basis_gradient(mut self, slices: &[(usize, [&str; K])]) -> Self {
        self.speed_basis_gradient = self::slices(slices);
        self
    }

    /// With columns of ∂c/∂ϕ and of that of its dual that are zero.
    pub const fn bias_gradient(mut self, columns: &str) -> Self {
        let [columns] = entries([columns]);
        self.bias_gradient = columns;
        self
    }

    /// The pattern of `X^c S̄`, by rows.
    pub const fn speed_columns(&self) -> [[Entry; S]; 6] {
        add_product(
            [[Entry::Zero; S]; 6],
            &self.twist_map_child,
            &self.speed_basis,
        )
    }
}

/// The pattern of a sum of matrices with any factors.
pub const fn any<const R: usize, const C: usize, const K: usize>(
    slices: &[[[Entry; C]; R]; K],
) -> [[Entry; C]; R] {
    let mut all = [[Entry::Zero; C]; R];
    let mut n = 0;
    while n < K * R * C {
        let (k, i, j) = (n / (R * C), n / C % R, n % C);
        if !matches!(slices[k][i][j], Entry::Zero) {
            all[i][j] = Entry::Other;
        }
        n += 1;
    }
    all
}

/// The pattern of a sum and a product more.
const fn add_product<const R: usize, const M: usize, const C: usize>(
    mut all: [[Entry; C]; R],
    a: &[[Entry; M]; R],
    b: &[[Entry; C]; M],
) -> [[Entry; C]; R] {
    let mut i = 0;
    while i < R {
        let mut j = 0;
        while j < C {
            let mut m = 0;
            while m < M {
                all[i][j] = sum(all[i][j], product(a[i][m], b[m][j]));
                m += 1;
            }
            j += 1;
        }
        i += 1;
    }
    all
}

const fn identity<const R: usize, const C: usize>() -> [[Entry; C]; R] {
    let mut entries = [[Entry::Zero; C]; R];
    let mut i = 0;
    while i < R && i < C {
        entries[i][i] = Entry::One;
        i += 1;
    }
    entries
}

const fn entries<const R: usize, const C: usize>(rows: [&str; R]) -> [[Entry; C]; R] {
    let mut entries = [[Entry::Other; C]; R];
    let mut i = 0;
    while i < R {
        let row = rows[i].as_bytes();
        assert!(
            row.len() == C,
            "a row of a pattern has another length than its matrix"
        );
        let mut j = 0;
        while j < C {
            entries[i][j] = match row[j] {
                b'0' => Entry::Zero,
                b'1' => Entry::One,
                b'x' => Entry::Other,
                _ => panic!("a pattern is written in the signs 0, 1 and x"),
            };
            j += 1;
        }
        i += 1;
    }
    entries
}

const fn slices<const R: usize, const C: usize, const K: usize>(
    given: &[(usize, [&str; R])],
) -> [[[Entry; C]; R]; K] {
    let mut slices = [[[Entry::Zero; C]; R]; K];
    let mut n = 0;
    while n < given.len() {
        let (k, rows) = given[n];
        slices[k] = entries(rows);
        n += 1;
    }
    slices
}

const fn product(a: Entry, b: Entry) -> Entry {
    match (a, b) {
        (Entry::Zero, _) | (_, Entry::Zero) => Entry::Zero,
        (Entry::One, other) | (other, Entry::One) => other,
        (Entry::Other, Entry::Other) => Entry::Other,
    }
}

const fn sum(a: Entry, b: Entry) -> Entry {
    match (a, b) {
        (Entry::Zero, other) | (other, Entry::Zero) => other,
        _ => Entry::Other,
    }
}

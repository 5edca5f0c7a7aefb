//! `+ − * /` for [`Precise`], by reference and by value.

use super::Precise;
use std::ops::{Add, Div, Mul, Neg, Sub};

macro_rules! operators {
    ($($operator:ident $method:ident $own:ident),*) => {$(
        impl $operator for &Precise {
            type Output = Precise;
            fn $method(self, other: &Precise) -> Precise {
                self.$own(other)
            }
        }

        impl $operator for Precise {
            type Output = Precise;
            fn $method(self, other: Precise) -> Precise {
                self.$own(&other)
            }
        }
    )*};
}

operators!(Add add sum, Sub sub difference, Mul mul product, Div div quotient);

impl Neg for &Precise {
    type Output = Precise;
    fn neg(self) -> Precise {
        self.negative()
    }
}

impl Neg for Precise {
    type Output = Precise;
    fn neg(self) -> Precise {
        self.negative()
    }
}

impl Mul<&Precise> for Precise {
    type Output = Precise;
    fn mul(self, other: &Precise) -> Precise {
        self.product(other)
    }
}

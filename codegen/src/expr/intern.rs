//! Equal functions are one object: comparing, ordering and hashing nested ones then costs one step, not a walk through both.
//!
//! Only speed depends on that. Functions made by different threads are compared part by part.

use super::{Application, Expr, Function};
use rustc_hash::FxHashMap;
use std::cell::RefCell;
use std::sync::{Arc, Weak};

/// Fewest functions at which those that are gone are looked for.
const FEW: usize = 1024;

thread_local! {
    static KNOWN: RefCell<Known> = RefCell::default();
}

/// The functions of this thread by hash, as long as something holds them.
#[derive(Default)]
struct Known {
    by_hash: FxHashMap<u64, Weak<Application>>,
    /// Size at which those that are gone are removed.
    full: usize,
}

/// The function with these arguments.
pub(super) fn application(function: Function, arguments: Vec<Expr>) -> Arc<Application> {
    let made = Application::new(function, arguments);
    KNOWN.with_borrow_mut(|known| known.object(made))
}

impl Known {
    fn object(&mut self, made: Application) -> Arc<Application> {
        if let Some(known) = self.by_hash.get(&made.hash()).and_then(Weak::upgrade)
            && *known == made
        {
            return known;
        }
        self.clear();
        let made = Arc::new(made.complete());
        self.by_hash.insert(made.hash(), Arc::downgrade(&made));
        made
    }

    /// Forgets what is gone, seldom enough to cost nothing.
    fn clear(&mut self) {
        if self.by_hash.len() >= self.full.max(FEW) {
            self.by_hash.retain(|_, known| known.strong_count() > 0);
            self.full = 2 * self.by_hash.len();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::application;
    use crate::expr::{Expr, Function, Role, Symbol};
    use std::sync::Arc;

    #[test]
    fn equal_functions_are_one_object_and_those_that_are_gone_are_forgotten() {
        let argument = |n: i64| {
            let x = Expr::symbol(&Symbol::new(Role::Coordinate, 0, "x"));
            vec![&x + &Expr::integer(n)]
        };
        let kept = application(Function::Sqrt, argument(0));
        for n in 1..10_000 {
            application(Function::Sqrt, argument(n));
        }
        assert!(Arc::ptr_eq(
            &kept,
            &application(Function::Sqrt, argument(0))
        ));
        assert!(super::KNOWN.with_borrow(|known| known.by_hash.len()) <= super::FEW);
    }
}
